"""Periodic motions by shooting: damped Newton's method for P(x) = x, with P a stroboscopic map by exact flights.

Each step x ← x − λ (DP − 1)⁻¹ (P(x) − x) is accepted where the simplified correction with the old Jacobian shrinks,
|Δ̄| ≤ (1 − λ/2) |Δ| (the natural monotonicity test: Deuflhard 2011, Newton Methods for Nonlinear Problems, sec. 3.3),
else λ is halved. The iteration ends at round-off, or with a reason.
"""

from __future__ import annotations

from enum import Enum
from functools import partial
from typing import NamedTuple

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.readout import rests, sides, struck
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.stroboscopic import GIVEN, NEAR, ROUND_OFF, STALLED, Flown, MotionEnded, StroboscopicMap
from vibeam.system.state import State
from vibeam_models.arrays import Array

NEWTON = 40  # steps
LEAST = 1 / 256  # share of a step
QUADRATIC = 1e-6  # share of the motion's size of a correction whose square is round-off
LARGEST = 1.0  # step, as a share of the motion's size
SINGULAR = 0.02  # singular value of DP − 1 below which a fold is near
FREE = 1 / 3  # the same as a share of that of the modes without contact, where little damping makes that small
SAME = 1e-8  # share of the motion's size within which a motion repeats after fewer periods
MISSED = 1e-8  # share of the motion's size by which a motion that repeats may miss itself
LONGEST = 16  # drive periods after which a motion is looked at for repeating
WATCH = 64  # periods, times n, over which a motion near a stable fixed point must not leave it


class Reason(Enum):
    """Reason why shooting led to no periodic motion."""

    ENDED = "the flight from the start fails"
    DIVERGED = "Newton's method wanders off: no such motion near the start"
    FOLD = "a fold is near, and the residual does not fall: beyond it there is no such motion"
    SHORTER = "it leads to a motion that repeats after fewer periods"
    LEFT = "it leads to another motion, with other contacts than the start"
    DRIFTS = "it does not repeat: a mode that nothing holds or damps drifts or grows"
    NO_PERIOD = "there is no drive, so that nothing says when a motion repeats"


class NoOrbit(ValueError):
    """Refusal of shooting, with its ``reason`` and Newton's ``corrections`` so far, as shares of the motion's size.

    >>> import vibeam
    >>> system, drive = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, restitution=0.5), vibeam.Drive(2.0, 0.1)
    >>> try:
    ...     vibeam.orbits(system, drive, 2, start=vibeam.orbits(system, drive)[0].state)
    ... except vibeam.NoOrbit as refused:
    ...     refused.reason.name, len(refused.corrections) > 0
    ('SHORTER', True)
    """

    def __init__(self, reason: Reason, more: str = "", corrections: tuple[float, ...] = ()) -> None:
        super().__init__(f"no periodic motion: {reason.value}{f' ({more})' if more else ''}")
        self.reason, self.corrections = reason, corrections


def shoot(
    section: StroboscopicMap, state: State, periods: int, steps: int = NEWTON, *, kept: bool = False
) -> Orbit:  # fmt: skip
    """The motion near ``state`` at the section's time that repeats after ``periods`` drive periods, not fewer.

    Any law, contacts on any side or place, several impacts, rests, stable or not. Its state is taken at the section's
    time or, where that is in a contact, in the middle of the longest flight. NoOrbit with the reason, after so many
    ``steps`` of Newton's method too. ``kept``: it is taken at the section's time wherever that is, is so near that no
    step is damped, may repeat sooner, and is known to the square of Newton's last correction.
    """
    fixed = _newton(section, state, periods, steps, QUADRATIC if kept else 0.0)
    if kept:
        return orbit_at(section, periods, fixed.state, fixed.flown, fixed.matrix, fixed.corrections)
    free = fixed.flown.segments.trace[:, layout.WHAT] == layout.FREE
    if free.any() and not free[0]:
        section, state = section.in_flight(fixed.state, periods)
        fixed = _newton(section, state, periods)._replace(corrections=fixed.corrections)
    for sooner in (k for k in range(1, periods) if periods % k == 0):
        back = section.vector(section.flown(fixed.state, sooner).state)
        if np.linalg.norm(back - section.vector(fixed.state)) <= SAME * section.size(fixed.flown):
            raise NoOrbit(Reason.SHORTER, f"after {sooner}, not {periods}", fixed.corrections)
    return orbit_at(section, periods, fixed.state, fixed.flown, fixed.matrix, fixed.corrections)


class _Fixed(NamedTuple):
    """Fixed point of the map: its state, the motion from there on and its Jacobian."""

    state: State
    flown: Flown
    matrix: Array
    corrections: tuple[float, ...]


def _newton(section: StroboscopicMap, state: State, periods: int, steps: int = NEWTON, enough: float = 0.0) -> _Fixed:
    try:
        flown = section.flown(state, periods)
    except ArithmeticError as end:
        raise NoOrbit(Reason.ENDED, str(end)) from None
    corrections: list[float] = []
    for _ in range(steps):
        size = float(np.linalg.norm(section.vector(flown.state))) if enough else section.size(flown)
        size = max(size, np.finfo(float).tiny)
        matrix = _jacobian(section, state, periods, flown, corrections)
        solve = _Solve(matrix)
        apart = _apart(section, state, flown)
        step = solve(apart)
        length = float(np.linalg.norm(step)) / size
        last = corrections[-1] if corrections else np.inf
        corrections.append(length)
        if length < enough:
            return _Fixed(section.moved(state, -step), flown, matrix, tuple(corrections))
        if enough and not length <= LARGEST:
            raise NoOrbit(Reason.DIVERGED, "", tuple(corrections))
        if length <= ROUND_OFF or (length < STALLED and length >= last / 2):
            if np.linalg.norm(apart) > MISSED * size:  # along a direction that no step changes
                raise NoOrbit(Reason.DRIFTS, "", tuple(corrections))
            return _Fixed(state, flown, matrix, tuple(corrections))
        taken = _taken(section, state, step, periods, solve, length, enough > 0) if np.isfinite(length) else None
        if taken is None and np.linalg.norm(apart) <= ROUND_OFF * size:  # beside a fold no step makes that smaller
            return _Fixed(state, flown, matrix, tuple(corrections))
        if taken is None:
            fold = solve.least < _singular(section, periods)
            raise NoOrbit(Reason.FOLD if fold else Reason.DIVERGED, "", tuple(corrections))
        state, flown = taken
    raise NoOrbit(Reason.DIVERGED, f"after {steps} steps", tuple(corrections))


def _jacobian(
    section: StroboscopicMap, state: State, periods: int, flown: Flown, corrections: list[float]
) -> Array:  # fmt: skip
    try:
        matrix = section.jacobian(state, periods, flown)
    except MotionEnded as end:  # of one beside it, where the map is differenced
        raise NoOrbit(Reason.ENDED, str(end), tuple(corrections)) from None
    if not np.isfinite(matrix).all():
        raise NoOrbit(Reason.DIVERGED, "the map has no derivative: a touch without velocity", tuple(corrections))
    return matrix


def _singular(section: StroboscopicMap, periods: int) -> float:
    """Singular value of DP − 1 below which a fold is near; of modes alone it is |1 − e^{λT}| at least."""
    own = section.system if section.several is None else section.several.plain
    rates = own.omega * (-own.zeta + np.emath.sqrt(own.zeta**2 - 1))
    alone = np.abs(np.expm1(rates[own.omega > 0] * section.period * periods))
    return float(min(SINGULAR, FREE * np.min(alone, initial=1.0)))


def _taken(
    section: StroboscopicMap, state: State, step: Array, periods: int, solve: _Solve, length: float, whole: bool
) -> tuple[State, Flown] | None:
    """The state after the largest share of a step that brings it nearer, and its motion; None where none does.

    ``whole``: after all of it.
    """
    share, before = min(1.0, LARGEST / length), float(np.linalg.norm(step))
    while share >= (1.0 if whole else LEAST):
        trial = section.moved(state, -share * step)
        try:
            flown = section.flown(trial, periods)
        except ArithmeticError:  # it led beyond the stop
            share /= 2
            continue
        if whole or (share == 1.0 and length < STALLED):
            return trial, flown
        if float(np.linalg.norm(solve(_apart(section, trial, flown)))) <= (1 - share / 2) * before:
            return trial, flown
        share /= 2
    return None


class _Solve:
    """Solution of (DP − 1) Δ = r, of the least size where the matrix is singular; ``least``: singular value."""

    def __init__(self, matrix: Array) -> None:
        self.left, self.values, self.right = np.linalg.svd(matrix - np.eye(len(matrix)))
        self.least = float(self.values[-1])
        small = self.values <= np.finfo(float).eps * len(matrix) * max(self.values[0], 1.0)
        self.inverse = np.where(small, 0.0, 1 / np.where(small, 1.0, self.values))

    def __call__(self, apart: Array) -> Array:
        return np.asarray(self.right.T @ (self.inverse * (self.left.T @ apart)))


def _apart(section: StroboscopicMap, state: State, flown: Flown) -> Array:
    return section.vector(flown.state) - section.vector(state)


def orbit_at(
    section: StroboscopicMap, periods: int, state: State, flown: Flown, matrix: Array,
    corrections: tuple[float, ...] = (),
) -> Orbit:  # fmt: skip
    """Record of the periodic motion ``flown`` from ``state`` at the section's time; ``matrix``: the map's Jacobian."""
    trace = flown.segments.trace
    hit = struck(trace) & (trace[:, layout.BEFORE] > 0)
    size = max(section.size(flown), np.finfo(float).tiny)
    return Orbit(
        section.system, section.drive, periods, section.time % section.period, state,
        trace[hit, layout.START] + trace[hit, layout.DURATION], trace[hit, layout.BEFORE], sides(trace)[hit],
        int(rests(trace).sum()), bool(np.abs(np.linalg.eigvals(matrix)).max() < 1), True,
        float(np.linalg.norm(_apart(section, state, flown))) / size, corrections, matrix,
        partial(section.multipliers, flown, matrix), section.runner,
    )  # fmt: skip


def cycle(section: StroboscopicMap, state: State) -> Orbit | None:
    """The periodic motion that ``state`` is on, or near to where it is stable; None without one."""
    start, size, flown = section.vector(state), 0.0, state
    for periods in range(1, LONGEST + 1):
        flown = section.flown(flown, 1).state
        back = section.vector(flown)
        size = max(size, float(np.linalg.norm(start)), float(np.linalg.norm(back)))
        if np.linalg.norm(back - start) > NEAR * size:
            continue
        try:
            fixed = _newton(section, state, periods)
            found = orbit_at(section, periods, fixed.state, fixed.flown, fixed.matrix, fixed.corrections)
        except (NoOrbit, MotionEnded):
            continue
        apart = float(np.linalg.norm(section.vector(found.state) - start)) / max(size, np.finfo(float).tiny)
        if apart <= GIVEN or (apart <= NEAR and abs(found.multipliers[0]) < 1 and _stays(section, state, found)):
            return found
    return None


def _stays(section: StroboscopicMap, state: State, orbit: Orbit) -> bool:
    """Test whether the motion from ``state`` has come no nearer to leaving the orbit after a while."""
    centre = section.vector(orbit.state)
    later = section.vector(section.flown(state, WATCH * orbit.periods).state)
    before = float(np.linalg.norm(section.vector(state) - centre))
    return bool(np.linalg.norm(later - centre) <= before + GIVEN * np.linalg.norm(centre))
