"""Signals whose sign a trajectory rests on: in flight the gaps, on a stop its force, and how each starts and ends.

In flight every gap stays open until one closes at an impact. Held by a hard stop, or pushed by a linear one, the force
stays positive until it vanishes at the release (so penetration does too: where d = 0, F = b d' > 0 and d grows). A
linear stop with damping lets go while it is still penetrated: then −d' b − k d and d stay positive, until the contact
is pushed again or is out.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vibeam.flight.disturbance.derivatives import FREE as FLYING
from vibeam.flight.disturbance.derivatives import HELD, PUSHED, RegimeDerivatives, StopRow, Sum, stop_of
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.readout import sides, struck
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam_models.arrays import Array, Flags, Index

ROUND_OFF = 64 * float(np.finfo(float).eps)  # share of the parts of a sum below which it is none


class WatchedMotion(NamedTuple):
    """The segments of a motion, what each is in, and the stop it starts at or (a flight) ends at."""

    system: ImpactSystem
    drive: Drive
    trace: Array  # (m, TRACE_COLUMNS)
    poses: Array  # (m, 2, n)
    kinds: Array  # (m,) FREE, RESTING, CONTACT or INSIDE
    sides: Index  # (m,)

    @property
    def yields(self) -> bool:
        """True where the stops yield."""
        return self.system.contact_law.yields

    @property
    def lasting(self) -> Flags:
        """True for the segments that take time."""
        return np.asarray(self.trace[:, layout.DURATION] > 0)


def motion_of(system: ImpactSystem, drive: Drive, trace: Array, poses: Array) -> WatchedMotion:
    """The segments of a trace with what each is in."""
    kinds, spring = trace[:, layout.WHAT].copy(), system.contact_law.spring
    if spring is not None and spring.damping > 0:
        let_go = (trace[:-1, layout.WHAT] == regime_layout.CONTACT) & (trace[:-1, layout.END] == layout.RELEASE)
        kinds[1:][let_go & (trace[1:, layout.WHAT] == layout.FREE)] = regime_layout.INSIDE
    return WatchedMotion(system, drive, trace, poses, kinds, sides(trace))


def watch_list(motion: WatchedMotion) -> Array:
    """Tasks (k, 5) for ``kernels.entry.cover``, in the order of the segments."""
    every = [np.zeros((0, layout.TASK_COLUMNS))]
    for side in range(1 if motion.system.second_gap is None else 2):
        every += [_gaps(motion, side), _forces(motion, side, layout.RESTING)]
        if motion.system.contact_law.spring:
            every += [_forces(motion, side, regime_layout.CONTACT), *_retreats(motion, side)]
    found = [rows for rows in every if len(rows)]
    if len(found) < 2:
        return found[0] if found else every[0]
    tasks = np.concatenate(found)
    return np.ascontiguousarray(tasks[np.lexsort((tasks[:, 1], tasks[:, 0]))])


def _rows(which: Index, signal: int, starts: tuple[Array, Array], closing: Flags) -> Array:
    rows = np.empty((len(which), layout.TASK_COLUMNS))
    rows[:, 0], rows[:, 1], rows[:, 2], rows[:, 3], rows[:, 4] = which, signal, *starts, closing
    return rows


def _gaps(motion: WatchedMotion, side: int) -> Array:
    """The gap to one stop over every flight."""
    which = np.flatnonzero(motion.lasting & (motion.kinds == layout.FREE))
    closing = struck(motion.trace[which]) & (motion.sides[which] == side)
    return _rows(which, layout.GAP_SIGNAL + side, _openings(motion, side, which), closing)


def _forces(motion: WatchedMotion, side: int, kind: float) -> Array:
    """The force of one stop over every rest or push; it vanishes at a release."""
    which = np.flatnonzero(motion.lasting & (motion.kinds == kind) & (motion.sides == side))
    if not len(which):
        return np.zeros((0, layout.TASK_COLUMNS))
    spring, ended = motion.system.contact_law.spring, _ended_before(motion)[which]
    undamped = spring is not None and spring.damping == 0
    vanished = (ended == regime_layout.PASS) | ((ended == layout.IMPACT) & undamped)
    found = _derivatives(motion, HELD if kind == layout.RESTING else PUSHED, side, which).force(side)
    starts = _leading(found, 1.0, vanished & (kind == regime_layout.CONTACT))
    return _rows(which, layout.FORCE_SIGNAL + side, starts, motion.trace[which, layout.END] == layout.RELEASE)


def _retreats(motion: WatchedMotion, side: int) -> list[Array]:
    """Penetration, and what the force would pull, while a stop with damping is penetrated and does not push."""
    which = np.flatnonzero(motion.lasting & (motion.kinds == regime_layout.INSIDE) & (motion.sides == side))
    if not len(which):
        return []
    passed = motion.trace[which, layout.END] == regime_layout.PASS
    pushed = passed & (np.append(motion.kinds, layout.FREE)[which + 1] == regime_layout.CONTACT)
    found = _derivatives(motion, FLYING, side, which)
    let_go = motion.lasting[which - 1]  # else it never pushed: a start in its range, already on the way out
    deep, pull = _leading(found.gap(side), -1.0), _leading(found.force(side), -1.0, let_go)
    return [
        _rows(which, layout.NEGATIVE + layout.GAP_SIGNAL + side, deep, passed & ~pushed),
        _rows(which, layout.NEGATIVE + layout.FORCE_SIGNAL + side, pull, pushed),
    ]


def _ended_before(motion: WatchedMotion) -> Array:
    """End of the segment before each; the first has none: as after a release without force."""
    return np.concatenate([[float(layout.RELEASE)], motion.trace[:-1, layout.END]])


def _derivatives(motion: WatchedMotion, regime: int, side: int, which: Index) -> RegimeDerivatives:
    poses, clocks = motion.poses[which], motion.trace[which, layout.AT_CLOCK]
    return RegimeDerivatives(motion.system, motion.drive, regime, side, poses, clocks)


def _leading(found: list[Sum], sign: float, vanished: Flags | None = None) -> tuple[Array, Array]:
    """Order and size of the first derivative beyond round-off, where it is positive; (0, 0) elsewhere.

    ``vanished``: where the value is known to be 0, whatever round-off makes of it.
    """
    order, rise = np.zeros(len(found[0].value)), np.zeros(len(found[0].value))
    open_yet = np.ones(len(order), dtype=bool)
    for j, (value, size) in enumerate(found):
        seen = open_yet & (np.abs(value) > ROUND_OFF * size)
        if j == 0 and vanished is not None:
            seen &= ~vanished
        rises = seen & (sign * value > 0) & (j > 0)
        order[rises], rise[rises] = j, np.abs(value[rises])
        open_yet &= ~seen
    return order, rise


def _openings(motion: WatchedMotion, side: int, which: Index) -> tuple[Array, Array]:
    """Order of the root with which the gap of a flight starts, and the derivative of that order; 0: it starts open."""
    trace, system, stop = motion.trace, motion.system, stop_of(motion.system, side)
    ended, before = _ended_before(motion)[which], np.maximum(which - 1, 0)
    left = (which > 0) & (motion.sides[before] == side) & (motion.kinds[before] != layout.FREE)
    hit = ~np.bool_(motion.yields) & (ended == layout.IMPACT) & (motion.sides[before] == side)
    after = -motion.poses[which, 1] @ stop.row
    thrown = after > (ROUND_OFF * (np.abs(motion.poses[which, 1]) @ np.abs(stop.row)) if motion.yields else 0)
    after[hit] = system.contact_law.rebound(trace[before[hit], layout.BEFORE])
    thrown[hit] = after[hit] > 0
    known = left | _on_stop(stop, motion.poses[which])
    thrown &= known & (motion.yields | (ended != layout.RELEASE) | (which == 0))
    order, rise = np.where(thrown, 1.0, 0.0), np.where(thrown, after, 0.0)
    drawn = np.flatnonzero(known & ~thrown)
    if len(drawn):
        at_root = (
            (which[drawn] > 0) & (ended[drawn] == layout.RELEASE) & (motion.kinds[before[drawn]] == layout.RESTING)
        )
        order[drawn], rise[drawn] = _lift(_derivatives(motion, FLYING, side, which[drawn]).gap(side), at_root)
    return order, rise


def _on_stop(stop: StopRow, poses: Array) -> Flags:
    """True where the contact is on the stop, as near as round-off can tell."""
    if not np.isfinite(stop.gap):
        return np.zeros(len(poses), dtype=bool)
    parts = abs(stop.gap) + np.abs(poses[:, 0]) @ np.abs(stop.row)
    return np.asarray(np.abs(stop.gap - poses[:, 0] @ stop.row) <= ROUND_OFF * parts)


def _lift(gap: list[Sum], at_root: Flags) -> tuple[Array, Array]:
    """A start without velocity: drawn away by the acceleration, or by the jerk where the force vanishes; or by none."""
    second, third = (np.where(np.abs(value) > ROUND_OFF * size, value, 0.0) for value, size in gap[2:])
    late = (third > 0) & (at_root | (second <= 0))
    order = np.where(late, 3.0, np.where(second > 0, 2.0, 0.0))
    return order, np.where(late, third, np.maximum(second, 0.0))
