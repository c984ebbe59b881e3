"""A release: one version everywhere, metadata of the package index, a citation, addresses that lead somewhere."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import vibeam

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
SOURCE = PROJECT["urls"]["Source"]
TARGET = re.compile(r"\]\(([^)#]+)")


def read(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def front_page() -> str:
    """The front page as the package index shows it, of a stand-in version that hatch-fancy-pypi-readme takes."""
    made = subprocess.run(
        [sys.executable, "-m", "hatch_fancy_pypi_readme"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return made.stdout


def refused(citation: Path) -> str:
    """Complaints of the format's own schema about a citation; empty: none."""
    asked = [sys.executable, "-m", "check_jsonschema", "--builtin-schema", "vendor.citation-file-format", str(citation)]
    done = subprocess.run(asked, capture_output=True, text=True)
    return done.stdout + done.stderr if done.returncode else ""


def test_one_version_is_said_everywhere() -> None:
    assert "version" in PROJECT["dynamic"]
    latest = re.search(r"^## (\S+)", read("CHANGELOG.md"), re.MULTILINE)
    cited = re.search(r"^version: (\S+)", read("CITATION.cff"), re.MULTILINE)
    assert latest is not None
    assert cited is not None
    assert (latest[1], cited[1]) == (vibeam.__version__, vibeam.__version__)


def test_the_citation_is_one(tmp_path: Path) -> None:
    assert refused(ROOT / "CITATION.cff") == ""
    wrong = tmp_path / "CITATION.cff"
    wrong.write_text(read("CITATION.cff").replace("authors:", "writers:"), encoding="utf-8")
    assert "authors" in refused(wrong)


def test_all_addresses_are_of_one_place() -> None:
    assert f"\nrepository-code: {SOURCE}\n" in read("CITATION.cff")
    assert all(each.startswith(SOURCE) for each in PROJECT["urls"].values())
    assert f"\nlicense: {PROJECT['license']}\n" in read("CITATION.cff")
    assert PROJECT["authors"] == [{"name": "The vibeam developers"}]


def test_the_front_page_of_the_index_has_absolute_links_to_what_is_there() -> None:
    hosts = {f"{SOURCE}/blob/v": 0, SOURCE.replace("github.com", "raw.githubusercontent.com") + "/v": 0}
    for target in TARGET.findall(front_page()):
        host = next(filter(target.startswith, hosts), None)
        assert host is not None, target
        assert (ROOT / target.removeprefix(host).partition("/")[2]).exists(), target
        hosts[host] += 1
    assert min(hosts.values()) >= 2  # pictures, and pages


@pytest.mark.parametrize("pattern", [0, 1])
def test_a_link_with_an_address_stays_as_it_is(pattern: int) -> None:
    tool = tomllib.loads(read("pyproject.toml"))["tool"]["hatch"]["metadata"]["hooks"]["fancy-pypi-readme"]
    [found, put] = tool["substitutions"][pattern].values()
    text = "![a](https://a.example/b.png) [c](mailto:d) [e](#f)"
    assert re.sub(found, put, text) == text
