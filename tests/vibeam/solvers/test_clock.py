"""Readings of a deadline's clock: few enough to be no part of a solver's cost, often enough to end its work."""

from __future__ import annotations

import numpy as np
import pytest

import vibeam
from vibeam.flight.engine.threads import OutOfTime, ending_at

SOLVERS = ["direct", "ivanov", "zhuravlev", "moreau"]
SYSTEM = vibeam.ImpactSystem.from_modes(10.0, 0.02, 1.0, 1.0, gap=0.0, restitution=0.7)
AHEAD = 20  # readings of sweeps and points beside those of the evaluations


class Clock:
    """Clock that counts its readings, one second each."""

    def __init__(self) -> None:
        self.readings = 0

    def __call__(self) -> float:
        self.readings += 1
        return float(self.readings)


def sweep(solver: str, settle: int = 40) -> vibeam.FrequencyResponse:
    return vibeam.sweep(SYSTEM, omega=np.array([20.0]), amplitude=1e-3, settle=settle, hold=8, solver=solver)


@pytest.mark.parametrize(("solver", "each"), [("direct", 40), ("ivanov", 40), ("zhuravlev", 40), ("moreau", 5_000)])
def test_the_clock_is_read_at_few_of_the_evaluations(solver: str, each: int) -> None:
    """``each``: evaluations that a reading is for at least; Moreau's are steps of one kernel, a period at a time."""
    clock = Clock()
    with ending_at(clock, np.inf):
        found = sweep(solver)
    assert int(found.evaluations.sum()) > 1_000
    assert clock.readings < AHEAD + found.evaluations.sum() / each


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_deadline_ends_a_point_under_way(solver: str) -> None:
    clock = Clock()
    with ending_at(clock, 3.0), pytest.raises(OutOfTime):
        sweep(solver, 100_000)
    assert clock.readings == 4
