"""Largest Lyapunov exponents of many motions side by side: their sign tells chaos from what neighbours agree on.

As ``lyapunov``, with one disturbance a motion in place of an orthonormal frame (``disturbances``). Motions are flown
piece by piece, and those with about as many events stand together, so that little of the arrays is padding.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.engine.threads import pause
from vibeam.flight.event_driven import EventDrivenSolver
from vibeam.periodic.disturbances import Piece, carried, linearised, units_of
from vibeam.periodic.lyapunov import SURE, lyapunov
from vibeam.periodic.stroboscopic import Flown, StroboscopicMap
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State
from vibeam_models.arrays import Array

BATCHES = 10
ALIGNED = 20  # drive periods over which a disturbance turns into its direction
TRIAL = 4  # drive periods by whose events motions are put in order
TOGETHER = 128  # motions that are flown together at most
PIECE = 80  # drive periods flown at a time at most
ROOM = 4_000_000  # numbers of the propagators of motions that are gone through together


@dataclass(frozen=True)
class LargestExponents:
    """Largest Lyapunov exponents (points,), 1/s, and their standard errors; NaN for a motion that failed."""

    exponents: Array
    errors: Array

    def signs(self, sure: float = SURE) -> NDArray[np.int64]:
        """1: chaos, −1: neighbours come together; 0: within ``sure`` standard errors of zero, or not known."""
        margin = sure * self.errors
        with np.errstate(invalid="ignore"):
            return (self.exponents > margin).astype(np.int64) - (self.exponents < -margin)


def largest_exponents(
    systems: Sequence[ImpactSystem],
    drives: Sequence[Drive],
    states: Sequence[State | None],
    periods: int = 200,
    runners: Sequence[EventDrivenSolver] | None = None,
) -> LargestExponents:
    """Compute the largest exponents of motions that have settled: each from its state at the drive's phase 0.

    ``periods``: drive periods of each mean; all systems have the same number of modes. ``runners``: their solvers,
    where they are made already. ValueError as in ``lyapunov``.
    """
    found, errors = np.full((2, len(systems)), np.nan)
    walks = list[_Walk]()
    for point, (system, drive, state) in enumerate(zip(systems, drives, states, strict=True)):
        if system.beyond_plain:
            found[point], errors[point] = _alone(system, drive, state, periods)
            continue
        walk = _Walk(point, StroboscopicMap(system, drive, runner=None if runners is None else runners[point]), state)
        walk.fly(TRIAL)
        walks.append(walk)
    walks.sort(key=lambda walk: walk.events)
    for first in range(0, len(walks), TOGETHER):
        some = walks[first : first + TOGETHER]
        _walked(some, periods)
        for walk in some:
            found[walk.point], errors[walk.point] = walk.mean(periods)
    return LargestExponents(found, errors)


def _alone(system: ImpactSystem, drive: Drive, state: State | None, periods: int) -> tuple[float, float]:
    try:
        one = lyapunov(system, drive, state, settle=0, periods=periods, count=1)
    except ArithmeticError:
        return float("nan"), float("nan")
    return one.largest, float(one.errors[0])


class _Walk:
    """One motion under way, and the disturbance carried along it."""

    def __init__(self, point: int, section: StroboscopicMap, state: State | None) -> None:
        self.point, self.section, self.state = point, section, state
        self.events, self.failed, self.gone = 0, False, 0.0
        system = section.system
        self.disturbance = np.random.default_rng(0).standard_normal((2, system.size))
        self.disturbance[0] /= units_of(system)
        self.log, self.times, self.logs = 0.0, list[Array](), list[Array]()

    def fly(self, periods: float) -> Flown | None:
        """The next ``periods`` of the motion; None where it fails."""
        try:
            flown = self.section.flown(self.state, periods)
        except ArithmeticError:
            self.failed = True
            return None
        self.state, self.events = flown.state, len(flown.segments.trace)
        return flown

    def note(self, times: Array, logs: Array) -> None:
        """Keep what the disturbance grew by, as a logarithm, up to the ``times`` (drive periods) of a piece."""
        self.times.append(self.gone + times)
        self.logs.append(self.log + logs)
        self.gone, self.log = float(self.times[-1][-1]), float(self.logs[-1][-1])

    def mean(self, periods: int) -> tuple[float, float]:
        """Mean growth and its standard error by batches, 1/s; −∞ where the disturbance is lost."""
        if self.failed:
            return float("nan"), float("nan")
        marks = np.linspace(ALIGNED, ALIGNED + periods, BATCHES + 1)
        with np.errstate(invalid="ignore"):
            at = np.interp(marks, np.concatenate(self.times), np.concatenate(self.logs))
            rates = np.diff(at) / (self.section.period * periods / BATCHES)
        if not np.all(np.isfinite(rates)):
            return -np.inf, 0.0
        return float(rates.mean()), float(rates.std(ddof=1) / np.sqrt(BATCHES))


def _walked(walks: list[_Walk], periods: int) -> None:
    """Fly motions piece by piece, and carry one disturbance along each."""
    whole = ALIGNED + periods
    for step in np.diff(np.linspace(0, whole, ceil(whole / PIECE) + 1)).tolist():
        pause()
        flown = [(walk, walk.fly(step)) for walk in walks if not walk.failed]
        waiting = [(walk, linearised(each)) for walk, each in flown if each is not None]
        waiting.sort(key=lambda pair: len(pair[1].times))
        while waiting:
            some = max(1, ROOM // waiting[-1][1].flown.size)
            _disturb(waiting[-some:])
            del waiting[-some:]


def _disturb(waiting: list[tuple[_Walk, Piece]]) -> None:
    """Carry the disturbances over a piece of each motion."""
    walks, pieces = zip(*waiting, strict=True)
    start = np.stack([walk.disturbance for walk in walks], axis=1)
    grown, after = carried([walk.section.system for walk in walks], pieces, start)
    for place, (walk, found) in enumerate(zip(walks, grown, strict=True)):
        walk.disturbance = after[:, place]
        walk.note(*found)
