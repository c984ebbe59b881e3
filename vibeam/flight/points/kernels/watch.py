"""A settled point watched over its hold; one that comes back to the bits of an earlier state repeats from there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.events import advance
from vibeam.flight.kernels.layout import (
    CLOCK,
    COMPLETE,
    DONE,
    FULL,
    IMPACTS,
    KIND,
    KNOWN,
    MOST,
    OMEGA,
    PAUSED,
    PERIOD,
    REST_TIME,
    SEGMENTS,
    SPEED,
    SPEED_SUM,
    STRUCK,
    UNRESOLVED,
    UNSEEN,
    WATCHED,
    Engine,
    Schedule,
    W,
    Watch,
)
from vibeam.flight.kernels.segments import copy_pose, work_of
from vibeam.flight.kernels.steady_point import (
    begin_period,
    is_same,
    is_unread,
    note_impact,
    note_period,
    repetition,
    settling_kernel,
)
from vibeam.flight.points.kernels.flights import is_readable
from vibeam.flight.points.kernels.layout import ALL, FROM, HITS, MARK, PLACE, RESTED, STATE, SUM, TOP
from vibeam.flight.points.kernels.readout import read_rows

Array = NDArray[np.float64]

Counts = NDArray[np.int64]

settle = settling_kernel(advance)

DUE = 24  # segments after which they are read off

NO_STATE = -1.0  # a largest velocity that no state has


@kernel
def watched_point(
    desk: Engine, pose: Array, status: Array, schedule: Schedule, room: Watch, counts: Counts, mark: Array,
    flights: Array, recurs: bool,
) -> tuple[int, float]:  # fmt: skip
    """``steady_point`` of a point that has settled, by as few of its periods as tell all of them.

    The state at the end of a period decides all that follows. Where its bits are those at an earlier end, the periods
    between are added as often as they fit (cycle detection by Brent 1980), and the rest is watched as it is. The same
    where it is that of the period before to round-off and the motion ``recurs``: has settled onto one that repeats bit
    by bit. Flights of several periods are read off together, a lane each.
    """
    begun, hold, fresh = work_of(counts), schedule.hold, counts[WATCHED] == 0
    outcome = settle(desk, pose, status, schedule, room, counts)
    if outcome == COMPLETE and fresh:
        mark[PLACE], mark[TOP], mark[FROM], counts[SEGMENTS] = 0.0, NO_STATE, 0.0, 0
    readable = is_readable(desk)
    period = desk.drive[PERIOD]
    while outcome == COMPLETE and counts[WATCHED] <= hold:
        turn, rows = counts[WATCHED], counts[SEGMENTS]
        if status[DONE] == 0.0:
            status[CLOCK] = period - status[UNSEEN]
        outcome, done = advance(desk, pose, status, status[UNSEEN], counts[MOST], room.trace, room.poses, counts)
        if outcome == PAUSED:
            return PAUSED, 0.0
        begun -= schedule.watching * (counts[SEGMENTS] - rows)
        status[UNSEEN] -= done
        if outcome == FULL:
            outcome = COMPLETE
            read_off(desk, room, counts, mark, flights, readable)
            mark[FROM] = -1.0
        elif outcome == COMPLETE:
            status[UNSEEN], counts[MOST], counts[WATCHED] = period, counts[IMPACTS] + schedule.limit, turn + 1
            copy_pose(pose, room.strobes[turn])
            if counts[KNOWN] > 0:
                count_impacts(room.trace, counts, room.result)
                add_share(room.energy, room.result, room.share)
            elif mark[FROM] >= 0.0 and is_same(desk.pairs[OMEGA], desk.drive[W], room.strobes, turn):
                read_last_period(desk, room, counts, mark, flights, readable)
                if recurs:
                    mark[PLACE] = turn - 1.0
                    repeat(room, counts, mark, turn, hold)
            elif mark[FROM] < 0.0 or counts[SEGMENTS] >= DUE or turn >= hold:
                read_off(desk, room, counts, mark, flights, readable)
            else:
                mark[FROM] = counts[SEGMENTS]
            if counts[WATCHED] <= hold:
                if is_marked(room.strobes, status, mark, turn):
                    read_off(desk, room, counts, mark, flights, readable)
                    repeat(room, counts, mark, turn, hold)
                elif turn >= 2 * int(mark[PLACE]):
                    read_off(desk, room, counts, mark, flights, readable)
                    set_mark(room, status, counts, mark, turn)
        if outcome == COMPLETE and is_unread(room.result):
            outcome = UNRESOLVED
        if outcome == COMPLETE and counts[WATCHED] <= hold and work_of(counts) - begun >= schedule.piece:
            outcome = PAUSED
    if outcome == PAUSED:
        return PAUSED, 0.0
    status[CLOCK] = 0.0
    if outcome != COMPLETE:
        return int(outcome), 0.0
    return COMPLETE, float(repetition(desk.pairs[OMEGA], desk.drive[W], room.strobes, hold, schedule.longest))


@kernel
def read_off(desk: Engine, room: Watch, counts: Counts, mark: Array, flights: Array, readable: bool) -> None:
    """Read off what is traced; where the period repeats, count its impacts and nothing else."""
    if counts[KNOWN] > 0:
        count_impacts(room.trace, counts, room.result)
    else:
        read_rows(desk, room, 0, counts[SEGMENTS], flights, readable)
    counts[SEGMENTS], mark[FROM] = 0, 0.0


@kernel
def count_impacts(trace: Array, counts: Counts, result: Array) -> None:
    """Count the impacts traced, and nothing else."""
    for i in range(counts[SEGMENTS]):
        note_impact(trace, i, result)
    counts[SEGMENTS] = 0


@joined
def add_share(energy: Array, result: Array, share: Array) -> None:
    """A period like the one watched last: the same energies and time at rest, no new extremes."""
    n = energy.shape[0]
    for k in range(n):
        energy[k] += share[k]
    result[REST_TIME] += share[n]


@kernel
def read_last_period(desk: Engine, room: Watch, counts: Counts, mark: Array, flights: Array, readable: bool) -> None:
    """Read off what is traced, and note what the last period adds: those to come are copies of it.

    The mark holds what there was before it.
    """
    first, result = int(mark[FROM]), room.result
    read_rows(desk, room, 0, first, flights, readable)
    begin_period(room)
    mark[HITS], mark[SUM], mark[RESTED] = result[STRUCK], result[SPEED_SUM], result[REST_TIME]
    for k in range(room.energy.shape[0]):
        mark[MARK + k] = room.energy[k]
    read_rows(desk, room, first, counts[SEGMENTS], flights, readable)
    note_period(room)
    mark[ALL], mark[TOP] = counts[IMPACTS] - (result[STRUCK] - mark[HITS]), NO_STATE
    counts[SEGMENTS], mark[FROM], counts[KNOWN] = 0, 0.0, 1


@kernel
def set_mark(room: Watch, status: Array, counts: Counts, mark: Array, turn: int) -> None:
    """Later ends of periods are compared to this one."""
    result = room.result
    mark[PLACE], mark[TOP], mark[STATE], mark[HITS] = turn, status[SPEED], status[KIND], result[STRUCK]
    mark[SUM], mark[RESTED], mark[ALL] = result[SPEED_SUM], result[REST_TIME], counts[IMPACTS]
    for k in range(room.energy.shape[0]):
        mark[MARK + k] = room.energy[k]


@joined
def is_marked(strobes: Array, status: Array, mark: Array, turn: int) -> bool:
    """Whether the state at the end of a period is the marked one, bit by bit."""
    if status[SPEED] != mark[TOP] or status[KIND] != mark[STATE]:
        return False
    now, then = strobes[turn], strobes[int(mark[PLACE])]
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
