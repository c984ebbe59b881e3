"""Entry points: what Python calls."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import entry, kernel
from vibeam.flight.kernels.layout import (
    AT_CLOCK,
    CLOCK,
    COMPLETE,
    CONTACT_LEAST,
    DONE,
    FREE,
    FULL,
    HIGH,
    IMPACTS,
    LEAST,
    MOST,
    PANELS,
    PAUSED,
    PERIOD,
    SEGMENTS,
    UNRESOLVED,
    UNSEEN,
    WATCHED,
    WHAT,
)
from vibeam.flight.kernels.regimes.block_flow import advance_blocks, to_block_coordinates
from vibeam.flight.kernels.regimes.contact_integration import integrated_at
from vibeam.flight.kernels.regimes.drive import set_drive
from vibeam.flight.kernels.regimes.events import advance, at_side, piece_of
from vibeam.flight.kernels.regimes.layout import AT_SIDE, CONTACT, CURVED, FAMILY, RegimeEngine, RegimeWatch
from vibeam.flight.kernels.regimes.steady_point import watch
from vibeam.flight.kernels.steady_point import is_unread, note_strobe

Array = NDArray[np.float64]

WATCHING = 1000  # panels that reading a segment off is as much work as, about


@entry
def move(
    plan: RegimeEngine, omega: float, amplitude: float, pose: Array, status: Array, span: float, settle: int, hold: int,
    limit: int, room: RegimeWatch, counts: NDArray[np.int64],
) -> tuple[int, float]:  # fmt: skip
    """Carry ``pose`` on under one drive: outcome, time done.

    span > 0: every segment of that time goes to ``room.trace``, up to ``limit`` impacts in counts[IMPACTS]. Otherwise a
    point of a sweep, ``settle`` and ``hold`` periods watched, the states a period apart in ``room.strobes``. PAUSED:
    called again with the same arguments it goes on as if it had not been.
    """
    set_drive(plan, omega, amplitude)
    if span > 0.0:
        return advance(plan, pose, status, span, limit, room.trace, room.poses, counts)
    outcome = settled_at(plan, pose, status, settle, limit, room, counts)
    begun, piece = counts[PANELS], piece_of(plan, pose)
    while outcome == COMPLETE and counts[WATCHED] <= hold:
        outcome = watched(plan, pose, status, limit, room, counts)
        begun -= WATCHING * counts[SEGMENTS]
        if outcome == COMPLETE and counts[WATCHED] <= hold and counts[PANELS] - begun >= piece:
            outcome = PAUSED
    if outcome != PAUSED:
        status[CLOCK] = 0.0
    return outcome, 0.0


@kernel
def settled_at(
    plan: RegimeEngine,
    pose: Array,
    status: Array,
    settle: int,
    limit: int,
    room: RegimeWatch,
    counts: NDArray[np.int64],
) -> int:
    """Carry ``pose`` on to the end of the settling, where it is not there yet, and begin to watch."""
    if counts[WATCHED] > 0:
        return COMPLETE
    most = limit * max(settle, 1)
    outcome, _ = advance(plan, pose, status, settle * plan.drive[PERIOD], most, room.nothing, room.poses, counts)
    if outcome != COMPLETE:
        return outcome
    room.result[HIGH], room.result[LEAST], room.result[CONTACT_LEAST] = -np.inf, np.inf, np.inf
    note_strobe(room.strobes, 0, pose)
    counts[WATCHED], counts[MOST], status[UNSEEN] = 1, counts[IMPACTS] + limit, plan.drive[PERIOD]
    return outcome


@kernel
def watched(
    plan: RegimeEngine, pose: Array, status: Array, limit: int, room: RegimeWatch, counts: NDArray[np.int64]
) -> int:
    """Carry ``pose`` on to the end of the period, or of the trace, and read off what is traced."""
    if status[DONE] == 0.0:
        counts[SEGMENTS] = 0
        status[CLOCK] = plan.drive[PERIOD] - status[UNSEEN]
    outcome, done = advance(plan, pose, status, status[UNSEEN], counts[MOST], room.trace, room.poses, counts)
    if outcome == PAUSED:
        return outcome
    watch(plan, room, counts[SEGMENTS])
    if is_unread(room.result):
        return UNRESOLVED
    status[UNSEEN] -= done
    if outcome == FULL:
        return COMPLETE
    turn = counts[WATCHED]
    status[UNSEEN], counts[MOST], counts[WATCHED] = plan.drive[PERIOD], counts[IMPACTS] + limit, turn + 1
    note_strobe(room.strobes, turn, pose)
    return outcome


@entry
def poses_at(
    plan: RegimeEngine, omega: float, amplitude: float, trace: Array, poses: Array, which: NDArray[np.int64],
    after: Array, pose: Array, out: Array,
) -> None:  # fmt: skip
    """Set out[i] (2, n) to the pose a time after[i] into segment which[i]."""
    set_drive(plan, omega, amplitude)
    for i in range(len(which)):
        segment = which[i]
        for k in range(pose.shape[1]):
            pose[0, k], pose[1, k] = poses[segment, 0, k], poses[segment, 1, k]
        clock, what, side = trace[segment, AT_CLOCK], trace[segment, WHAT], int(trace[segment, AT_SIDE])
        if after[i] > 0.0 and what == CONTACT and plan.law[FAMILY] == CURVED:
            integrated_at(plan, pose, side, clock, after[i])
        elif after[i] > 0.0:
            regime = plan.free
            if what != FREE:
                regime = at_side(plan, side)
            to_block_coordinates(regime, plan.drive, pose, clock)
            advance_blocks(regime, plan.drive, pose, clock, after[i])
        for k in range(pose.shape[1]):
            out[i, 0, k], out[i, 1, k] = pose[0, k], pose[1, k]
