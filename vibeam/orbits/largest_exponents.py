"""Largest Lyapunov exponents of many motions side by side: their sign tells chaos from what neighbours agree on.

As ``lyapunov``, with one disturbance a motion in place of an orthonormal frame, and without forming a matrix: over a
flight the modes' propagators, at an impact a correction of rank two, over a rest on the stop the held system in its
eigenvectors. The motions lie side by side in arrays and are gone through event by event: O(n) a flight and motion.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.event_driven import EventDrivenSolver
from vibeam.flight.kernels.layout import AT_CLOCK, BEFORE, CHATTER, DURATION, END, IMPACT, RESTING, STUCK, WHAT
from vibeam.flight.linear.propagator import propagators
from vibeam.flight.tangent import held_matrix
from vibeam.orbits.lyapunov import SURE, lyapunov
from vibeam.orbits.stroboscopic import Flown, StroboscopicMap
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State

Array = NDArray[np.float64]

BATCHES = 10

ALIGNED = 20  # drive periods over which a disturbance turns into its direction

ROOM = 4_000_000  # numbers of the arrays of motions that are gone through together


@dataclass(frozen=True)
class LargestExponents:
    """Largest Lyapunov exponents (points,), 1/s, and their standard errors; NaN for a motion that failed."""

    exponents: Array
    errors: Array

    @property
    def signs(self) -> NDArray[np.int64]:
        """1: chaos, −1: neighbours come together; 0: within two standard errors of zero, or not known."""
        margin = SURE * self.errors
        with np.errstate(invalid="ignore"):
            return (self.exponents > margin).astype(np.int64) - (self.exponents < -margin)


class _Motion(NamedTuple):
    """One motion's flights, n modes and m segments: propagators, how each ends, drive periods gone by."""

    flown: Array  # (m, 4, n)
    struck: Array  # (m, n) what δη and δη' lose, over c·δη and c·δη'
    turned: Array  # (m, n) what δη' gains, over c·δη
    held: NDArray[np.bool_]  # (m,) at rest on the stop
    stopped: NDArray[np.bool_]  # (m,) an accumulation of impacts ends in rest
    durations: Array  # (m,)
    times: Array  # (m,) at the end, in drive periods


def largest_exponents(
    systems: Sequence[ImpactSystem],
    drives: Sequence[Drive],
    states: Sequence[State | None],
    periods: int = 200,
    runner: EventDrivenSolver | None = None,
) -> LargestExponents:
    """Compute the largest exponents of motions that have settled: each from its state at the drive's phase 0.

    ``periods``: drive periods of each mean; all systems have the same number of modes. ``runner``: the solver of all of
    them where they are one. ValueError as in ``lyapunov``.
    """
    found, errors = np.full((2, len(systems)), np.nan)
    waiting: list[tuple[int, _Motion]] = []
    room = 0
    for point, (system, drive, state) in enumerate(zip(systems, drives, states, strict=True)):
        if system.beyond_plain:
            found[point], errors[point] = _alone(system, drive, state, periods)
            continue
        try:
            flown = StroboscopicMap(system, drive, runner=runner).flown(state, periods + ALIGNED)
        except ArithmeticError:
            continue
        waiting.append((point, _motion(flown)))
        room = max(room, waiting[-1][1].flown.size)
        if room * len(waiting) > ROOM:
            _together(systems, waiting, found, errors, periods)
            waiting, room = [], 0
    _together(systems, waiting, found, errors, periods)
    return LargestExponents(found, errors)


def _alone(system: ImpactSystem, drive: Drive, state: State | None, periods: int) -> tuple[float, float]:
    try:
        one = lyapunov(system, drive, state, settle=0, periods=periods, count=1)
    except ArithmeticError:
        return float("nan"), float("nan")
    return one.largest, float(one.errors[0])


def _motion(flown: Flown) -> _Motion:
    system, drive, trace = flown.system, flown.drive, flown.segments.trace
    durations, speed, c = np.ascontiguousarray(trace[:, DURATION]), trace[:, BEFORE], system.contact
    mobility, damping = float(c @ c), 2 * system.zeta * system.omega
    last = np.stack([flown.state.displacement, flown.state.velocity])
    ends = np.concatenate([flown.segments.poses[1:], last[None]])
    hit = (trace[:, END] == IMPACT) & (speed > 0)
    before = ends[:, 1] + np.outer((speed - ends[:, 1] @ c) / mobility, c)
    phase = drive.omega * (trace[:, AT_CLOCK] + durations)
    push = np.outer(drive.omega**2 * drive.amplitude * np.sin(phase), system.load) + system.static
    toward = (push - damping * before - system.omega**2 * ends[:, 0]) @ c
    share = np.where(hit, (1 + system.restitution) / mobility, 0.0)[:, None]
    lean = np.where(hit, toward / np.where(hit, speed, 1.0), 0.0)[:, None]
    held = trace[:, WHAT] == RESTING
    return _Motion(
        np.stack(propagators(system, np.where(held, 0.0, durations))[:4], axis=1),
        share * c,
        share * (damping + lean) * c,
        held,
        np.isin(trace[:, END], (CHATTER, STUCK)),
        durations,
        np.cumsum(durations) * drive.omega / (2 * np.pi),
    )


def _together(
    systems: Sequence[ImpactSystem], waiting: list[tuple[int, _Motion]], found: Array, errors: Array, periods: int
) -> None:
    """Carry one disturbance along each motion, all of them event by event, and note the mean growth."""
    if not waiting:
        return
    points = [point for point, _ in waiting]
    made = [motion for _, motion in waiting]
    logs = _grown([systems[point] for point in points], made)
    for point, motion, grown in zip(points, made, logs, strict=True):
        marks = np.linspace(ALIGNED, ALIGNED + periods, BATCHES + 1)
        with np.errstate(invalid="ignore"):
            at = np.interp(marks, motion.times, grown[: len(motion.times)])
            seconds = float(motion.durations.sum()) / (ALIGNED + periods) * periods / BATCHES
            rates = np.diff(at) / seconds
        lost = not np.all(np.isfinite(rates))
        found[point] = -np.inf if lost else rates.mean()
        errors[point] = 0.0 if lost else rates.std(ddof=1) / np.sqrt(BATCHES)


def _grown(systems: list[ImpactSystem], made: list[_Motion]) -> Array:
    """Logarithm of the disturbance (points, events) after each event; −∞ once it is lost."""
    events, n = max(len(motion.times) for motion in made), systems[0].size
    c = np.array([system.contact for system in systems])
    units = np.array([np.where(system.omega > 0, system.omega, 1.0) for system in systems])
    still = np.zeros((events, 4, n))
    still[:, (0, 3)] = 1.0
    flown = np.stack([np.concatenate([motion.flown, still[len(motion.flown) :]]) for motion in made], axis=1)
    struck, turned = (
        np.stack([_padded(getattr(motion, name), events) for motion in made], axis=1) for name in ("struck", "turned")
    )
    held, stopped = (
        np.stack([_padded(getattr(motion, name), events) for motion in made], axis=1) for name in ("held", "stopped")
    )
    start = np.random.default_rng(0).standard_normal((2, n))
    x, y = (np.tile(row, (len(made), 1)) for row in start)
    x = x / units
    logs, log = np.zeros((len(made), events)), np.zeros(len(made))
    rests = _Rests(systems)
    for event in range(events):
        p = flown[event]
        x, y = p[:, 0] * x + p[:, 1] * y, p[:, 2] * x + p[:, 3] * y
        for point in np.flatnonzero(held[event]).tolist():
            x[point], y[point] = rests.over(point, float(made[point].durations[event]), x[point], y[point])
        moved, swung = np.sum(c * x, axis=1)[:, None], np.sum(c * y, axis=1)[:, None]
        x, y = x - struck[event] * moved, y - struck[event] * swung + turned[event] * moved
        for point in np.flatnonzero(stopped[event]).tolist():
            x[point], y[point] = rests.stopped(point, x[point]), rests.stopped(point, y[point])
        size = np.sqrt(np.sum((units * x) ** 2 + y**2, axis=1))
        with np.errstate(divide="ignore"):
            log = log + np.log(size)
        kept = np.where(size > 0, size, 1.0)[:, None]
        x, y, logs[:, event] = x / kept, y / kept, log
    return logs


def _padded(rows: NDArray[np.generic], count: int) -> NDArray[np.generic]:
    room = np.zeros((count - len(rows), *rows.shape[1:]), dtype=rows.dtype)
    return np.concatenate([rows, room])


class _Rests:
    """The held systems in their eigenvectors, made when first asked for."""

    def __init__(self, systems: list[ImpactSystem]) -> None:
        self.systems = systems
        self.known: dict[int, tuple[NDArray[np.complex128], ...]] = {}

    def stopped(self, point: int, row: Array) -> Array:
        """A row on the modes without its part along the contact."""
        c = self.systems[point].contact
        return np.asarray(row - c * (float(c @ row) / float(c @ c)))

    def over(self, point: int, duration: float, x: Array, y: Array) -> tuple[Array, Array]:
        """The disturbance after a rest."""
        if point not in self.known:
            system = self.systems[point]
            across = np.kron(np.eye(2), np.linalg.svd(system.contact[None, :])[2][1:].T)
            values, vectors = np.linalg.eig(across.T @ held_matrix(system) @ across)
            self.known[point] = values, across @ vectors, np.linalg.inv(vectors) @ across.T
        values, vectors, inverse = self.known[point]
        after = (vectors @ (np.exp(values * duration) * (inverse @ np.concatenate([x, y])))).real
        return after[: len(x)], after[len(x) :]
