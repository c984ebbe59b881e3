"""Verification at random points: the finest model, as the sweep computes it, against the claims."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vibeam.case.plans import SweepPlan
from vibeam.runs.accuracy.candidates import Candidate, distance, rows
from vibeam.runs.accuracy.choice import BranchChoice
from vibeam.system.response import FrequencyResponse, join
from vibeam.system.state import State

POINTS = 24
SEED = 20181005
DRAWS = 8  # readings of an aperiodic motion

# Student's t for one more sample, 99 % two-sided, over 2 … 8 samples
STUDENT = (63.657, 9.925, 5.841, 4.604, 4.032, 3.707, 3.499)


@dataclass(frozen=True)
class Verified:
    """One verified point: the worst relative error of the quantities, and the allowed one.

    ``statistical``: the finest model's motion is aperiodic there; the error is then that to the mean of its own
    readings, and ``allowed`` has their scatter on top of the accuracy. ``seconds``: CPU time of the sweep's own point.
    """

    way: str
    frequency: float
    error: float
    allowed: float
    statistical: bool
    seconds: float

    @property
    def passed(self) -> bool:
        """True where the error is within the allowed one."""
        return self.error <= self.allowed


def verify(
    branches: Sequence[BranchChoice], finest: Candidate, plan: SweepPlan, within: float, count: int = POINTS
) -> list[Verified]:
    """Verify ``count`` points drawn with a fixed seed, or all where there are fewer, in order."""
    places = [(branch, place) for branch in branches for place in range(len(branch.grid))]
    chosen = np.random.default_rng(SEED).permutation(len(places))[:count]
    return [_verified(*places[int(i)], finest, plan, within) for i in np.sort(chosen)]


def _verified(branch: BranchChoice, place: int, finest: Candidate, plan: SweepPlan, within: float) -> Verified:
    point = int(branch.grid[place])
    omega, base = finest.known.omega[[point]], float(finest.known.amplitude[point])
    before = _state_before(branch, place, finest)
    first, state = finest.flight.steady(omega, base, before, plan.settle, plan.hold, plan.output)
    drawn = [first]
    while first.period[0] == 0 and len(drawn) < DRAWS:
        more, state = finest.flight.steady(omega, base, state, 0, plan.hold, plan.output)
        drawn.append(more)
    error, allowed = judged(rows(branch.response, np.array([place])), join(drawn), finest.quantities, within)
    frequency = float(branch.response.frequency[place])
    return Verified(branch.direction, frequency, error, allowed, len(drawn) > 1, float(first.cpu_seconds[0]))


def _state_before(branch: BranchChoice, place: int, finest: Candidate) -> State | None:
    """State before a place: the finest model's motion at the frequency before; None where unknown."""
    if place == 0:
        return None
    kind = int(branch.kind[place - 1])
    return branch.states.get(place - 1) if kind < 0 else finest.known.state(int(branch.grid[place - 1]), kind)


def judged(
    found: FrequencyResponse, drawn: FrequencyResponse, quantities: Sequence[str], within: float
) -> tuple[float, float]:
    """Error of one point and the allowed one, against one periodic reading or several aperiodic ones."""
    if len(drawn) == 1:
        return float(np.max(np.abs(distance(found, drawn, quantities)))), within
    errors = np.array([distance(found, rows(drawn, np.array([i])), quantities)[0] for i in range(len(drawn))])
    spread = np.std(errors, axis=0, ddof=1) * np.sqrt(1 + 1 / len(drawn)) * STUDENT[len(drawn) - 2]
    worst = int(np.argmax(np.abs(errors.mean(axis=0)) - spread))
    return float(np.abs(errors.mean(axis=0))[worst]), float(within + spread[worst])
