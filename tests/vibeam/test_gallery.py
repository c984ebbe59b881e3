"""The gallery: each number of an answer is one that its script prints, its picture is drawn, its page has all of it."""

from __future__ import annotations

import re
import struct
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]
GALLERY = ROOT / "cases" / "gallery"
NAMES = sorted(path.stem for path in GALLERY.glob("*.py") if path.stem != "pages")
LONGEST = 80  # lines of a script's code


@pytest.fixture(scope="module")
def pages() -> Iterator[ModuleType]:
    sys.path.insert(0, str(GALLERY))
    import pages as module  # type: ignore[import-not-found]

    yield module
    sys.path.remove(str(GALLERY))
    del sys.modules["pages"]


@pytest.mark.parametrize("name", NAMES)
def test_an_answer_holds_what_its_script_prints(pages: ModuleType, name: str, tmp_path: Path) -> None:
    script = pages.script_of(GALLERY / f"{name}.py")
    printed = pages.run(script.path, tmp_path)
    assert pages.unfounded(script, printed) == []
    assert undetected(pages, script.answer, printed) == []
    width, height = size_of(tmp_path / script.picture)
    assert width >= 900
    assert height >= 500
    assert [path.name for path in tmp_path.iterdir()] == [script.picture]
    made = pages.page(script, printed)
    assert all(part in made for part in (script.question, script.answer, printed, script.code, script.picture))


def undetected(pages: ModuleType, answer: str, printed: str) -> list[str]:
    """Numbers of an answer that could be larger by one in the last digit, and nothing would be said."""
    known = pages.printed_claims(printed)
    claims = pages.claims(answer)
    assert len(claims) >= 4
    moved = [pages.Claim(each.text, each.value + 2 * each.half, each.half, each.unit) for each in claims]
    return [each.text for each in moved if any(map(each.holds, known)) and not any(map(each.holds, claims))]


def size_of(picture: Path) -> tuple[int, int]:
    """Width and height of a PNG."""
    return struct.unpack(">II", picture.read_bytes()[16:24])  # type: ignore[return-value]


@pytest.mark.parametrize("name", NAMES)
def test_a_script_is_a_question_an_answer_and_few_lines(pages: ModuleType, name: str) -> None:
    script = pages.script_of(GALLERY / f"{name}.py")
    assert script.question.endswith("?")
    assert len(script.answer.split()) >= 60
    assert len(script.code.splitlines()) <= LONGEST
    assert f'savefig("{script.picture}"' in script.code


def test_the_page_of_the_gallery_lists_all(pages: ModuleType) -> None:
    listed = dict(re.findall(r"\[([^\]]+)\]\((\w+\.(?:py|ipynb))\)", (GALLERY / "README.md").read_text("utf-8")))
    found = {pages.script_of(GALLERY / f"{name}.py").question: f"{name}.py" for name in NAMES}
    assert {title: file for title, file in listed.items() if file.endswith(".py") and file != "pages.py"} == found
    assert {file for file in listed.values() if file.endswith(".ipynb")} == {path.name for path in pages.NOTEBOOKS}


def test_numbers_are_read_with_their_units(pages: ModuleType) -> None:
    text = "By 1 000 N/mm −0.5 % (§ 3), 1.2e-3 s, 8 modes, 4 ms; `5 mm`, [x#7](y8), fig13, 2² and 3 wide."
    read = [(each.value, each.unit) for each in pages.claims(text)]
    assert read == [(1000, "N/mm"), (-0.5, "%"), (3, ""), (1.2e-3, "s"), (8, "mode"), (4, "ms"), (3, "")]
    assert [each.value for each in pages.printed_claims("label 5: 7 Hz\nno label 8\n")] == [7]


def test_a_wrong_number_or_unit_is_seen(pages: ModuleType, tmp_path: Path) -> None:
    place = tmp_path / "one.py"
    place.write_text('"""Why?\n\nIt has 12.3 mm and 4 modes.\n"""\nprint("a: 12.34 mm, 4 modes")\n')
    script = pages.script_of(place)
    assert pages.unfounded(script, pages.run(place, tmp_path)) == []
    for printed in ("a: 12.36 mm, 4 modes", "a: 12.34 Hz, 4 modes", "a: 12.34 mm, 5 modes", "12.34 mm, 4 modes"):
        assert len(pages.unfounded(script, f"{printed}\n")) >= 1
