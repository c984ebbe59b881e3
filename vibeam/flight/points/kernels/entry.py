"""Entry point: a task of points, as many side by side as there are lanes."""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import entry
from vibeam.flight.kernels.entry import WATCHING, steady_point
from vibeam.flight.kernels.events import piece_of
from vibeam.flight.kernels.layout import PointSchedule, Watch
from vibeam.flight.points.kernels import layout as row
from vibeam.flight.points.kernels.landing import find_roots, recur, strike
from vibeam.flight.points.kernels.layout import Lane, LaneRows, Task
from vibeam.flight.points.kernels.point import engine_of, go_alone, join, keep, leave, take_output, take_point
from vibeam.flight.points.kernels.walk import launch, walk
from vibeam.flight.points.kernels.watch import watched_point

BUDGET = 400_000  # impacts and panels between two pauses
ROUNDS = 4096  # flights of all lanes between two looks at the budget


@entry
def run(
    task: Task, lane: Lane, watch: Watch, first: int, settle: int, hold: int, limit: int, longest: int, most_modes: int
) -> tuple[int, int]:
    """Compute the points from ``first`` on, at most ``most_modes`` modes side by side: outcome, the next point to take.

    PAUSED: called again with that point it goes on as if it had not been. Each point is settled, watched and kept in
    ``task`` by itself: its numbers depend neither on its lane nor on the points beside it.
    """
    schedule = PointSchedule(settle, hold, limit, longest, piece_of(lane.poses[0]), WATCHING)
    point, points, work = first, task.pack.shape[0], 0
    rows = LaneRows(lane.common, lane.modal, lane.engines.levels, lane.engines.rungs)
    while work <= BUDGET:
        flying = 0
        for slot in range(row.WIDTH):
            whole, counts = lane.whole[slot], lane.counts[slot]
            while whole[row.PHASE] != row.FLYING:
                if work > BUDGET:
                    return layout.PAUSED, point
                if whole[row.PHASE] == row.EMPTY:
                    if point >= points:
                        break
                    take_point(task, lane, slot, point, schedule, most_modes)
                    point += 1
                    continue
                before = counts[layout.IMPACTS] + counts[layout.PANELS]
                engine = engine_of(lane.engines, slot)
                if whole[row.PHASE] == row.ALONE:
                    outcome, period = go_alone(lane, slot, engine, schedule, watch), 0.0
                    if outcome == layout.COMPLETE:
                        join(lane, slot, engine, schedule)
                else:
                    pose, status = lane.poses[slot], lane.status[slot]
                    take_output(task, whole[row.POINT], watch)
                    if whole[row.ELIGIBLE] > 0:
                        outcome, period = watched_point(
                            engine, pose, status, schedule, watch, counts, lane.marks, lane.flights,
                            whole[row.RECURS] > 0,
                        )  # fmt: skip
                    else:
                        outcome, period = steady_point(
                            engine, engine.pairs[layout.OMEGA], pose, status, schedule, watch, counts
                        )
                    if outcome == layout.COMPLETE:
                        keep(task, lane, slot, watch, outcome, period)
                        whole[row.PHASE] = row.EMPTY
                work += counts[layout.IMPACTS] + counts[layout.PANELS] - before + 10
                if outcome == layout.PAUSED:
                    return layout.PAUSED, point
                if outcome != layout.COMPLETE:
                    keep(task, lane, slot, watch, outcome, period)
                    whole[row.PHASE] = row.EMPTY
            if whole[row.PHASE] == row.FLYING:
                flying |= 1 << slot
        if flying == 0:
            return layout.COMPLETE, point
        struck, rounds, came_back = flying, 0, 0
        while struck == flying and rounds < ROUNDS:
            lost = launch(rows, flying)
            landed = walk(rows, flying & ~lost)
            struck = strike(rows, find_roots(rows, landed))
            came_back |= recur(rows, struck)
            rounds += 1
        work += 16 * rounds
        for slot in range(row.WIDTH):
            if (came_back >> slot) & 1:
                lane.whole[slot, row.RECURS] = 1
            if (flying >> slot) & 1 and not (struck >> slot) & 1:
                leave(lane, slot, engine_of(lane.engines, slot))
    return layout.PAUSED, point
