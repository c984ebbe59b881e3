"""No number on a page that neither its own case nor a committed result states; the list of exceptions shrinks."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests import page_numbers

CASE = """title = "Fig. 99"
[stop]
gap = "0.1 mm"
[expect.peak]
value = "15.357 Hz"
tolerance = "0.2 %"
[measured.speed]
value = 0.03512
"""


def unmatched(tmp_path: Path, text: str) -> list[str]:
    (tmp_path / "fig1.toml").write_text(CASE)
    (tmp_path / "found.json").write_text('{"late": 0.0389, "at": [2.2808]}')
    page = tmp_path / "page.md"
    page.write_text(text + "\n", encoding="utf-8")
    return [each.split(": ")[1] for each in page_numbers.unmatched(page)]


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("| 1 | `fig1` | peak at 15.36 Hz | within 0.2 % |", []),  # rounded as on the page
        ("| 1 | `fig1` | peak at 15.4 Hz |", []),
        ("| 1 | `fig1` | peak at 15.35 Hz |", ["15.35"]),
        ("| 1 | `fig1` | a gap of 0.1 mm, 35.1 mm/s |", []),
        ("| 1 | `fig1` | a gap of 0.13 mm |", ["0.13 mm"]),  # inputs are not rounded
        ("| 1 | `fig1` | −15.36 Hz, 1.5357e1 Hz, 1.5e−1 |", ["1.5e−1"]),
        ("| 1 | `fig1` | Fig. 31 and eq. 29–30, §4.2, RK23, `99.5` |", []),
        ("| 1 | `fig1` | 99 from the title |", ["99"]),
        ("`fig1` says 15.36 Hz\nand 7.7 Hz", ["7.7"]),
        ("Nothing is named, and 7.7 Hz is no row", []),
        ("| what | 7.7 Hz |", ["7.7"]),
        ("| what | 7 of 9 |", []),
        ("<!-- numbers: found.json -->\nlost at 2.281, 3.9 % late", []),
        ("<!-- numbers: found.json -->\nlost at 2.282\n\nafter it 9.9 goes unread", ["2.282"]),
        ("<!-- begin: it -->\n| `fig1` | 7.7 |\n<!-- end: it -->", []),
        ("```\n| `fig1` | 7.7 |\n```", []),
    ],
)
def test_a_number_is_held_to_its_case_or_result(tmp_path: Path, text: str, found: list[str]) -> None:
    assert unmatched(tmp_path, text) == found


def test_the_head_of_a_case_is_held_to_it(tmp_path: Path) -> None:
    case = tmp_path / "fig2.toml"
    (tmp_path / "more.json").write_text("[0.25]")
    case.write_text("# Fig. 3: 15.4 Hz and 7.7 Hz, period 4, 0.4\n# numbers: more.json\n\n# 8.8\n" + CASE)
    assert page_numbers.unmatched(case) == ["fig2 more: 7.7", "fig2 more: 0.4"]


def test_a_source_that_is_not_there_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"no file gone\.json"):
        unmatched(tmp_path, "<!-- numbers: gone.json -->\n1.5")


def test_no_number_without_a_source_but_those_listed() -> None:
    listed = json.loads(page_numbers.LISTED.read_text(encoding="utf-8"))
    found = page_numbers.all_unmatched()
    new = {name: [each for each in numbers if each not in listed.get(name, [])] for name, numbers in found.items()}
    gone = {name: [each for each in numbers if each not in found.get(name, [])] for name, numbers in listed.items()}
    assert not any(new.values()), f"give these a source (see page_numbers.py): {new}"
    assert not any(gone.values()), f"these have one now, run python tests/page_numbers.py --write: {gone}"


def test_the_paper_s_figures_need_no_exception() -> None:
    paper = page_numbers.ROOT / "cases" / "paper" / "README.md"
    assert [name for name in page_numbers.all_unmatched() if name.startswith("cases/paper")] == []
    checked = [number for block, files in page_numbers.blocks(paper) for number in page_numbers.numbers(block) if files]
    assert len(checked) > 50
