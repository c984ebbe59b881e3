"""Random systems of 1 to 30 modes under all laws, burst by burst against arbitrary precision.

``python tests/hard/torture.py impacts`` is the same for as many as there is time for.
"""

from __future__ import annotations

import numpy as np
import pytest
from agreement import Tally, follow
from random_systems import random_case

import vibeam

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


@pytest.mark.parametrize("number", [313, 1083, 1119])
def test_systems_that_once_had_findings(number: int) -> None:
    """A gap that is a small difference of static offsets (313); starts among an accumulation's last digits."""
    tally = follow(random_case(1, number, 1 + number % 3), 300, 8, 10.0)
    assert not tally.faults
    assert tally.impacts > 30
    assert tally.worst_blur < 1


@pytest.mark.parametrize("seed", [3, 8, 17])
def test_where_a_motion_ends_changes_no_bit_of_it(seed: int) -> None:
    """A free mode is carried by Taylor series, whose round-off is judged by the panel at hand."""
    rng = np.random.default_rng(seed)
    contact = [1.0, 0.5 * rng.normal(), 0.3 * rng.normal()]
    system = vibeam.ImpactSystem.from_modes(
        [0.0, 1.0, 7.0], [0.0, 0.01, 0.02], contact, [0.2, 0.1, 0.3],
        gap=0.0, restitution=rng.uniform(0.6, 0.9), static=[0.5, 0.0, 0.0],
    )  # fmt: skip
    drive, start = vibeam.Drive(0.5, 0.2), vibeam.State(np.array([-1.0, 0.0, 0.0]), np.zeros(3))
    times = vibeam.simulate(system, drive, 40.0, start).impact_times
    assert len(times) > 40
    for k in range(0, len(times) - 1, len(times) // 40):
        part = vibeam.simulate(system, drive, float(times[k : k + 2].mean()), start)
        np.testing.assert_array_equal(part.impact_times, times[: k + 1])


@pytest.mark.slow
def test_none_missed_none_invented_none_late_in_many() -> None:
    total = judge(FEW, MANY, 100, 30.0)
    assert total.impacts > 60 * MANY
    assert total.worst_relative < 1e-11
