"""Errors of a motion: how far round-off has grown, and what is left out where R → 1 is taken as rest.

Disturbances of the state are carried along exactly to first order by the motion's tangent maps (``tangent``), and what
is round-off of the numbers at hand is added at every event. The covariance P of the error of (η, η') so obeys
P⁺ = D P Dᵀ + Q with D the tangent map of the segment and Q the round-off of its end. With contact velocity v and
acceleration a before it, the impact's own errors follow from

    δt = −(c·δη)/v,     δv = c·δη' + a δt.

In chaos P grows by itself: where it reaches the size of the motion, the impacts that follow are one possible motion of
the system, but not the one that started there.

Impacts that lose next to nothing have a bound by energy. Pressed on with acceleration a, a flight takes 2v/a; damping
takes a share of the velocity that falls with it: for one mode vₙ₊₁ = vₙ − κvₙ², κ = 4σ/3a, from ∫ 2σ d'² dt =
2σ · 2v³/3a over the flight. So vₙ → 1/κn, flights of 2/(aκn), and their sum (2/aκ) ln n has no limit: with R = 1 the
accumulation is endless, and impacts grow as e^{2σt/3} in number.

So it is left at a velocity u, not completed, and the contact held from there. Let z be what the true motion, impacts
and all, has beyond the held one, E = ½ Σ (z_k'² + ω_k² z_k²), g ≥ 0 the gap, f > 0 the force by which the contact is
held. An impact with R ≤ 1 does no positive work on z, damping neither, and −f does −∫ f dg = −[fg] + ∫ g df. Hence

    W = E + f g:     dW/dt ≤ g df/dt ≤ W (d ln f/dt)⁺,     W ≤ W₀ exp ∫ (d ln f)⁺,     W₀ = ½ u²/S

for any number of modes, damping, coupled or not, and drive, as long as f presses: the gap is W/f at most, no mode's
velocity nor ω times its displacement off by more than √2W.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from vibeam.flight.disturbance.maps import maps_of
from vibeam.flight.equilibrium import size_of_motion
from vibeam.flight.event_driven import Segments
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.layout import BRISK, FAR, FAR_DRIVEN
from vibeam.flight.linear.regimes import damper_of
from vibeam.flight.readout import STRUCK
from vibeam.observe.motion import Path
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State
from vibeam_models.arrays import Array, Flags

PLACES = 512  # at which the force is read off over a rest
EPSILON = float(np.finfo(float).eps)
LOST = 0.1  # error of an impact's velocity, as a share of what is usual, from which on it says nothing


def endless(trace: Array) -> Flags:
    """True for the segments (m,) that end with an endless accumulation, taken as rest."""
    return np.asarray((trace[:, layout.END] == layout.CHATTER) & np.isinf(trace[:, layout.REMAINDER]))


def left_out_of(path: ExactMotion) -> Array:
    """(m, 3): when each endless accumulation was taken as rest, s; W₀; most that W is until that rest's end, J."""
    trace = path.segments.trace
    which = np.flatnonzero(endless(trace))
    energy = path.system.contact_law.rebound(trace[which, layout.BEFORE]) ** 2 / (2 * path.system.mobility)
    rises = np.array([_rise(path, int(i) + 1) for i in which])
    return np.stack(
        [trace[which, layout.START] + trace[which, layout.DURATION], energy, energy * rises], axis=1
    ).reshape(-1, 3)


def _rise(path: ExactMotion, rest: int) -> float:
    """exp ∫ (d ln f)⁺ over a rest, by the force at ``PLACES``."""
    trace = path.segments.trace
    if rest >= len(trace) or trace[rest, layout.WHAT] != layout.RESTING:
        return 1.0
    times = np.linspace(trace[rest, layout.START], trace[rest, layout.START] + trace[rest, layout.DURATION], PLACES)
    force = np.maximum(_force(path, np.clip(times, path.t_start, path.t_end)), 0.0)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        growth = np.where(force[1:] > force[:-1], force[1:] / force[:-1], 1.0)
        return float(np.prod(growth))


def _force(path: ExactMotion, times: Array) -> Array:
    """c·(load Ω²B sin φ + static − Dη' − ω²η)/S at ``times``: what holds the contact, either stop."""
    system, drive = path.system, path.drive
    poses = path.modes_at(times)
    place = poses[:, 0] @ system.contact
    far = np.inf if system.second_gap is None else np.abs(place + system.second_gap)
    push = np.outer(np.sin(drive.omega * times), system.load) * drive.omega**2 * drive.amplitude + system.static
    pull = push - poses[:, 1] @ damper_of(system) - system.omega**2 * poses[:, 0]
    side = np.where(np.abs(place - system.gap) <= far, 1.0, -1.0)
    return np.asarray(side * (pull @ system.contact) / system.mobility)


class ExactMotion(Path, Protocol):
    """A motion whose flights and rests, and whose last state, are known; a ``Trajectory`` is one."""

    @property
    def segments(self) -> Segments:
        """Flights and rests, one after another."""

    @property
    def state(self) -> State:
        """State at the end."""


@dataclass(frozen=True)
class ImpactErrors:
    """Estimated errors (one standard deviation) of the impacts of a motion, shapes (m,)."""

    time: Array  #: of the impact times, s
    velocity: Array  #: of the impact velocities, m/s
    amplification: Array  #: how many times larger a velocity's error is than the round-off of that velocity
    meaningful: int  #: impacts before the first whose velocity is known to no better than a tenth of what is usual


def errors_of(path: ExactMotion, start: Array | None = None) -> ImpactErrors:
    """The estimated errors of the impacts of ``path``, from round-off alone or from a disturbed start.

    ``start``: covariance (2n, 2n) of the error of the first (η, η'); round-off of its values where None. ValueError for
    a system with another law or more than plain modes.
    """
    if path.system.further is None:
        path.system.require_plain("the error estimate")
    walk = _CarriedCovariance(path, start)
    found = np.array([error for error in walk.impacts() if error is not None]).reshape(-1, 2)
    speeds = path.impact_velocities
    usual = float(np.sqrt(np.mean(speeds**2))) if len(speeds) else 0.0
    lost = np.flatnonzero(~(found[:, 1] <= LOST * usual))
    with np.errstate(divide="ignore", invalid="ignore"):
        grown = np.where(speeds > 0, found[:, 1] / (EPSILON * speeds), np.inf)
    return ImpactErrors(found[:, 0], found[:, 1], grown, int(lost[0]) if len(lost) else len(speeds))


class _CarriedCovariance:
    """The covariance carried along a trajectory, segment by segment."""

    def __init__(self, path: ExactMotion, start: Array | None) -> None:
        self.system, self.drive = path.system, path.drive
        self.maps = maps_of(path.system, path.drive, path.segments, path.state)
        self.trace, self.unending = self.maps.trace, endless(self.maps.trace)
        self.far = _far(self.system, path.drive, self.maps.poses[0])
        self.covariance = np.diag(self._round_off(self.maps.poses[0], 0.0)) if start is None else np.array(start)

    def impacts(self) -> list[tuple[float, float] | None]:
        """(time, velocity) error at the end of every segment that an impact ended, None for the others."""
        with np.errstate(over="ignore", invalid="ignore"):
            return [self._segment(i) for i in range(len(self.trace))]

    def _segment(self, i: int) -> tuple[float, float] | None:
        self._carry(self.maps.flow(i))
        if i == 0 or self.trace[i, layout.DURATION] > 0:
            self._add(self._round_off(self.maps.ends[i], self.trace[i, layout.DURATION]))
            self._before = self.covariance
        if int(self.trace[i, layout.END]) not in STRUCK:
            return None
        time, velocity = (float(abs(row @ self._before @ row)) ** 0.5 for row in self.maps.readings(i))
        jump = self.maps.jump(i)
        if jump is not None:
            self._carry(jump)
        if self.unending[i]:
            self._add(self._left_out(self.trace[i, layout.BEFORE]))
        return time, velocity

    def _carry(self, matrix: Array) -> None:
        self.covariance = matrix @ self.covariance @ matrix.T

    def _add(self, variances: Array) -> None:
        self.covariance[np.diag_indices_from(self.covariance)] += variances

    def _left_out(self, speed: float) -> Array:
        """Variances (2n,) by what an endless accumulation of impacts still does: √2W₀ at most, see ``endless``."""
        square = (self.system.restitution * speed) ** 2 / self.system.mobility
        softness = np.where(self.system.omega > 0, 1 / np.where(self.system.omega > 0, self.system.omega, 1.0), 0.0)
        return np.concatenate([square * softness**2, np.full(self.system.size, square)])

    def _round_off(self, pose: Array, duration: float) -> Array:
        """Variances (2n,) of what a closed-form evaluation over ``duration`` rounds off of ``pose`` and what is far."""
        rate = np.where(self.system.omega > 0, self.system.omega, max(self.drive.omega, 1e-300))
        turns = EPSILON * (1 + rate * duration * np.exp(-np.minimum(self.system.zeta * rate * duration, 700.0)))
        x = np.abs(pose[0]) + np.abs(pose[1]) / rate + self.far
        v = np.abs(pose[1]) + rate * (np.abs(pose[0]) + self.far)
        return np.asarray(np.concatenate([turns * x, turns * v]) ** 2)


def responses(system: ImpactSystem, drive: Drive) -> tuple[Array, Array]:
    """Sizes (n,) of the steady response to the drive and of the static displacement; 0 where a mode has no usable one.

    Free modes and those driven at an undamped resonance have none, and carry their force along.
    """
    square, w = system.omega**2, drive.omega
    response = np.hypot(square - w * w, 2 * system.zeta * system.omega * w)
    usable = (response > 1e-3 * w * w) & (square > 0)
    driven = np.abs(system.load * w * w * drive.amplitude) / np.where(usable, response, np.inf)
    return driven, np.abs(system.static) / np.where(square > 0, square, np.inf)


def _far(system: ImpactSystem, drive: Drive, pose: Array) -> Array:
    """Size (n,) of what closed forms take out of the modes and put back: steady response and static displacement.

    A mode whose response is far beyond the motion carries its force along and takes nothing out.
    """
    w, (driven, static) = drive.omega, responses(system, drive)
    size, damping = size_of_motion(system, drive, pose), 2 * system.zeta * system.omega
    offset = np.where(damping <= BRISK * np.maximum(system.omega, w), FAR, FAR_DRIVEN)
    slow = np.maximum(system.omega, damping) <= BRISK * w
    carried = (static > offset * size) | (slow & (driven > FAR_DRIVEN * size))
    return np.asarray(np.where(carried, 0.0, driven + static))
