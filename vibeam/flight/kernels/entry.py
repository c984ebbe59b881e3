"""Entry points: what Python calls. Each is one compiled function with one signature."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.block_flow import advance_at_rest
from vibeam.flight.kernels.compiler import entry, kernel
from vibeam.flight.kernels.drive import phase, set_drive
from vibeam.flight.kernels.events import advance, piece_of, work_of
from vibeam.flight.kernels.layout import (
    AT_CLOCK,
    CLOCK,
    COMPLETE,
    DONE,
    FULL,
    IMPACTS,
    KNOWN,
    MOST,
    PAUSED,
    PERIOD,
    RESTING,
    SEGMENTS,
    SETTLED,
    UNRESOLVED,
    UNSEEN,
    WATCHED,
    WHAT,
    Engine,
    Watch,
)
from vibeam.flight.kernels.modal_flow import begin_flight, end_flight
from vibeam.flight.kernels.steady_point import (
    begin_period,
    is_same,
    is_unread,
    note_impacts,
    note_period,
    note_strobe,
    repeat_period,
    repetition,
    start_watching,
    watch,
)

Array = NDArray[np.float64]

SETTLED_AT_ONCE = 32  # periods: then the phase is set anew, so that a long settling does not round it off

WATCHING = 64  # panels that reading a segment off is as much work as, about


@entry
def move(
    desk: Engine, omega: float, amplitude: float, pose: Array, status: Array, span: float, settle: int, hold: int,
    limit: int, room: Watch, counts: NDArray[np.int64], longest: int,
) -> tuple[int, float]:  # fmt: skip
    """Carry ``pose`` on under one drive; one function for both uses, so that the engine is compiled once.

    span > 0: every segment of that time goes to ``room.trace``: outcome, time done; at most ``limit`` impacts in
    counts[IMPACTS]. Otherwise a point of a sweep, ``settle`` and ``hold`` periods watched: outcome, period (0 where the
    motion does not repeat). PAUSED: called again with the same arguments it goes on as if it had not been.
    """
    set_drive(desk, omega, amplitude)
    if span > 0.0:
        return advance(desk, pose, status, span, limit, room.trace, room.poses, counts)
    begun, piece = work_of(counts), piece_of(pose)
    outcome = settled_at(desk, pose, status, settle, limit, room, counts)
    while outcome == COMPLETE and counts[WATCHED] <= hold:
        outcome = watched(desk, pose, status, limit, room, counts)
        begun -= WATCHING * counts[SEGMENTS]
        if outcome == COMPLETE and counts[WATCHED] <= hold and work_of(counts) - begun >= piece:
            outcome = PAUSED
    if outcome == PAUSED:
        return PAUSED, 0.0
    status[CLOCK] = 0.0
    if outcome != COMPLETE:
        return outcome, 0.0
    return outcome, float(repetition(desk.pairs, desk.drive, room.strobes, hold, longest))


@kernel
def settled_at(
    desk: Engine, pose: Array, status: Array, settle: int, limit: int, room: Watch, counts: NDArray[np.int64]
) -> int:
    """Carry ``pose`` on to the end of the settling, where it is not there yet, and begin to watch."""
    begun, piece = work_of(counts), piece_of(pose)
    while counts[SETTLED] < settle:
        turns = min(SETTLED_AT_ONCE, settle - counts[SETTLED])
        if counts[MOST] == 0:
            counts[MOST] = counts[IMPACTS] + limit * turns
        outcome, _ = advance(
            desk, pose, status, turns * desk.drive[PERIOD], counts[MOST], room.nothing, room.poses, counts
        )
        if outcome != COMPLETE:
            return outcome
        status[CLOCK], counts[MOST] = 0.0, 0
        counts[SETTLED] += turns
        begun -= 1
        if work_of(counts) - begun >= piece:
            return PAUSED
    if counts[WATCHED] == 0:
        start_watching(room, pose)
        begin_period(room)
        counts[WATCHED], counts[MOST], status[UNSEEN] = 1, counts[IMPACTS] + limit, desk.drive[PERIOD]
    return COMPLETE


@kernel
def watched(desk: Engine, pose: Array, status: Array, limit: int, room: Watch, counts: NDArray[np.int64]) -> int:
    """Carry ``pose`` on to the end of the period, or of the trace, and read off what is traced."""
    if status[DONE] == 0.0:
        counts[SEGMENTS] = 0
        status[CLOCK] = desk.drive[PERIOD] - status[UNSEEN]
    outcome, done = advance(desk, pose, status, status[UNSEEN], counts[MOST], room.trace, room.poses, counts)
    if outcome == PAUSED:
        return outcome
    if counts[KNOWN] > 0:
        note_impacts(room, counts[SEGMENTS])
    else:
        watch(desk, room, counts[SEGMENTS])
        if is_unread(room.result):
            return UNRESOLVED
    status[UNSEEN] -= done
    if outcome == FULL:
        return COMPLETE
    turn = counts[WATCHED]
    status[UNSEEN], counts[MOST], counts[WATCHED] = desk.drive[PERIOD], counts[IMPACTS] + limit, turn + 1
    note_strobe(room.strobes, turn, pose)
    if counts[KNOWN] > 0:
        repeat_period(room)
    elif is_same(desk, room.strobes, turn):
        note_period(room)
        counts[KNOWN] = 1
    else:
        begin_period(room)
    return outcome


@entry
def poses_at(
    desk: Engine, omega: float, amplitude: float, trace: Array, poses: Array, which: NDArray[np.int64], after: Array,
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
            advance_at_rest(desk, pose, clock, after[i])
        else:
            status[CLOCK] = clock
            cosine, sine = phase(desk.drive, clock)
            begin_flight(desk, pose, cosine, sine)
            end_flight(desk, pose, status, after[i], False)
        for k in range(pose.shape[1]):
            out[i, 0, k], out[i, 1, k] = pose[0, k], pose[1, k]
