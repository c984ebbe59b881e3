"""Stroboscopic map of a driven system by exact flights: its fixed points by Newton's method, their multipliers.

The map P carries (η, η') at one phase of the drive over n of its periods. Its Jacobian is the product of the tangent
maps of the motion (``flight.disturbance.tangent``), so that Newton's method x ← x − (DP − 1)⁻¹ (P(x) − x) converges
quadratically on any periodic motion whose tangent maps are known: with any number of impacts and rests, stable or not.
The phase is taken in the middle of the longest flight, where neither side of an impact is near.

The eigenvalues of the product M of all maps are good to a share ε of the largest. Where some are weaker than that by
far (a mode that dies within the period), they are taken from M's factors one by one: an orthonormal frame is carried
round and round (orthogonal iteration, Q_{k+1} R_{k+1} = M Q_k factor by factor) until it returns to itself up to
rotations within groups of about equal size; on each group the eigenvalues of (Q_kᵀ Q_{k+1}) R_{k+1} are then M's
(Bojanczyk, Golub & Van Dooren 1992, the periodic Schur form). Where directions are lost (rests, R = 0) the frame spans
what is left of them, and the others are 0.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from vibeam.flight.disturbance.tangent import TangentMaps, tangent_fault
from vibeam.flight.engine.threads import pause
from vibeam.flight.event_driven import EventDrivenSolver, Segments
from vibeam.flight.kernels import layout
from vibeam.flight.solver import exact_solver
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Ended
from vibeam.system.state import State
from vibeam_models.arrays import Array, Complex

DECAY = 8.0  # nepers within one factor, beyond which the weakest direction would drown in round-off
WEAK = 1e-6  # share of the largest multiplier below which the product's eigenvalues are not good enough
ROUNDS = 100  # of the frame
CONVERGED = 40.0  # nepers by which two directions must have parted in all rounds to be told apart


def cycle_multipliers(maps: TangentMaps, units: Array) -> Complex:
    """Multipliers (2n,), largest first, of a periodic motion; exactly 0 for directions that it loses.

    ``units`` (2n,): factors that give displacements and velocities one unit.
    """
    count, lost = len(maps), [maps.lost(i) for i in range(len(maps))]
    first = int(np.argmax(lost)) if max(lost) else count - 1
    factors = [
        matrix * (units[:, None] / units)
        for k in range(count)
        for matrix in maps.steps((first + 1 + k) % count, maps.fastest, DECAY)
    ]
    frame = np.linalg.qr(units[:, None] * maps.kept(first))[0]
    found = np.zeros(2 * maps.system.size, dtype=complex)
    if frame.shape[1]:
        found[: frame.shape[1]] = _eigenvalues(factors, frame)
    return np.asarray(found[np.argsort(-np.abs(found), kind="stable")])


def _eigenvalues(factors: list[Array], frame: Array) -> Complex:
    """Eigenvalues of the factors' product (the last one leftmost) on the space that the frame spans."""
    carried = frame
    for matrix in factors:
        carried = matrix @ carried
    values = np.linalg.eigvals(frame.T @ carried).astype(complex)
    if np.abs(values).min() >= WEAK * np.abs(values).max():
        return values
    shuffled = np.random.default_rng(0).standard_normal((frame.shape[1],) * 2)  # without any direction of its own
    return _by_frames(factors, frame @ np.linalg.qr(shuffled)[0])


def _by_frames(factors: list[Array], frame: Array) -> Complex:
    logs = np.zeros(frame.shape[1])
    for _ in range(ROUNDS):
        begin, total = frame, np.eye(len(logs))
        for matrix in factors:
            frame, upper = np.linalg.qr(matrix @ frame)
            total = upper @ total
        with np.errstate(divide="ignore"):
            logs += np.log(np.abs(np.diag(total)))
    turned = begin.T @ frame
    cuts = [0, *(np.flatnonzero(-np.diff(logs) > CONVERGED) + 1), len(logs)]
    groups = [slice(a, b) for a, b in pairwise(cuts)]
    return np.concatenate([np.linalg.eigvals(turned[g, g] @ total[g, g]).astype(complex) for g in groups])


IMPACTS = 10**7  # at most, in one call
LONGEST = 16  # drive periods after which a motion is looked at for repeating
NEAR = 0.02  # share of the motion's size within which it must return for a fixed point to be looked for
GIVEN = 1e-7  # share within which a start is on the fixed point, stable or not
NEWTON, ROUND_OFF, STALLED = 25, 1e-14, 1e-10
WATCH = 64  # periods, times n, over which a motion near a stable fixed point must not leave it


@dataclass(frozen=True)
class Flown:
    """Motion over some drive periods: segments, and the state at its end."""

    system: ImpactSystem
    drive: Drive
    segments: Segments
    state: State


@dataclass(frozen=True)
class Cycle:
    """Periodic motion: drive periods, the tangent maps along it, its 2n Floquet multipliers, largest first."""

    periods: int
    state: State
    multipliers: Complex
    flown: Flown


class MotionEnded(ValueError, ArithmeticError):
    """Motion that ends on the way; the message says why."""


class StroboscopicMap:
    """Stroboscopic map of one system and drive; ValueError where its tangent maps are not known, or without a period.

    ``time``: of the drive at which states are taken, s.
    """

    def __init__(self, system: ImpactSystem, drive: Drive, time: float = 0.0) -> None:
        if not drive.omega > 0:
            raise ValueError("drive: omega must be > 0: without a drive period there is no stroboscopic map")
        runner = exact_solver(system, drive.omega)
        if reason := tangent_fault(system):
            raise ValueError(f"system: Lyapunov exponents are not known for {reason}")
        assert isinstance(runner, EventDrivenSolver)
        self.system, self.drive, self.runner, self.time = system, drive, runner, time
        self.period = 2 * np.pi / drive.omega
        self.units = np.concatenate([np.where(system.omega > 0, system.omega, drive.omega), np.ones(system.size)])

    def flown(self, state: State | None, periods: float, begin: float | None = None) -> Flown:
        """Motion over ``periods`` from ``state`` at ``begin`` (None: ``time``); MotionEnded where it fails."""
        pause()
        start = (self.time if begin is None else begin) % self.period
        ended, _, last, segments, _ = self.runner.simulate(
            self.drive, state, start, start + periods * self.period, IMPACTS
        )
        if ended is not Ended.COMPLETE:
            raise MotionEnded(f"the motion ended: {ended.value}")
        return Flown(self.system, self.drive, segments, last)

    def in_flight(self, state: State | None) -> tuple[StroboscopicMap, State]:
        """The map at the middle of the longest flight of the next period, and the state there."""
        trace = self.flown(state, 1.0).segments.trace
        lengths = np.where(trace[:, layout.WHAT] == layout.RESTING, 0.0, trace[:, layout.DURATION])
        longest = int(np.argmax(lengths))
        begin = self.time % self.period
        after = float(trace[longest, layout.START] + lengths[longest] / 2 - begin) / self.period
        moved = object.__new__(StroboscopicMap)
        moved.__dict__.update(self.__dict__)
        moved.time = (begin + after * self.period) % self.period
        return moved, self.flown(state, after).state

    def vector(self, state: State) -> Array:
        """State (2n,) in units of velocity."""
        return np.asarray(np.concatenate([state.displacement, state.velocity]) * self.units)

    def cycle(self, state: State) -> Cycle | None:
        """The periodic motion that ``state`` is on, or near to where it is stable; None without one."""
        start, size, flown = self.vector(state), 0.0, state
        for periods in range(1, LONGEST + 1):
            flown = self.flown(flown, 1).state
            back = self.vector(flown)
            size = max(size, float(np.linalg.norm(start)), float(np.linalg.norm(back)))
            if np.linalg.norm(back - start) > NEAR * size:
                continue
            found = self._newton(state, periods, size)
            if found is None:
                continue
            apart = float(np.linalg.norm(self.vector(found.state) - start)) / max(size, np.finfo(float).tiny)
            if apart <= GIVEN or (apart <= NEAR and abs(found.multipliers[0]) < 1 and self._stays(state, found)):
                return found
        return None

    def _newton(self, state: State, periods: int, size: float) -> Cycle | None:
        last, floor = np.inf, np.finfo(float).tiny
        for _ in range(NEWTON):
            try:
                flown = self.flown(state, periods)
            except ArithmeticError:  # the step led beyond the stop
                return None
            maps = TangentMaps(flown.system, flown.drive, flown.segments, flown.state)
            step = self._step(state, flown.state, jacobian(maps))
            length = float(np.linalg.norm(step)) / max(size, floor)
            if length <= ROUND_OFF or (length < STALLED and length >= last / 2):
                return Cycle(periods, state, cycle_multipliers(maps, self.units), flown)
            if not np.isfinite(length) or length > 1:
                return None
            values = (self.vector(state) - step) / self.units
            state, last = State(values[: self.system.size], values[self.system.size :], state.resting), length
        return None

    def _step(self, state: State, after: State, matrix: Array) -> Array:
        scaled = matrix * (self.units[:, None] / self.units)
        apart = self.vector(after) - self.vector(state)
        return np.asarray(np.linalg.lstsq(scaled - np.eye(len(scaled)), apart, rcond=None)[0])

    def _stays(self, state: State, cycle: Cycle) -> bool:
        """Test whether the motion from ``state`` has come no nearer to leaving the cycle after a while."""
        centre = self.vector(cycle.state)
        later = self.vector(self.flown(state, WATCH * cycle.periods).state)
        before = float(np.linalg.norm(self.vector(state) - centre))
        return bool(np.linalg.norm(later - centre) <= before + GIVEN * np.linalg.norm(centre))


def jacobian(maps: TangentMaps) -> Array:
    """Product (2n, 2n) of the tangent maps along a whole motion."""
    matrix = np.eye(2 * maps.system.size)
    for i in range(len(maps)):
        pause()
        matrix = maps.over(i) @ matrix
    return matrix
