"""Stroboscopic map of a driven system by exact flights: its Jacobian, and the multipliers of its fixed points.

The map P carries (η, η') at one phase of the drive over n of its periods. Its Jacobian is the product of the tangent
maps of the motion (``flight.disturbance.tangent``), where these are known; elsewhere it is taken by central differences
of flights.

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

from vibeam.flight.disturbance.maps import maps_of, tangent_fault
from vibeam.flight.disturbance.tangent import TangentMaps
from vibeam.flight.engine.threads import pause
from vibeam.flight.event_driven import Segments
from vibeam.flight.kernels import layout
from vibeam.flight.solver import ExactSolver, exact_solver
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Ended
from vibeam.system.several_harmonics import SeveralHarmonics
from vibeam.system.state import State
from vibeam_models.arrays import Array, Complex

DECAY = 8.0  # nepers within one factor, beyond which the weakest direction would drown in round-off
WEAK = 1e-6  # share of the largest multiplier below which the product's eigenvalues are not good enough
ROUNDS, FEWEST = 100, 8  # of the frame
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
    for turn in range(1, ROUNDS + 1):
        begin, total = frame, np.eye(len(logs))
        for matrix in factors:
            frame, upper = np.linalg.qr(matrix @ frame)
            total = upper @ total
        with np.errstate(divide="ignore", invalid="ignore"):
            logs += np.log(np.abs(np.diag(total)))
            parted = -np.diff(logs)
        if turn >= FEWEST and not np.any((parted <= CONVERGED) & (parted * ROUNDS > CONVERGED / 2 * turn)):
            break  # those that have not parted yet never will
    turned = begin.T @ frame
    cuts = [0, *(np.flatnonzero(parted > CONVERGED) + 1), len(logs)]
    groups = [slice(a, b) for a, b in pairwise(cuts)]
    return np.concatenate([np.linalg.eigvals(turned[g, g] @ total[g, g]).astype(complex) for g in groups])


IMPACTS = 10**7  # at most, in one call
NEAR = 0.02  # share of the motion's size within which it must return for a fixed point to be looked for
GIVEN = 1e-7  # share within which a start is on the fixed point, stable or not
ROUND_OFF, STALLED = 1e-14, 1e-10  # steps of Newton's method that end it, the latter where they shrink no more
DIFFERENCE = 1e-5  # share of the motion's size by which neighbouring flights differ


@dataclass(frozen=True)
class Flown:
    """Motion over some drive periods: segments, the state at its end, ``evaluations`` of the contact displacement."""

    system: ImpactSystem
    drive: Drive
    segments: Segments
    state: State
    evaluations: int = 0

    def maps(self) -> TangentMaps:
        """Its tangent maps; ValueError where they are not known."""
        return maps_of(self.system, self.drive, self.segments, self.state)


class MotionEnded(ValueError, ArithmeticError):
    """Motion that ends on the way; the message says why."""


class StroboscopicMap:
    """Stroboscopic map of one system and drive at ``time`` of the drive, s; ValueError without a drive period.

    ``runner``: an exact solver of the system, to be shared by maps at drives for which it was made. Under ``several``
    harmonics, whose ``system`` and ``drive`` these are, the oscillators that bring them are no unknowns of a motion.
    """

    def __init__(
        self, system: ImpactSystem, drive: Drive, time: float = 0.0, *, runner: ExactSolver | None = None,
        several: SeveralHarmonics | None = None,
    ) -> None:  # fmt: skip
        if not drive.omega > 0:
            raise ValueError("drive: omega must be > 0: without a drive period there is no stroboscopic map")
        self.runner = exact_solver(system, drive.omega) if runner is None else runner
        self.system, self.drive, self.time, self.several = system, drive, time, several
        self.period, n = 2 * np.pi / drive.omega, system.size
        own = n if several is None else several.plain.size
        self.units = np.concatenate([np.where(system.omega > 0, system.omega, drive.omega), np.ones(n)])
        self.unknowns = np.concatenate([np.arange(own), n + np.arange(own)])

    def at(self, time: float) -> StroboscopicMap:
        """The map of the same motion at another time of the drive, s."""
        moved = object.__new__(type(self))
        moved.__dict__.update(self.__dict__)
        moved.time = time % self.period
        return moved

    def entered(self, state: State) -> State:
        """State of the system, of one of the modes at the section's time."""
        return state if self.several is None else self.several.enter(state, self.time)

    def flown(self, state: State | None, periods: float, begin: float | None = None) -> Flown:
        """Motion over ``periods`` from ``state`` at ``begin`` (None: ``time``); MotionEnded where it fails."""
        pause()
        start = (self.time if begin is None else begin) % self.period
        ended, _, last, segments, stats = self.runner.simulate(
            self.drive, state, start, start + periods * self.period, IMPACTS
        )
        if ended is not Ended.COMPLETE:
            raise MotionEnded(f"the motion ended: {ended.value}")
        return Flown(self.system, self.drive, segments, last, int(stats["evaluations"]))

    def in_flight(self, state: State | None, periods: int = 1) -> tuple[StroboscopicMap, State]:
        """The map at the middle of the longest flight of the next ``periods``, and the state there.

        Without any flight, of the longest contact.
        """
        trace = self.flown(state, float(periods)).segments.trace
        free = trace[:, layout.WHAT] == layout.FREE
        lengths = np.where(free if free.any() else True, trace[:, layout.DURATION], 0.0)
        longest = int(np.argmax(lengths))
        begin = self.time % self.period
        after = float(trace[longest, layout.START] + lengths[longest] / 2 - begin) / self.period
        there, middle = self.at(begin + after * self.period), self.flown(state, after).state
        if self.several is not None:  # whose oscillators are where the harmonics have them, to the last digit
            middle = there.entered(self.several.leave(middle, there.time))
        return there, middle

    def vector(self, state: State) -> Array:
        """Unknowns of a state in units of velocity: (2n,)."""
        return np.asarray((np.concatenate([state.displacement, state.velocity]) * self.units)[self.unknowns])

    def moved(self, state: State, by: Array) -> State:
        """The state with its unknowns moved, in units of velocity."""
        values = np.concatenate([state.displacement, state.velocity])
        values[self.unknowns] += by / self.units[self.unknowns]
        return State(values[: self.system.size], values[self.system.size :], state.resting)

    def jacobian(self, state: State, periods: float, flown: Flown) -> Array:
        """Jacobian of the map over ``periods`` by the unknowns in units of velocity, along the motion ``flown``."""
        if tangent_fault(self.system):
            return self._by_differences(state, periods, flown)
        whole = flown.maps().product() * (self.units[:, None] / self.units)
        return np.asarray(whole[np.ix_(self.unknowns, self.unknowns)])

    def _by_differences(self, state: State, periods: float, flown: Flown) -> Array:
        small, columns = DIFFERENCE * self.size(flown), []
        for unit in np.eye(len(self.unknowns)):
            ends = [self.flown(self.moved(state, side * small * unit), periods).state for side in (1, -1)]
            columns.append((self.vector(ends[0]) - self.vector(ends[1])) / (2 * small))
        return np.array(columns).T

    def multipliers(self, flown: Flown, matrix: Array) -> Complex:
        """Multipliers, largest first, of the periodic motion ``flown`` with the Jacobian ``matrix``."""
        if not tangent_fault(self.system) and len(self.unknowns) == 2 * self.system.size:
            return cycle_multipliers(flown.maps(), self.units)
        values = np.linalg.eigvals(matrix).astype(complex)
        return np.asarray(values[np.argsort(-np.abs(values), kind="stable")])

    def size(self, flown: Flown) -> float:
        """Size of a motion in units of velocity: the largest of its states at the ends of segments."""
        poses = np.concatenate([flown.segments.poses.reshape(len(flown.segments.poses), -1)])
        known = (poses * self.units)[:, self.unknowns]
        return float(np.sqrt(max(np.max(np.sum(known**2, axis=1)), np.sum(self.vector(flown.state) ** 2))))
