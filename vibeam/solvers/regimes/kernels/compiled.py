"""Entry points: what Python calls."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.solvers.kernels.layout import (
    AT_CLOCK,
    CLOCK,
    COMPLETE,
    CONTACT_LEAST,
    FREE,
    FULL,
    HIGH,
    IMPACTS,
    LEAST,
    PERIOD,
    SEGMENTS,
    WHAT,
)
from vibeam.solvers.kernels.steady import note_strobe
from vibeam.solvers.regimes.kernels.drive import set_drive
from vibeam.solvers.regimes.kernels.jit import entry
from vibeam.solvers.regimes.kernels.layout import AT_SIDE, CONTACT, CURVED, FAMILY, Plan, Room
from vibeam.solvers.regimes.kernels.motion import advance, at_side
from vibeam.solvers.regimes.kernels.regime import enter, proceed
from vibeam.solvers.regimes.kernels.squeeze import squeezed
from vibeam.solvers.regimes.kernels.watch import watch

Array = NDArray[np.float64]


@entry
def move(
    plan: Plan, omega: float, amplitude: float, pose: Array, status: Array, span: float, settle: int, hold: int,
    limit: int, room: Room, counts: NDArray[np.int64],
) -> tuple[int, float]:  # fmt: skip
    """Carry ``pose`` on under one drive: outcome, time done.

    span > 0: every segment of that time goes to ``room.trace``. Otherwise a point of a sweep, ``settle`` and ``hold``
    periods watched, the states a period apart in ``room.strobes``.
    """
    set_drive(plan, omega, amplitude)
    if span > 0.0:
        return advance(plan, pose, status, span, limit, room.trace, room.poses, counts)
    period = plan.drive[PERIOD]
    outcome, _ = advance(plan, pose, status, settle * period, limit * max(settle, 1), room.nothing, room.poses, counts)
    room.result[HIGH], room.result[LEAST], room.result[CONTACT_LEAST] = -np.inf, np.inf, np.inf
    note_strobe(room.strobes, 0, pose)
    turn, left, most = 0, period, counts[IMPACTS] + limit
    while outcome == COMPLETE and turn < hold:
        counts[SEGMENTS] = 0
        status[CLOCK] = period - left
        outcome, done = advance(plan, pose, status, left, most - counts[IMPACTS], room.trace, room.poses, counts)
        watch(plan, room, counts[SEGMENTS])
        left -= done
        if outcome == FULL:
            outcome = COMPLETE
        else:
            turn, left, most = turn + 1, period, counts[IMPACTS] + limit
            note_strobe(room.strobes, turn, pose)
    status[CLOCK] = 0.0
    return outcome, 0.0


@entry
def poses_at(
    plan: Plan, omega: float, amplitude: float, trace: Array, poses: Array, which: NDArray[np.int64], after: Array,
    pose: Array, out: Array,
) -> None:  # fmt: skip
    """Set out[i] (2, n) to the pose a time after[i] into segment which[i]."""
    set_drive(plan, omega, amplitude)
    for i in range(len(which)):
        segment = which[i]
        for k in range(pose.shape[1]):
            pose[0, k], pose[1, k] = poses[segment, 0, k], poses[segment, 1, k]
        clock, what, side = trace[segment, AT_CLOCK], trace[segment, WHAT], int(trace[segment, AT_SIDE])
        if after[i] > 0.0 and what == CONTACT and plan.law[FAMILY] == CURVED:
            squeezed(plan, pose, side, clock, after[i])
        elif after[i] > 0.0:
            regime = plan.free
            if what != FREE:
                regime = at_side(plan, side)
            enter(regime, plan.drive, pose, clock)
            proceed(regime, plan.drive, pose, clock, after[i])
        for k in range(pose.shape[1]):
            out[i, 0, k], out[i, 1, k] = pose[0, k], pose[1, k]
