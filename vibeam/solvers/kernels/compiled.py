"""Entry points: what Python calls. Each is one compiled function with one signature."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.solvers.kernels.desk import Desk, Room
from vibeam.solvers.kernels.drive import phase, set_drive
from vibeam.solvers.kernels.flight import begin_flight, land
from vibeam.solvers.kernels.jit import entry
from vibeam.solvers.kernels.layout import (
    AT_CLOCK,
    CLOCK,
    COMPLETE,
    FULL,
    IMPACTS,
    PERIOD,
    RESTING,
    SEGMENTS,
    WHAT,
)
from vibeam.solvers.kernels.motion import advance
from vibeam.solvers.kernels.rest import stay
from vibeam.solvers.kernels.steady import (
    is_same,
    mark,
    note_impacts,
    note_strobe,
    repeat,
    repetition,
    share_out,
    start_watching,
    watch,
)

Array = NDArray[np.float64]
SETTLED_AT_ONCE = 32  # periods: then the phase is set anew, so that a long settling does not round it off


@entry
def move(
    desk: Desk, omega: float, amplitude: float, pose: Array, status: Array, span: float, settle: int, hold: int,
    limit: int, room: Room, counts: NDArray[np.int64], longest: int,
) -> tuple[int, float]:  # fmt: skip
    """Carry ``pose`` on under one drive; one function for both uses, so that the engine is compiled once.

    span > 0: every segment of that time goes to ``room.trace``: outcome, time done. Otherwise a point of a sweep,
    ``settle`` and ``hold`` periods watched: outcome, period (0 where the motion does not repeat).
    """
    set_drive(desk, omega, amplitude)
    if span > 0.0:
        return advance(desk, pose, status, span, limit, room.trace, room.poses, counts)
    outcome, settled = COMPLETE, 0
    while outcome == COMPLETE and settled < settle:
        turns = min(SETTLED_AT_ONCE, settle - settled)
        outcome, _ = advance(
            desk, pose, status, turns * desk.drive[PERIOD], limit * turns, room.nothing, room.poses, counts
        )
        status[CLOCK] = 0.0
        settled += turns
    start_watching(room, pose)
    turn, left, known = 0, desk.drive[PERIOD], False
    most = counts[IMPACTS] + limit
    mark(room)
    while outcome == COMPLETE and turn < hold:
        counts[SEGMENTS] = 0
        status[CLOCK] = desk.drive[PERIOD] - left
        outcome, done = advance(desk, pose, status, left, most - counts[IMPACTS], room.trace, room.poses, counts)
        if known:
            note_impacts(room, counts[SEGMENTS])
        else:
            watch(desk, room, counts[SEGMENTS])
        left -= done
        if outcome == FULL:
            outcome = COMPLETE
            continue
        turn, left, most = turn + 1, desk.drive[PERIOD], counts[IMPACTS] + limit
        note_strobe(room.strobes, turn, pose)
        if known:
            repeat(room)
        elif is_same(desk, room.strobes, turn):
            share_out(room)
            known = True
        else:
            mark(room)
    status[CLOCK] = 0.0
    if outcome != COMPLETE:
        return outcome, 0.0
    return outcome, float(repetition(desk.pairs, desk.drive, room.strobes, hold, longest))


@entry
def poses_at(
    desk: Desk, omega: float, amplitude: float, trace: Array, poses: Array, which: NDArray[np.int64], after: Array,
    pose: Array, status: Array, out: Array,
) -> None:  # fmt: skip
    """Set out[i] (2, n) to the pose a time after[i] into segment which[i]."""
    set_drive(desk, omega, amplitude)
    for i in range(len(which)):
        segment = which[i]
        for k in range(pose.shape[1]):
            pose[0, k], pose[1, k] = poses[segment, 0, k], poses[segment, 1, k]
        clock = trace[segment, AT_CLOCK]
        if after[i] == 0.0:
            pass
        elif trace[segment, WHAT] == RESTING:
            stay(desk, pose, clock, after[i])
        else:
            status[CLOCK] = clock
            cosine, sine = phase(desk.drive, clock)
            begin_flight(desk.pairs, desk.signal, desk.attached, desk.modes, desk.drive, pose, cosine, sine)
            land(desk.pairs, desk.signal, desk.attached, desk.modes, desk.drive, pose, status, after[i], False)
        for k in range(pose.shape[1]):
            out[i, 0, k], out[i, 1, k] = pose[0, k], pose[1, k]
