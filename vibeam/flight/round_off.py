"""How far round-off has grown along a motion: from which impact on a single trajectory means nothing.

Disturbances of the state are carried along exactly to first order, over a flight by the modes' propagator, through an
impact by its saltation matrix (``orbits.multipliers``), over a rest by the constrained system, and what is round-off
of the numbers at hand is added at every event. The covariance P of the error of (η, η') so obeys P⁺ = D P Dᵀ + Q with
D the disturbance's matrix over the segment and Q the round-off of its end. With contact velocity v and acceleration a
before it, the impact's own errors follow from

    δt = −(c·δη)/v,     δv = c·δη' + a δt.

In chaos P grows by itself: where it reaches the size of the motion, the impacts that follow are one possible motion of
the system, but not the one that started there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.endless import endless
from vibeam.flight.equilibrium import size_of_motion
from vibeam.flight.kernels.layout import AT_CLOCK, BEFORE, CHATTER, DURATION, END, IMPACT, RESTING, STUCK, WHAT
from vibeam.flight.kernels.thresholds import FAR, FAR_DRIVEN
from vibeam.flight.linear.propagator import propagators

if TYPE_CHECKING:
    from vibeam.flight.event_driven import Segments
    from vibeam.system.impact_system import Drive, ImpactSystem
    from vibeam.system.state import State


Array = NDArray[np.float64]

EPSILON = float(np.finfo(float).eps)

LOST = 0.1  # error of an impact's velocity, as a share of what is usual, from which on it says nothing

STRUCK = (IMPACT, CHATTER, STUCK)


class ExactMotion(Protocol):
    """What the estimate needs of a trajectory."""

    @property
    def system(self) -> ImpactSystem:
        """Whose motion it is."""
        ...

    @property
    def drive(self) -> Drive:
        """Under which."""
        ...

    @property
    def segments(self) -> Segments:
        """Flights and rests, one after another."""
        ...

    @property
    def state(self) -> State:
        """At the end."""
        ...

    @property
    def impact_velocities(self) -> Array:
        """Just before each impact, m/s."""
        ...


@dataclass(frozen=True)
class Errors:
    """Estimated errors (one standard deviation) of the impacts of a motion, shapes (m,)."""

    time: Array  #: of the impact times, s
    velocity: Array  #: of the impact velocities, m/s
    amplification: Array  #: how many times larger a velocity's error is than the round-off of that velocity
    meaningful: int  #: impacts before the first whose velocity is known to no better than a tenth of what is usual


def errors_of(path: ExactMotion, start: Array | None = None) -> Errors:
    """The estimated errors of the impacts of ``path``, from round-off alone or from a disturbed start.

    ``start``: covariance (2n, 2n) of the error of the first (η, η'); round-off of its values where None. ValueError for
    a system with another law or more than plain modes.
    """
    path.system.require_plain("the error estimate")
    walk = _Walk(path, start)
    found = np.array([error for error in walk.impacts() if error is not None]).reshape(-1, 2)
    speeds = path.impact_velocities
    usual = float(np.sqrt(np.mean(speeds**2))) if len(speeds) else 0.0
    lost = np.flatnonzero(~(found[:, 1] <= LOST * usual))
    with np.errstate(divide="ignore", invalid="ignore"):
        grown = np.where(speeds > 0, found[:, 1] / (EPSILON * speeds), np.inf)
    return Errors(found[:, 0], found[:, 1], grown, int(lost[0]) if len(lost) else len(speeds))


class _Walk:
    """The covariance carried along a trajectory, segment by segment."""

    def __init__(self, path: ExactMotion, start: Array | None) -> None:
        self.system, self.drive = path.system, path.drive
        self.trace, self.poses = path.segments.trace, path.segments.poses
        last = np.stack([path.state.displacement, path.state.velocity])
        self.ends = np.concatenate([self.poses[1:], last[None]])
        self.clocks, self.unending = self.trace[:, AT_CLOCK], endless(self.trace)
        self.flights = propagators(self.system, self.trace[:, DURATION])
        self.rest = _constrained(self.system)
        self.far = _far(self.system, self.drive, self.poses[0])
        self.covariance = np.diag(self._round_off(self.poses[0], 0.0)) if start is None else np.array(start)

    def impacts(self) -> list[tuple[float, float] | None]:
        """(time, velocity) error at the end of every segment that an impact ended, None for the others."""
        with np.errstate(over="ignore", invalid="ignore"):
            return [self._segment(i) for i in range(len(self.trace))]

    def _segment(self, i: int) -> tuple[float, float] | None:
        duration, end = self.trace[i, DURATION], int(self.trace[i, END])
        resting = self.trace[i, WHAT] == RESTING
        self._carry(self._held(duration) if resting else self._flown(i))
        self.covariance[np.diag_indices_from(self.covariance)] += self._round_off(self.ends[i], duration)
        if end not in STRUCK:
            return None
        before, speed = self._before(i), self.trace[i, BEFORE]
        error = self._impact_error(i, before, speed)
        self._carry(self._struck(i, before, speed) if end == IMPACT else self._stopped())
        if self.unending[i]:
            self.covariance[np.diag_indices_from(self.covariance)] += self._left_out(speed)
        return error

    def _carry(self, matrix: Array) -> None:
        self.covariance = matrix @ self.covariance @ matrix.T

    def _before(self, i: int) -> Array:
        """The pose (2, n) just before the impact that ends segment i."""
        system, pose = self.system, self.ends[i].copy()
        v = self.trace[i, BEFORE]
        lost = v - system.contact @ pose[1]  # the velocity that the impulse took
        pose[1] += system.contact * lost / (system.contact @ system.contact)
        return np.asarray(pose)

    def _acceleration(self, i: int, pose: Array) -> float:
        phase = self.drive.omega * (self.clocks[i] + self.trace[i, DURATION])
        return float(self.system.contact @ _acceleration(self.system, self.drive, pose, phase))

    def _impact_error(self, i: int, before: Array, speed: float) -> tuple[float, float]:
        n, c = self.system.size, self.system.contact
        late = np.concatenate([-c / speed, np.zeros(n)]) if speed > 0 else np.zeros(2 * n)  # 0: it was there already
        change = np.concatenate([np.zeros(n), c]) + self._acceleration(i, before) * late
        time, velocity = (float(abs(row @ self.covariance @ row)) ** 0.5 for row in (late, change))
        return time, velocity

    def _flown(self, i: int) -> Array:
        flights = self.flights
        blocks = [np.diag(part[i]) for part in (flights.p00, flights.p01, flights.p10, flights.p11)]
        return np.asarray(np.block([blocks[:2], blocks[2:]]))

    def _held(self, duration: float) -> Array:
        from scipy.linalg import expm

        return np.asarray(expm(self.rest * duration)) @ self._stopped()

    def _struck(self, i: int, before: Array, speed: float) -> Array:
        n, c, system = self.system.size, self.system.contact, self.system
        s = (1 + system.restitution) / float(c @ c)
        matrix = np.eye(2 * n)
        matrix[:n, :n] -= s * np.outer(c, c)
        matrix[n:, n:] -= s * np.outer(c, c)
        lean = self._acceleration(i, before) / speed if speed > 0 else np.inf
        matrix[n:, :n] = s * np.outer((2 * system.zeta * system.omega + lean) * c, c)
        return matrix

    def _stopped(self) -> Array:
        """Displacement and velocity of the contact point taken out."""
        c = self.system.contact
        still = np.eye(self.system.size) - np.outer(c, c) / (c @ c)
        return np.asarray(np.kron(np.eye(2), still), dtype=float)

    def _left_out(self, speed: float) -> Array:
        """Variances (2n,) by what an endless accumulation of impacts still does: √2W₀ at most, see ``endless``."""
        square = (self.system.restitution * speed) ** 2 / float(self.system.contact @ self.system.contact)
        softness = np.where(self.system.omega > 0, 1 / np.where(self.system.omega > 0, self.system.omega, 1.0), 0.0)
        return np.concatenate([square * softness**2, np.full(self.system.size, square)])

    def _round_off(self, pose: Array, duration: float) -> Array:
        """Variances (2n,) of what a closed-form evaluation over ``duration`` rounds off of ``pose`` and what is far."""
        rate = np.where(self.system.omega > 0, self.system.omega, max(self.drive.omega, 1e-300))
        turns = EPSILON * (1 + rate * duration * np.exp(-np.minimum(self.system.zeta * rate * duration, 700.0)))
        x = np.abs(pose[0]) + np.abs(pose[1]) / rate + self.far
        v = np.abs(pose[1]) + rate * (np.abs(pose[0]) + self.far)
        return np.asarray(np.concatenate([turns * x, turns * v]) ** 2)


def _constrained(system: ImpactSystem) -> Array:
    """State matrix of the modes while the contact is held: accelerations without their part along the contact row."""
    n, c = system.size, system.contact
    still = np.eye(n) - np.outer(c, c) / (c @ c)
    matrix = np.zeros((2 * n, 2 * n))
    matrix[:n, n:] = np.eye(n)
    matrix[n:, :n] = -still * system.omega**2
    matrix[n:, n:] = -still * (2 * system.zeta * system.omega)
    return matrix


def _far(system: ImpactSystem, drive: Drive, pose: Array) -> Array:
    """Size (n,) of what closed forms take out of the modes and put back: steady response and static displacement.

    A mode without a usable one (free, undamped at resonance, far beyond the motion) carries its force along and takes
    nothing out.
    """
    square, w = system.omega**2, drive.omega
    response = np.hypot(square - w * w, 2 * system.zeta * system.omega * w)
    usable = (response > 1e-3 * w * w) & (square > 0)
    driven = np.abs(system.load * w * w * drive.amplitude) / np.where(usable, response, np.inf)
    static = np.abs(system.static) / np.where(square > 0, square, np.inf)
    size = size_of_motion(system, drive, pose)
    return np.asarray(np.where((driven > FAR_DRIVEN * size) | (static > FAR * size), 0.0, driven + static))


def _acceleration(system: ImpactSystem, drive: Drive, pose: Array, phase: float) -> Array:
    """η'' (n,) of the free system."""
    push = system.load * drive.omega**2 * drive.amplitude * np.sin(phase) + system.static
    return np.asarray(push - 2 * system.zeta * system.omega * pose[1] - system.omega**2 * pose[0])
