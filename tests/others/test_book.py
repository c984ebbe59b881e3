"""The page of the proof book, held to the stored results."""

from __future__ import annotations

import pytest

from tests.others.book import PAGE, SECTIONS, page


def test_the_page_is_that_of_the_results() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert page(text) == text


@pytest.mark.parametrize("section", SECTIONS)
def test_another_number_on_the_page_is_seen(section: str) -> None:
    text = PAGE.read_text(encoding="utf-8")
    begin = text.index(f"<!-- begin: {section} -->")
    at = next(place for place in range(text.index("\n", begin), len(text)) if text[place] in "12345678")
    changed = text[:at] + str(int(text[at]) + 1) + text[at + 1 :]
    assert page(changed) == text != changed


def test_a_page_without_a_place_is_refused() -> None:
    with pytest.raises(SystemExit, match="no place for the table 'problems'"):
        page("nothing")
