"""Markdown pages: links and file names lead to files, rooms have a page, tables agree with the results."""

from __future__ import annotations

import importlib.util
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from urllib.parse import unquote

import pytest

ROOT = Path(__file__).parents[1]
FENCED = re.compile(r"^(```|~~~).*?^\1", re.DOTALL | re.MULTILINE)
LINK = re.compile(r"\]\(<?([^()\s>]+)>?(?:\s+\"[^\"]*\")?\)")
ELSEWHERE = re.compile(r"[a-z][a-z0-9+.-]*:|#", re.IGNORECASE)
NAMED = re.compile(r"`([\w*/]+\.(?:py|toml))`")
GIVEN = re.compile(r"\b((?:tests|cases)/[\w*/]+\.(?:py|toml))")  # to a command
HISTORY = {"CHANGELOG.md"}  # names what was there
UNTRACKED = {".venv", "venv", "build", "dist", "node_modules"}


def markdown_pages() -> list[Path]:
    """The pages of the repository; in an unpacked archive, those of its folders."""
    if (ROOT / ".git").exists() and shutil.which("git"):
        asked = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "*.md"]
        listed = subprocess.run(asked, cwd=ROOT, capture_output=True, text=True, check=True).stdout.splitlines()
        return [ROOT / name for name in listed if (ROOT / name).exists()]
    found = (path.relative_to(ROOT) for path in ROOT.rglob("*.md"))
    return [ROOT / path for path in found if not any(part in UNTRACKED or part[0] == "." for part in path.parts[:-1])]


def broken_links(page: Path) -> list[str]:
    """Relative targets in a page, outside of code blocks, that are not there."""
    targets = LINK.findall(FENCED.sub("", page.read_text(encoding="utf-8")))
    relative = [unquote(target.split("#")[0]) for target in targets if not ELSEWHERE.match(target)]
    return [target for target in relative if not (page.parent / target).exists()]


def test_every_relative_link_leads_to_a_file() -> None:
    pages = markdown_pages()
    assert ROOT / "README.md" in pages
    assert {str(page.relative_to(ROOT)): links for page in pages if (links := broken_links(page))} == {}


def test_a_broken_link_is_seen(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    links = "[a](page.md) [b](gone.md#part) ![c](gone.png) [d](https://a.example/b) [e](#f)"
    page.write_text(f"{links}\n```\n[g](h)\n```\n")
    assert broken_links(page) == ["gone.md", "gone.png"]


def test_every_room_has_its_page() -> None:
    rooms = [path.parent for path in ROOT.glob("vibeam/*/__init__.py")]
    assert rooms
    doors = [*rooms, *(ROOT / name for name in ("vibeam", "models", "reductions", "tests"))]
    assert [str(door.relative_to(ROOT)) for door in doors if not (door / "README.md").exists()] == []


def absent_files(page: Path) -> list[str]:
    """Python files and cases that a page names, or gives to a command, and that are not there."""
    text = page.read_text(encoding="utf-8")
    names = dict.fromkeys(NAMED.findall(FENCED.sub("", text)) + GIVEN.findall(text))
    return [name for name in names if not (any(page.parent.rglob(name)) or any(ROOT.glob(name)))]


def test_every_file_that_a_page_names_is_there() -> None:
    named = [page for page in markdown_pages() if page.name not in HISTORY]
    assert {str(page.relative_to(ROOT)): names for page in named if (names := absent_files(page))} == {}


def test_a_file_that_is_not_there_is_seen(tmp_path: Path) -> None:
    (tmp_path / "room").mkdir()
    (tmp_path / "room" / "a.py").touch()
    page = tmp_path / "page.md"
    page.write_text("`room/a.py` `a.py` `gone.py` `pyproject.toml`; `python tests/gone.py cases/dtu_neutral.toml`\n")
    assert absent_files(page) == ["gone.py", "tests/gone.py"]


@pytest.fixture(scope="module")
def pages() -> ModuleType:
    place = ROOT / "tests" / "benchmarks" / "pages.py"
    described = importlib.util.spec_from_file_location("benchmark_pages", place)
    assert described is not None
    assert described.loader is not None
    module = importlib.util.module_from_spec(described)
    described.loader.exec_module(module)
    return module


def test_the_benchmark_page_agrees_with_the_results(pages: ModuleType) -> None:
    page = pages.PAGE.read_text(encoding="utf-8")
    assert pages.with_tables(page, pages.generated()) == page, "run python tests/benchmarks/pages.py"


def test_the_page_of_the_paper_s_figures_agrees_with_the_results(pages: ModuleType) -> None:
    page = pages.PAPER.read_text(encoding="utf-8")
    assert pages.with_tables(page, pages.generated_for_paper()) == page, "run python tests/benchmarks/pages.py"


def test_the_table_of_the_front_page_agrees_with_the_results(pages: ModuleType) -> None:
    page = pages.FRONT.read_text(encoding="utf-8")
    assert pages.with_tables(page, pages.generated_for_front()) == page, "run python tests/benchmarks/pages.py"


def test_the_table_of_the_maps_page_agrees_with_the_results(pages: ModuleType) -> None:
    page = pages.MAPS.read_text(encoding="utf-8")
    assert pages.with_tables(page, pages.generated_for_maps()) == page, "run python tests/benchmarks/pages.py"


def test_another_result_is_another_page(pages: ModuleType, tmp_path: Path) -> None:
    committed = ("peers", "modes", "libraries", "startup", "sparse", "solid", "webassembly", "page_frames", "threads")
    committed += ("parts",)
    for name in (f"{each}.json" for each in committed):
        shutil.copy(pages.RESULTS / name, tmp_path)
    found = json.loads((tmp_path / "modes.json").read_text())
    found[0]["cost_us"] *= 2
    (tmp_path / "modes.json").write_text(json.dumps(found))
    page = pages.PAGE.read_text(encoding="utf-8")
    assert pages.with_tables(page, pages.generated(tmp_path)) != page


def test_a_page_without_its_markers_is_refused(pages: ModuleType) -> None:
    with pytest.raises(ValueError, match="peers"):
        pages.with_tables("no markers\n", pages.generated())


@pytest.mark.parametrize(("value", "text"), [(0.1969, "0.20"), (1370.7, "1 400"), (9.96, "10"), (17.4, "17"), (0, "0")])
def test_numbers_are_rounded_to_two_digits(pages: ModuleType, value: float, text: str) -> None:
    assert pages.significant(value) == text


def test_the_script_checks_without_writing(pages: ModuleType) -> None:
    before = pages.PAGE.read_bytes()
    done = subprocess.run([sys.executable, pages.__file__, "--check"], capture_output=True, text=True)
    assert (done.returncode, pages.PAGE.read_bytes()) == (0, before), done.stderr
