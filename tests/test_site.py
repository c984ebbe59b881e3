"""The manual as a site: pages and links, the way from the front page to an own rig, the names in the reference."""

from __future__ import annotations

import importlib
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

import vibeam

ROOT = Path(__file__).parents[1]
SITE = ROOT / ".ci" / "site"
WORDS_A_MINUTE = 200
pytestmark = pytest.mark.skipif(not SITE.exists(), reason="an archive without .ci")


@pytest.fixture(scope="module")
def modules() -> Iterator[dict[str, ModuleType]]:
    before = list(sys.path)
    sys.path.insert(0, str(SITE))
    yield {name: importlib.import_module(name) for name in ("manual", "reference", "built")}
    sys.path[:] = before


@pytest.fixture(scope="module")
def manual(modules: dict[str, ModuleType]) -> object:
    return modules["manual"].Manual()


def navigation() -> dict[str, list[str]]:
    """Pages of each part of the navigation."""
    parts = re.split(r"^  - (\w+):\n", (SITE / "mkdocs.yml").read_text().partition("\nnav:\n")[2], flags=re.MULTILINE)
    return {name: re.findall(r"[\w/.-]+\.md", pages) for name, pages in zip(parts[1::2], parts[2::2], strict=True)}


def test_the_way_to_an_own_rig_takes_less_than_ten_minutes(manual) -> None:
    way, texts = navigation()["Start"], manual.texts()
    assert (way[0], way[-1]) == ("README.md", "your-own-rig.md")
    words = sum(
        len(re.sub(r"<!--.*?-->|\]\([^)]*\)|[|`*#─]", " ", texts[page], flags=re.DOTALL).split()) for page in way
    )
    assert 500 < words < 10 * WORDS_A_MINUTE


def test_every_page_has_its_place_in_the_navigation(manual) -> None:
    placed = [page for pages in navigation().values() for page in pages]
    assert sorted(placed) == sorted(set(manual.texts()))


def test_the_front_page_is_cut_at_its_headings(modules) -> None:
    parts = modules["manual"].sections("# a\nb\n## My c: `d`\n```\n## not\n```\n### e\n## f\n")
    assert [part.file for part in parts] == ["README.md", "my-c-d.md", "f.md"]
    assert [part.text for part in parts] == ["# a\nb\n", "# My c: `d`\n```\n## not\n```\n## e\n", "# f\n"]
    assert parts[1].anchors == {"my-c-d", "e"}


@pytest.mark.parametrize(
    ("page", "link", "place"),
    [
        ("vibeam/cli/README.md", "../../README.md#commands", "../../commands.md#commands"),
        ("commands.md", "#is-the-beam-enough", "your-own-rig.md#is-the-beam-enough"),
        ("vibeam/README.md", "../README.md", "../README.md"),
        ("vibeam/README.md", "runs/sweep.py", "../source/vibeam/runs/sweep.py.md"),
        ("vibeam/README.md", "runs", "runs/README.md"),
        ("vibeam/README.md", "#how-data-go", "#how-data-go"),
        ("vibeam/README.md", "https://a.example/b#c", "https://a.example/b#c"),
        ("README.md", "https://github.com/vibeam/vibeam/blob/main/models/README.md#drives", "models/README.md#drives"),
        ("vibeam/README.md", "https://github.com/vibeam/vibeam/blob/main/LICENSE", "../source/LICENSE.md"),
        ("README.md", "cases/dtu_neutral.png", "cases/dtu_neutral.png"),
    ],
)
def test_a_link_leads_to_its_place_in_the_site(manual, page: str, link: str, place: str) -> None:
    assert manual.place_of(page, link) == place


def test_links_in_code_stay(manual) -> None:
    text = "[a](system/README.md)\n```\n[a](runs)\n```\n"
    assert manual.with_places("vibeam/README.md", text) == text


def test_the_gallery_s_pages_stand_for_its_scripts_and_notebooks(modules, tmp_path: Path) -> None:
    (tmp_path / "relay.md").write_text("# Relay\n![it](relay.png)\n")
    (tmp_path / "relay.png").touch()
    (tmp_path / "first_steps.md").write_text("# First steps\n")
    made = modules["manual"].Manual(gallery=tmp_path)
    assert made.place_of("cases/gallery/README.md", "relay.py") == "relay.md"
    assert made.place_of("cases/gallery/relay.md", "relay.png") == "relay.png"
    assert made.place_of("cases/gallery/relay.md", "first_steps.ipynb") == "first_steps.md"


def test_the_reference_has_every_public_name(modules) -> None:
    reference, built = modules["reference"], modules["built"]
    spaces = {f"vibeam.{name}" for name in (*reference.SPACES, "__version__")}
    names = {f"vibeam.{name}" for name in vibeam.__all__} | {f"vibeam.observe.{name}" for name in dir(vibeam.observe)}
    assert set(reference.homes()) == names - spaces
    pages = "".join(reference.pages().values())
    assert [name for name in reference.homes() if f"{{#{name}}}" not in pages] == []
    others = [name.rpartition(".")[0] for name in built.public_names() if not name.startswith("vibeam.")]
    assert len(others) > 200
    assert [name for name in set(others) if f"::: {name}\n" not in pages] == []


def test_what_a_page_reads_from_elsewhere_is_seen(modules, tmp_path: Path) -> None:
    (tmp_path / "a.html").write_text(
        '<a href="https://b.example"></a><script defer src=https://c.example/d.js></script>'
    )
    (tmp_path / "b.css").write_text("@import '//e.example/f.css'; a { color: url(data:g) }")
    assert [line.split(": ")[0] for line in modules["built"].read_elsewhere(tmp_path)] == ["a.html", "b.css"]


def test_a_list_that_the_site_does_not_show_is_seen(modules) -> None:
    shape = modules["built"].Shape
    assert shape("<p>a<b>b</b></p><pre><i>c</i>d</pre><h1>e<a class='headerlink'>¶</a></h1>").found == [
        "<p>", "ab", "<pre>", "cd", "<h1>", "e"]  # fmt: skip
    assert shape("<p>a</p><ul><li>b</li></ul>").found != shape("<p>a - b</p>").found


def test_examples_of_docstrings_become_blocks() -> None:
    pytest.importorskip("griffe", reason="the extra docs")
    sys.path.insert(0, str(SITE))
    examples = importlib.import_module("examples")
    sys.path.remove(str(SITE))
    assert examples.with_blocks("A.\n\n>>> 1\n1\n\nB.\n") == "A.\n\n\n```pycon\n>>> 1\n1\n```\n\n\nB.\n"
