"""Random systems of 1 to 30 modes under all laws, burst by burst against arbitrary precision.

``python tests/hard/torture.py impacts`` is the same for as many as there is time for.
"""

from __future__ import annotations

import numpy as np
import pytest
from agreement import Tally, burst, follow
from random_systems import Case, random_case

import vibeam

FEW, MANY = 12, 1000


def judge(first: int, count: int, impacts: int, seconds: float) -> Tally:
    total = Tally()
    for number in range(first, first + count):
        readout = follow(random_case(7, number, size=(1, 2, 3, 5)[number % 4]), impacts, seconds=seconds)
        assert not readout.faults, (number, readout.faults)
        total.add(readout)
    return total


def test_none_missed_none_invented_none_late() -> None:
    total = judge(0, FEW, 12, 0.2)
    assert total.impacts > 4 * FEW
    assert total.worst_relative < 1e-11


@pytest.mark.parametrize("number", [1083, 1119])
def test_starts_among_the_last_digits_of_an_accumulation(number: int) -> None:
    """Several impacts at one double, and a start that may lie on either side of the stop: neither is a finding."""
    readout = follow(random_case(1, number, 1 + number % 3), 300, 8, 10.0)
    assert not readout.faults
    assert readout.impacts > 30


def test_a_gap_that_is_a_small_difference_of_static_offsets() -> None:
    """3.4 ns of flight, while s/ω² is 44 mm: a root by doubles alone is off by 77 times what the data's digits make."""
    case = random_case(1, 313, 2)
    late = vibeam.State(
        np.array([-3.91030262673338e-05, -9.437687087326912e-06]),
        np.array([-0.022143684621753493, -0.005344474879804234]),
    )
    readout, _, _ = burst(Case(case.system, case.drive, late), 0.1275902892260291, 8)
    assert not readout.faults
    assert readout.impacts > 1
    assert readout.worst_blur < 1


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
