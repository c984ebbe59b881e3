"""Random systems of 1 to 30 modes under all laws, burst by burst against arbitrary precision.

``python tests/hard/torture.py impacts`` is the same for as many as there is time for.
"""

from __future__ import annotations

import pytest
from agreement import Tally, follow
from random_systems import random_case

FEW, MANY = 12, 1000


def judge(first: int, count: int, impacts: int, seconds: float) -> Tally:
    total = Tally()
    for number in range(first, first + count):
        tally = follow(random_case(7, number, size=(1, 2, 3, 5)[number % 4]), impacts, seconds=seconds)
        assert not tally.faults, (number, tally.faults)
        total.add(tally)
    return total


def test_none_missed_none_invented_none_late() -> None:
    total = judge(0, FEW, 12, 1.0)
    assert total.impacts > 4 * FEW
    assert total.worst_relative < 1e-11


@pytest.mark.slow
def test_none_missed_none_invented_none_late_in_many() -> None:
    total = judge(FEW, MANY, 100, 30.0)
    assert total.impacts > 60 * MANY
    assert total.worst_relative < 1e-11
