"""A certificate that no impact was missed: every flight covered by intervals, each with its claim.

Written down are the flights as they started, to the bit: modal displacements and velocities, the drive's time, how the
flight began (off the stop, or on it with a root of order 1 to 3), and pieces (flight, from, length, claim). A piece
that is ``OPEN`` claims that the gap is positive on (from, from + length]; one that ``CLOSES`` that it is positive until
the flight's end and passes zero there, once. What the claims say can be checked without the solver, from the equations
of ``ImpactSystem`` alone: ``tests/independent/check_certificate.py`` does so in interval arithmetic.

Rests, and accumulations that are completed by their limit, are no flights: they are listed with what they span.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.entries import cover
from vibeam.flight.kernels.layout import AT_CLOCK, BEFORE, DURATION, END, IMPACT, RELEASE, RESTING, WHAT
from vibeam.flight.kernels.pieces import CLAIM, CLOSES, COLUMNS, OPEN, UNPROVED, Flights

if TYPE_CHECKING:
    from vibeam.flight.event_driven import Segments
    from vibeam.flight.linear.packing import PackedSystem
    from vibeam.system.impact_system import Drive, ImpactSystem


Array = NDArray[np.float64]

PIECES_A_FLIGHT = 24

ON_STOP = 64 * float(np.finfo(float).eps)


__all__ = ["CLOSES", "OPEN", "UNPROVED", "Certificate", "certificate_of"]


@dataclass(frozen=True)
class Certificate:
    """Flights and the pieces that cover them; SI units, times within a flight count from its start."""

    system: ImpactSystem
    drive: Drive
    starts: Array  #: (segments, 2, n) modal displacements and velocities
    clocks: Array  #: (segments,) drive time at the start, within one period
    durations: Array  #: (segments,)
    orders: Array  #: (segments,) order of the gap's root at the start, 0 where it starts open
    resting: NDArray[np.bool_]  #: (segments,) rests, which no piece covers
    pieces: Array  #: (m, 4): segment, from, length, claim

    @property
    def complete(self) -> bool:
        """Whether every piece claims something that the bounds prove."""
        return not np.any(self.pieces[:, CLAIM] == UNPROVED)

    @property
    def uncovered(self) -> NDArray[np.int64]:
        """The segments that are rests."""
        return np.flatnonzero(self.resting)


def certificate_of(packed: PackedSystem, drive: Drive, segments: Segments) -> Certificate:
    """The certificate of a motion that was flown."""
    trace = segments.trace
    orders, rises = _beginnings(packed.system, drive, segments)
    desk = packed.desk_for(segments.size)
    flights = Flights(trace, packed.inward(segments.poses), orders, rises)
    found, room, first = [], np.zeros((PIECES_A_FLIGHT * max(len(trace), 8), COLUMNS)), 0
    while first < len(trace):
        count, reached = cover(desk, drive.omega, drive.amplitude, flights, first, room)
        found.append(room[:count].copy())
        if reached == first:
            room = np.zeros((2 * len(room), COLUMNS))
        first = reached
    return Certificate(
        packed.system, drive, segments.poses, trace[:, AT_CLOCK], trace[:, DURATION], orders,
        trace[:, WHAT] == RESTING, np.concatenate(found),
    )  # fmt: skip


def _beginnings(system: ImpactSystem, drive: Drive, segments: Segments) -> tuple[Array, Array]:
    """Order of the root with which every segment starts, and the derivative of the gap of that order."""
    trace, poses = segments.trace, segments.poses
    ended = np.concatenate([[float(RELEASE)], trace[:-1, END]]) if len(trace) else trace[:, END]
    after = -poses[:, 1] @ system.contact
    struck = np.flatnonzero(ended == IMPACT)
    after[struck] = system.restitution * trace[struck - 1, BEFORE]
    starts_on_stop = (trace[:, WHAT] != RESTING) & _on_stop(system, poses)
    thrown = starts_on_stop & (after > 0) & (ended != RELEASE)
    thrown[:1] = starts_on_stop[:1] & (after[:1] > 0)
    orders, rises = np.where(thrown, 1.0, 0.0), np.where(thrown, after, 0.0)
    for i in np.flatnonzero(starts_on_stop & ~thrown):
        at_root = bool(i > 0 and ended[i] == RELEASE)
        orders[i], rises[i] = _lift(system, drive, poses[i], trace[i, AT_CLOCK], at_root)
    return orders, rises


def _on_stop(system: ImpactSystem, poses: Array) -> NDArray[np.bool_]:
    """Whether the contact is on the stop, as near as round-off can tell."""
    parts = abs(system.gap) + np.abs(poses[:, 0]) @ np.abs(system.contact)
    return np.asarray(np.abs(system.gap - poses[:, 0] @ system.contact) <= ON_STOP * parts)


def _lift(system: ImpactSystem, drive: Drive, pose: Array, clock: float, at_root: bool) -> tuple[int, float]:
    """A start without contact velocity: drawn away by its acceleration, or by its jerk where the force vanishes."""
    damp, spring, w = 2 * system.zeta * system.omega, system.omega**2, drive.omega
    push = system.load * w * w * drive.amplitude
    acceleration = push * np.sin(w * clock) + system.static - damp * pose[1] - spring * pose[0]
    jerk = push * w * np.cos(w * clock) - damp * acceleration - spring * pose[1]
    second, third = float(system.contact @ acceleration), float(system.contact @ jerk)
    if third < 0 and (at_root or second >= 0):
        return 3, -third
    return 2, -second
