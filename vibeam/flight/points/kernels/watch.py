"""A settled point watched over its hold; one that comes back to the bits of an earlier state repeats from there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.events import advance
from vibeam.flight.kernels.layout import (
    CLOCK,
    COMPLETE,
    IMPACTS,
    KIND,
    MOST,
    OMEGA,
    PAUSED,
    REST_TIME,
    SEGMENTS,
    SPEED,
    SPEED_SUM,
    STRUCK,
    WATCHED,
    Engine,
    Schedule,
    W,
    Watch,
)
from vibeam.flight.kernels.readout import read_segment
from vibeam.flight.kernels.segments import copy_pose, work_of
from vibeam.flight.kernels.steady_point import repetition, settling_kernel, watching_kernel
from vibeam.flight.points.kernels.layout import ALL, HITS, MARK, PLACE, RESTED, STATE, SUM, TOP

Array = NDArray[np.float64]

Counts = NDArray[np.int64]

settle, watch = settling_kernel(advance), watching_kernel(advance, read_segment)

NO_STATE = -1.0  # a largest velocity that no state has


@kernel
def watched_point(
    desk: Engine, pose: Array, status: Array, schedule: Schedule, room: Watch, counts: Counts, mark: Array
) -> tuple[int, float]:
    """``steady_point`` of a point that has settled, by as few of its periods as tell all of them.

    The state at the end of a period decides all that follows. Where its bits are those at an earlier end, the periods
    between are added as often as they fit (cycle detection by Brent 1980), and the rest is watched as it is.
    """
    begun, hold = work_of(counts), schedule.hold
    outcome = settle(desk, pose, status, schedule, room, counts)
    while outcome == COMPLETE and counts[WATCHED] <= hold:
        turn = counts[WATCHED]
        if turn == 1:
            mark[PLACE], mark[TOP] = 0.0, NO_STATE
        outcome = watch(desk, desk.pairs[OMEGA], pose, status, schedule.limit, room, counts)
        begun -= schedule.watching * counts[SEGMENTS]
        if outcome == COMPLETE and counts[WATCHED] > turn and counts[WATCHED] <= hold:
            if is_marked(room, status, mark, turn):
                repeat(room, counts, mark, turn, hold)
            elif turn >= 2 * int(mark[PLACE]):
                set_mark(room, status, counts, mark, turn)
        if outcome == COMPLETE and counts[WATCHED] <= hold and work_of(counts) - begun >= schedule.piece:
            outcome = PAUSED
    if outcome == PAUSED:
        return PAUSED, 0.0
    status[CLOCK] = 0.0
    if outcome != COMPLETE:
        return int(outcome), 0.0
    return COMPLETE, float(repetition(desk.pairs[OMEGA], desk.drive[W], room.strobes, hold, schedule.longest))


@kernel
def set_mark(room: Watch, status: Array, counts: Counts, mark: Array, turn: int) -> None:
    """Later ends of periods are compared to this one."""
    result = room.result
    mark[PLACE], mark[TOP], mark[STATE], mark[HITS] = turn, status[SPEED], status[KIND], result[STRUCK]
    mark[SUM], mark[RESTED], mark[ALL] = result[SPEED_SUM], result[REST_TIME], counts[IMPACTS]
    for k in range(room.energy.shape[0]):
        mark[MARK + k] = room.energy[k]


@kernel
def is_marked(room: Watch, status: Array, mark: Array, turn: int) -> bool:
    """Whether the state at the end of a period is the marked one, bit by bit."""
    if status[SPEED] != mark[TOP] or status[KIND] != mark[STATE]:
        return False
    now, then = room.strobes[turn], room.strobes[int(mark[PLACE])]
    same = True
    for k in range(now.shape[1]):
        same = same and now[0, k] == then[0, k] and now[1, k] == then[1, k]
    return same


@kernel
def repeat(room: Watch, counts: Counts, mark: Array, turn: int, hold: int) -> None:
    """Add the periods since the mark as often as they fit into the hold."""
    cycle = turn - int(mark[PLACE])
    times = (hold - turn) // cycle
    result = room.result
    result[STRUCK] += times * (result[STRUCK] - mark[HITS])
    result[SPEED_SUM] += times * (result[SPEED_SUM] - mark[SUM])
    result[REST_TIME] += times * (result[REST_TIME] - mark[RESTED])
    counts[MOST] += times * (counts[IMPACTS] - int(mark[ALL]))
    counts[IMPACTS] += times * (counts[IMPACTS] - int(mark[ALL]))
    for k in range(room.energy.shape[0]):
        room.energy[k] += times * (room.energy[k] - mark[MARK + k])
    for j in range(times * cycle):
        copy_pose(room.strobes[turn + 1 + j - cycle], room.strobes[turn + 1 + j])
    counts[WATCHED] += times * cycle
    mark[TOP] = NO_STATE  # what is left is watched as it is
