"""A settled point watched over its hold; one that comes back to the bits of an earlier state repeats from there."""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.events import advance
from vibeam.flight.kernels.layout import Engine, PointSchedule, Watch
from vibeam.flight.kernels.readout import MOST_WORK
from vibeam.flight.kernels.segments import copy_pose, turns_of, work_of
from vibeam.flight.kernels.steady_point import (
    begin_period,
    is_same,
    is_unread,
    note_impacts,
    note_period,
    repeat_period,
    repetition,
    settling_kernel,
)
from vibeam.flight.points.kernels import layout as row
from vibeam.flight.points.kernels.readout import read_rows
from vibeam.flight.points.kernels.rows import is_readable
from vibeam_models.arrays import Array, Index

settle = settling_kernel(advance)
DUE = 24  # segments after which they are read off
NO_STATE = -1.0  # a largest velocity that no state has


@kernel
def watched_point(
    engine: Engine, pose: Array, status: Array, schedule: PointSchedule, watch: Watch, counts: Index, mark: Array,
    flights: Array, recurs: bool,
) -> tuple[int, float]:  # fmt: skip
    """``steady_point`` of a point that has settled, by as few of its periods as tell all of them.

    The state at the end of a period decides all that follows. Where its bits are those at an earlier end, the periods
    between are added as often as they fit (cycle detection by Brent 1980), and the rest is watched as it is. The same
    where it is that of the period before to round-off and the motion ``recurs``: has settled onto one that repeats bit
    by bit. Flights of several periods are read off together, a lane each.
    """
    begun, hold, fresh = work_of(counts), schedule.hold, counts[layout.WATCHED] == 0
    outcome = settle(engine, pose, status, schedule, watch, counts)
    if outcome == layout.COMPLETE and fresh:
        mark[row.PLACE], mark[row.TOP], mark[row.FROM], counts[layout.SEGMENTS] = 0.0, NO_STATE, 0.0, 0
    readable = is_readable(engine)
    period, own = engine.drive[layout.PERIOD], engine.pairs[layout.OMEGA]
    long = turns_of(own, period) * (own.shape[0] + 8) > MOST_WORK  # each by itself, that it may pause
    while outcome == layout.COMPLETE and counts[layout.WATCHED] <= hold:
        turn, rows = counts[layout.WATCHED], counts[layout.SEGMENTS]
        if status[layout.DONE] == 0.0:
            status[layout.CLOCK] = period - status[layout.UNSEEN]
        outcome, done = advance(
            engine, pose, status, status[layout.UNSEEN], counts[layout.MOST], watch.trace, watch.poses, counts
        )
        if outcome == layout.PAUSED:
            return layout.PAUSED, 0.0
        begun -= schedule.piece if long else schedule.watching * (counts[layout.SEGMENTS] - rows)
        status[layout.UNSEEN] -= done
        if outcome == layout.FULL:
            outcome = layout.COMPLETE
            read_off(engine, watch, counts, mark, flights, readable)
            mark[row.FROM] = -1.0
        elif outcome == layout.COMPLETE:
            status[layout.UNSEEN], counts[layout.MOST] = period, counts[layout.IMPACTS] + schedule.limit
            counts[layout.WATCHED] = turn + 1
            copy_pose(pose, watch.strobes[turn])
            if counts[layout.KNOWN] > 0:
                note_impacts(watch, counts[layout.SEGMENTS])
                counts[layout.SEGMENTS] = 0
                repeat_period(watch)
            elif mark[row.FROM] >= 0.0 and is_same(own, engine.drive[layout.W], watch.strobes, turn):
                read_last_period(engine, watch, counts, mark, flights, readable)
                if recurs:
                    mark[row.PLACE] = turn - 1.0
                    repeat(watch, counts, mark, turn, hold)
            elif long or mark[row.FROM] < 0.0 or counts[layout.SEGMENTS] >= DUE or turn >= hold:
                read_off(engine, watch, counts, mark, flights, readable)
            else:
                mark[row.FROM] = counts[layout.SEGMENTS]
            if counts[layout.WATCHED] <= hold:
                if is_marked(watch.strobes, status, mark, turn):
                    read_off(engine, watch, counts, mark, flights, readable)
                    repeat(watch, counts, mark, turn, hold)
                elif turn >= 2 * int(mark[row.PLACE]):
                    read_off(engine, watch, counts, mark, flights, readable)
                    set_mark(watch, status, counts, mark, turn)
        if outcome == layout.COMPLETE and is_unread(watch.result):
            outcome = layout.UNRESOLVED
        if outcome == layout.COMPLETE and counts[layout.WATCHED] <= hold and work_of(counts) - begun >= schedule.piece:
            outcome = layout.PAUSED
    if outcome == layout.PAUSED:
        return layout.PAUSED, 0.0
    status[layout.CLOCK] = 0.0
    if outcome != layout.COMPLETE:
        return int(outcome), 0.0
    return layout.COMPLETE, float(repetition(own, engine.drive[layout.W], watch.strobes, hold, schedule.longest))


@kernel
def read_off(engine: Engine, watch: Watch, counts: Index, mark: Array, flights: Array, readable: bool) -> None:
    """Read off what is traced; where the period repeats, count its impacts and nothing else."""
    if counts[layout.KNOWN] > 0:
        note_impacts(watch, counts[layout.SEGMENTS])
    else:
        read_rows(engine, watch, 0, counts[layout.SEGMENTS], flights, readable)
    counts[layout.SEGMENTS], mark[row.FROM] = 0, 0.0


@kernel
def read_last_period(engine: Engine, watch: Watch, counts: Index, mark: Array, flights: Array, readable: bool) -> None:
    """Read off what is traced, and note what the last period adds: those to come are copies of it.

    The mark holds what there was before it.
    """
    first, result = int(mark[row.FROM]), watch.result
    read_rows(engine, watch, 0, first, flights, readable)
    begin_period(watch)
    mark[row.HITS], mark[row.SUM] = result[layout.STRUCK], result[layout.SPEED_SUM]
    mark[row.RESTED] = result[layout.REST_TIME]
    for k in range(watch.energy.shape[0]):
        mark[row.MARK + k] = watch.energy[k]
    read_rows(engine, watch, first, counts[layout.SEGMENTS], flights, readable)
    note_period(watch)
    mark[row.ALL], mark[row.TOP] = counts[layout.IMPACTS] - (result[layout.STRUCK] - mark[row.HITS]), NO_STATE
    counts[layout.SEGMENTS], mark[row.FROM], counts[layout.KNOWN] = 0, 0.0, 1


@kernel
def set_mark(watch: Watch, status: Array, counts: Index, mark: Array, turn: int) -> None:
    """Later ends of periods are compared to this one."""
    result = watch.result
    mark[row.PLACE], mark[row.TOP], mark[row.STATE] = turn, status[layout.SPEED], status[layout.KIND]
    mark[row.HITS] = result[layout.STRUCK]
    mark[row.SUM], mark[row.RESTED] = result[layout.SPEED_SUM], result[layout.REST_TIME]
    mark[row.ALL] = counts[layout.IMPACTS]
    for k in range(watch.energy.shape[0]):
        mark[row.MARK + k] = watch.energy[k]


@joined
def is_marked(strobes: Array, status: Array, mark: Array, turn: int) -> bool:
    """True where the state at the end of a period is the marked one, bit by bit."""
    if status[layout.SPEED] != mark[row.TOP] or status[layout.KIND] != mark[row.STATE]:
        return False
    now, then = strobes[turn], strobes[int(mark[row.PLACE])]
    same = True
    for k in range(now.shape[1]):
        same = same and now[0, k] == then[0, k] and now[1, k] == then[1, k]
    return same


@kernel
def repeat(watch: Watch, counts: Index, mark: Array, turn: int, hold: int) -> None:
    """Add the periods since the mark as often as they fit into the hold."""
    cycle = turn - int(mark[row.PLACE])
    times = (hold - turn) // cycle
    result = watch.result
    result[layout.STRUCK] += times * (result[layout.STRUCK] - mark[row.HITS])
    result[layout.SPEED_SUM] += times * (result[layout.SPEED_SUM] - mark[row.SUM])
    result[layout.REST_TIME] += times * (result[layout.REST_TIME] - mark[row.RESTED])
    counts[layout.MOST] += times * (counts[layout.IMPACTS] - int(mark[row.ALL]))
    counts[layout.IMPACTS] += times * (counts[layout.IMPACTS] - int(mark[row.ALL]))
    for k in range(watch.energy.shape[0]):
        watch.energy[k] += times * (watch.energy[k] - mark[row.MARK + k])
    for j in range(times * cycle):
        copy_pose(watch.strobes[turn + 1 + j - cycle], watch.strobes[turn + 1 + j])
    counts[layout.WATCHED] += times * cycle
    mark[row.TOP] = NO_STATE  # what is left is watched as it is
