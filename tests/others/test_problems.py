"""Problems of others: ours beside theirs, a wrong model found by every row, and the stored book of the same numbers."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tests.others.problem import Problem, agreed, digits, spoiling
from tests.others.problems_book import PROBLEMS, RESULTS, name_of, sources

GATE = [pytest.param(each, marks=pytest.mark.slow if each.slow else (), id=name_of(each)) for each in PROBLEMS]


@pytest.mark.parametrize("problem", GATE)
def test_ours_beside_theirs(problem: Problem) -> None:
    """Within what the row lets pass, and as the book has it: its last digits are of the machine."""
    stored = {row["name"]: row["ours"] for row in json.loads(Path(RESULTS).read_text(encoding="utf-8"))["rows"]}
    found = problem.check()
    problem.hold(found, np.array(stored[name_of(problem)]), max(1e-9, problem.within / 10))


@pytest.mark.parametrize("problem", GATE)
def test_a_model_that_is_a_little_wrong_is_found(problem: Problem) -> None:
    """Frequencies, stiffnesses, constant forces larger by thirty times what passes, 5 % where whole numbers count."""
    factor = 1 + 30 * problem.within if problem.within else 1.05
    with spoiling(factor), pytest.raises((AssertionError, ValueError, IndexError)):
        problem.check()


def test_the_book_has_forty_problems_of_twelve_sources() -> None:
    assert len({each.problem for each in PROBLEMS if not each.formula}) >= 40
    assert len(sources()) >= 12


def test_names_are_of_one_row_each() -> None:
    assert len({name_of(each) for each in PROBLEMS}) == len(PROBLEMS)


@pytest.mark.parametrize(
    ("printed", "found", "count"),
    [("9950", 9950.37, 4), ("9950", 9951, 3), ("0.01563", 0.015630008, 4), ("1.20", 1.2049, 3), ("1.20", 1.206, 2),
     ("-3.58082e-4", -3.58082e-4, 6), ("0.999", 1.0001, 2), ("5", 9.0, 0), ("0", 0.0, 1)],
)  # fmt: skip
def test_digits_on_which_two_numbers_agree(printed: str, found: float, count: int) -> None:
    assert agreed(printed, found) == count <= digits(printed)
