"""Entry point: a task of points, as many side by side as there are lanes."""

from __future__ import annotations

from vibeam.flight.kernels.entry import WATCHING, steady_point
from vibeam.flight.kernels.events import piece_of
from vibeam.flight.kernels.layout import COMPLETE, IMPACTS, OMEGA, PANELS, PAUSED, Schedule, Watch
from vibeam.flight.points.kernels import layout as row
from vibeam.flight.points.kernels.compiler import entry
from vibeam.flight.points.kernels.landing import find_roots, recur, strike
from vibeam.flight.points.kernels.layout import WIDTH, Lane, Rows, Task
from vibeam.flight.points.kernels.point import engine_of, go_alone, join, keep, leave, take_point
from vibeam.flight.points.kernels.walk import launch, walk
from vibeam.flight.points.kernels.watch import watched_point

BUDGET = 400_000  # impacts and panels between two pauses

ROUNDS = 4096  # flights of all lanes between two looks at the budget


@entry
def run(
    task: Task, lane: Lane, room: Watch, first: int, settle: int, hold: int, limit: int, longest: int, most_modes: int
) -> tuple[int, int]:
    """Compute the points from ``first`` on, at most ``most_modes`` modes side by side: outcome, the next point to take.

    PAUSED: called again with that point it goes on as if it had not been. Each point is settled, watched and kept in
    ``task`` by itself: its numbers depend neither on its lane nor on the points beside it.
    """
    schedule = Schedule(settle, hold, limit, longest, piece_of(lane.poses[0]), WATCHING)
    point, points, work = first, task.pack.shape[0], 0
    rows = Rows(lane.common, lane.modal, lane.desks.levels, lane.desks.rungs)
    while True:
        flying = 0
        for slot in range(WIDTH):
            whole, counts = lane.whole[slot], lane.counts[slot]
            while whole[row.PHASE] != row.FLYING:
                if work > BUDGET:
                    return PAUSED, point
                if whole[row.PHASE] == row.EMPTY:
                    if point >= points:
                        break
                    take_point(task, lane, slot, point, schedule, most_modes)
                    point += 1
                    continue
                before = counts[IMPACTS] + counts[PANELS]
                desk = engine_of(lane.desks, slot)
                if whole[row.PHASE] == row.ALONE:
                    outcome, period = go_alone(lane, slot, desk, schedule, room), 0.0
                    if outcome == COMPLETE:
                        join(lane, slot, desk, schedule)
                else:
                    pose, status = lane.poses[slot], lane.status[slot]
                    if whole[row.ELIGIBLE] > 0:
                        outcome, period = watched_point(
                            desk, pose, status, schedule, room, counts, lane.marks, lane.flights,
                            whole[row.RECURS] > 0,
                        )  # fmt: skip
                    else:
                        outcome, period = steady_point(desk, desk.pairs[OMEGA], pose, status, schedule, room, counts)
                    if outcome == COMPLETE:
                        keep(task, lane, slot, room, outcome, period)
                        whole[row.PHASE] = row.EMPTY
                work += counts[IMPACTS] + counts[PANELS] - before + 10
                if outcome == PAUSED:
                    return PAUSED, point
                if outcome != COMPLETE:
                    keep(task, lane, slot, room, outcome, period)
                    whole[row.PHASE] = row.EMPTY
            if whole[row.PHASE] == row.FLYING:
                flying |= 1 << slot
        if flying == 0:
            return COMPLETE, point
        struck, rounds, came_back = flying, 0, 0
        while struck == flying and rounds < ROUNDS:
            lost = launch(rows, flying)
            landed = walk(rows, flying & ~lost)
            struck = strike(rows, find_roots(rows, landed))
            came_back |= recur(rows, struck)
            rounds += 1
        work += 16 * rounds
        for slot in range(WIDTH):
            if (came_back >> slot) & 1:
                lane.whole[slot, row.RECURS] = 1
            if (flying >> slot) & 1 and not (struck >> slot) & 1:
                leave(lane, slot, engine_of(lane.desks, slot))
        if work > BUDGET:
            return PAUSED, point
