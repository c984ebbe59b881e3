"""Motions outside the closed-form family at measured points, by exact flights of the model at given keys."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vibeam.runs.sweep import sweep
from vibeam.system.quantities import Ended
from vibeam.system.response import Branches, FrequencyResponse
from vibeam_models.arguments import counted
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.studies.fit.points import Points
    from vibeam.studies.fit.problem import Problem
    from vibeam_models.arrays import Index


SETTLE, HOLD = 300, 32  # drive periods
UNTOLD = 9.0  # least squared residual of a motion that does not repeat, whose value is that of no one record
VARIES = 0.1  # share by which records of such a motion are taken to differ


@dataclass(frozen=True)
class OtherMotion:
    """Motion outside the family: ``period`` drive periods until it repeats (0: not within 16), ``impacts`` in these.

    ``rest``: share of the time at rest on the stop. ``value``: of the reference's quantity, SI; NaN where it is not
    comparable. ``cost``: squared residual of the measured point.
    """

    period: int
    impacts: int
    rest: float
    value: float
    cost: float

    @property
    def called(self) -> str:
        """What it does, in words."""
        if self.rest > 0:
            return "rests on the stop in every period"
        if self.period == 0:
            return "does not repeat within 16 periods"
        span = "a period" if self.period == 1 else f"in {self.period} periods"
        return f"has {counted(self.impacts, 'impact')} {span}"


def other_motions(problem: Problem, x: Array, which: Index) -> dict[int, list[OtherMotion]]:
    """Motions outside the family at the points ``which``, flown upward and downward from their neighbours on."""
    found: dict[int, list[OtherMotion]] = {}
    for group, at, own in problem.parts():
        asked = np.flatnonzero(np.isin(at, which))
        if not len(asked) or group.unstable:
            continue
        forward = problem.forward[group.fidelity]
        drive = problem.surfaces[group.fidelity].at(x).drive[own]
        frequency, first = np.unique(group.frequency, return_index=True)
        near = _with_neighbours(np.searchsorted(frequency, group.frequency[asked]), len(frequency))
        system = forward.system(problem.values(x))
        branches = sweep(
            system, omega=2 * np.pi * frequency[near], amplitude=drive[first[near]], settle=SETTLE, hold=HOLD,
            direction="both", output=forward.output,
        )  # fmt: skip
        assert isinstance(branches, Branches)
        for _, flown in branches.items():
            for j in asked.tolist():
                k = int(np.argmin(np.abs(flown.frequency - group.frequency[j])))
                found.setdefault(int(at[j]), []).extend(_outside(group, j, flown, k))
    return {j: each for j, each in found.items() if each}


def _with_neighbours(places: Index, count: int) -> Index:
    """Places and those beside them, ascending."""
    every = np.unique(np.concatenate([places - 1, places, places + 1]))
    return every[(every >= 0) & (every < count)]


def _outside(group: Points, j: int, flown: FrequencyResponse, k: int) -> Iterator[OtherMotion]:
    """The motion at place ``k`` of a sweep, where it is outside the family of point ``j``."""
    period, rest = int(flown.period[k]), float(flown.rest[k])
    if flown.ended[k] != Ended.COMPLETE.code or period < 0:
        return
    impacts = round(float(flown.impacts_per_period[k]) * max(period, 1))
    if (period, impacts) == (group.periods, 1) and rest == 0:
        return
    value = float(getattr(flown, group.quantity)[k]) if group.gain is None else float("nan")
    off, told = value - float(group.value[j]), period > 0
    spread = float(np.hypot(group.uncertainty[j], 0.0 if told else VARIES * value))
    cost = (off / spread) ** 2 if np.isfinite(off) else 0.0
    yield OtherMotion(period, impacts, rest, value if told else float("nan"), cost if told else max(cost, UNTOLD))
