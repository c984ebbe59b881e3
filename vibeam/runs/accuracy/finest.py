"""Finest model along the sweep, with the state carried; flown only where no closed form is known.

A closed-form motion continues from one frequency to the next while it is stable, disturbances decay within the
settling, and no other motion is near. Where it ends the model is flown, with the sweep's own settling and hold,
until it reaches a known motion: after the first part of the settling or at its end. Stretches without any
stable known motion are passed on as a whole.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from vibeam.case.plans import SweepPlan
from vibeam.runs.accuracy.candidates import EXACT, Candidate, Evaluation
from vibeam.runs.accuracy.choice import BranchChoice
from vibeam.runs.accuracy.closed_forms import KINDS, size
from vibeam.system.response import Ended, FrequencyResponse
from vibeam.system.state import State
from vibeam_models.arrays import Index

DIES_OUT = 1e-2  # remainder of a disturbance after settling, as a share of the accuracy
NEAR = 0.25  # largest change from one frequency to the next, as a share of the distance to another motion
PARTS = 3  # number of parts of the settling, the first of which is checked for a known motion
SAME = 1e-4  # tolerance, as a share of the state, for a flown motion to be a known one


RunOf = Callable[[BranchChoice, Index, int], int]  # along a run on one known motion; gives how many of its places held
Unsettled = Callable[[BranchChoice, Index, State | None], State | None]  # a stretch without one: the state after it


@dataclass(frozen=True)
class Position:
    """Position along a sweep: on a known motion of ``kind`` at ``point`` (−1: on none), or in a ``state``."""

    kind: int = -1
    point: int = -1
    state: State | None = None


@dataclass(frozen=True)
class Finest:
    """Finest model by ``formula`` and by ``flight``, and their numbers in the study's list; the sweep."""

    formula: Candidate
    formula_number: int
    flight: Candidate
    number: int
    plan: SweepPlan
    within: float

    def known(self, point: int) -> bool:
        """Test whether a stable motion is known there."""
        return any(self.formula.known.radius(kind)[point] < 1 for kind in KINDS)


def track(branch: BranchChoice, finest: Finest, start: Position, run: RunOf, unsettled: Unsettled) -> Position:
    """Fill the branch along the sweep; return the position at its end."""
    position, place = start, 0
    while place < len(branch.grid):
        count = _places_continued(branch, finest, position, place)
        held = run(branch, np.arange(place, place + count), position.kind) if count else 0
        if held:
            branch.kind[place : place + held] = position.kind
            place += held
            position = Position(position.kind, int(branch.grid[place - 1]))
            continue
        state = finest.formula.known.state(position.point, position.kind) if position.kind >= 0 else position.state
        stretch = _places_without_motion(branch, finest.formula, place) if place or position.state is not None else 0
        if stretch:
            state = unsettled(branch, np.arange(place, place + stretch), state)
            place, position = place + stretch, Position(state=state)
        else:
            position = fly_points(branch, finest, place, state)
            place += 1
    return position


def fly_points(branch: BranchChoice, finest: Finest, place: int, state: State | None) -> Position:
    """Compute one place as the sweep does, cut short where a known motion is reached; return the position after it."""
    point, plan = branch.grid[place : place + 1], finest.plan
    part = plan.settle // PARTS if finest.known(int(point[0])) else 0
    if part:
        _, (state,) = finest.flight.fly(point, state, part, 1)
        kind = identified(finest.formula, int(point[0]), state)
        evaluation = finest.formula.evaluate(point, kind) if kind >= 0 else None
        if evaluation is not None and np.isfinite(evaluation.error[0]):
            branch.enter(np.array([place]), evaluation, finest.formula_number)
            branch.kind[place] = kind
            return Position(kind, int(point[0]))
        part += 1
    response, states = finest.flight.fly(point, state, plan.settle - part, plan.hold)
    note_flight(branch, np.array([place]), finest.number, response, states)
    kind = identified(finest.formula, int(point[0]), states[0]) if response.period[0] in (1, -1) else -1
    branch.kind[place] = kind
    return Position(kind, int(point[0]), states[0])


def note_flight(
    branch: BranchChoice, places: Index, number: int, response: FrequencyResponse, states: Sequence[State]
) -> None:
    """Enter points flown by the finest model: exact where periodic, else one reading of many."""
    error = np.where(response.ended == Ended.COMPLETE.code, EXACT, np.nan)
    branch.enter(places, Evaluation(response, error), number)
    branch.statistical[places] = (response.period == 0) & np.isfinite(error)
    branch.states.update(zip(places.tolist(), states, strict=True))


def identified(finest: Candidate, point: int, after: State) -> int:
    """Known stable motion that a state is on, −1 for none."""
    known, one = finest.known, np.array([point])
    state = np.stack([after.displacement, after.velocity])[None]
    for kind in KINDS:
        if known.radius(kind)[point] < 1:
            miss = size(known.system, known.omega[one], known.states(one, kind) - state)
            if miss[0] <= SAME * size(known.system, known.omega[one], state)[0]:
                return kind
    return -1


def _places_continued(branch: BranchChoice, finest: Finest, position: Position, place: int) -> int:
    """Number of places from ``place`` on along which the known motion continues."""
    if position.kind < 0:
        return 0
    points = np.concatenate([[position.point], branch.grid[place:]])
    known, kind = finest.formula.known, position.kind
    with np.errstate(invalid="ignore", over="ignore"):
        settled = known.radius(kind)[points[1:]] ** finest.plan.settle <= DIES_OUT * finest.within
    first = np.minimum(points[1:], points[:-1])
    moved = points[1:] != points[:-1]
    near = np.zeros(len(first), dtype=bool)
    near[moved] = known.relative_step(kind)[first[moved]] > NEAR
    ends = np.flatnonzero(~settled | near)
    return int(ends[0]) if len(ends) else len(first)


def _places_without_motion(branch: BranchChoice, finest: Candidate, place: int) -> int:
    """Number of places from ``place`` on without a known stable, admissible motion."""
    known, left = finest.known, branch.grid[place:]
    stable = np.stack([known.radius(kind)[left] < 1 for kind in KINDS], axis=1)
    for count in np.flatnonzero(stable.any(axis=1)):
        one = left[count : count + 1]
        if any(np.isfinite(finest.evaluate(one, int(kind)).error[0]) for kind in np.flatnonzero(stable[count])):
            return int(count)
    return len(left)
