"""Entry point: disturbances carried along the motions of points, one point after the other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.events import advance
from vibeam.flight.kernels.layout import (
    CLOCK,
    COMPLETE,
    EVENTS,
    FULL,
    IMPACTS,
    KIND,
    PAUSED,
    PERIOD,
    SEGMENTS,
    Engine,
    W,
    Watch,
)
from vibeam.flight.points.kernels.compiler import entry
from vibeam.flight.points.kernels.layout import Task
from vibeam.flight.points.kernels.point import engine_of, fill_engine, set_point
from vibeam.flight.points.tangents.along import carry_along, normalized
from vibeam.flight.points.tangents.layout import LOST, Disturbances

Array = NDArray[np.float64]

Counts = NDArray[np.int64]

BUDGET = 100_000  # impacts between two pauses


@entry
def carry(
    task: Task, desks: Engine, room: Watch, disturbances: Disturbances, status: Array, counts: Counts, first: int,
    limit: int,
) -> tuple[int, int]:  # fmt: skip
    """Carry the disturbances of the points from ``first`` on: outcome, the next point.

    PAUSED: called again with that point it goes on as if it had not been. ``desks``: room for one engine. Each point
    is carried on from its pose in ``task`` at the drive's phase 0, and its end is put there.
    """
    work = 0
    desk = engine_of(desks, 0)
    for point in range(first, task.pack.shape[0]):
        if work > BUDGET:
            return PAUSED, point
        fill_engine(desk, engine_of(task.packs, task.pack[point]))
        set_point(task, desk, point)
        status[:], counts[:] = 0.0, 0
        status[KIND] = task.kinds[point]
        outcome, lost = go_along(
            desk, task.poses[point], room, disturbances.columns[point], disturbances.growth[point], status, counts,
            disturbances.periods[point], limit,
        )  # fmt: skip
        task.kinds[point] = status[KIND]
        disturbances.ended[point, 0], disturbances.ended[point, 1] = outcome, lost
        task.counts[point, IMPACTS] = counts[IMPACTS]
        work += counts[IMPACTS] + 100
    return COMPLETE, task.pack.shape[0]


@kernel
def go_along(
    desk: Engine, pose: Array, room: Watch, columns: Array, growth: Array, status: Array, counts: Counts, periods: int,
    limit: int,
) -> tuple[int, int]:  # fmt: skip
    """Carry one point's pose and disturbances over some drive periods: outcome, LOST where a direction is lost."""
    for turn in range(periods):
        left = desk.drive[PERIOD]
        most = counts[IMPACTS] + limit
        status[CLOCK], counts[EVENTS] = 0.0, 0
        outcome = FULL
        while outcome in (FULL, PAUSED):
            if outcome == FULL:
                counts[SEGMENTS] = 0
            outcome, done = advance(desk, pose, status, left, most, room.trace, room.poses, counts)
            if outcome == PAUSED:
                continue
            left -= done
            if carry_along(desk.pairs, desk.modes, desk.drive, room.trace, room.poses, pose, counts[SEGMENTS], columns):
                return COMPLETE, LOST
        if outcome != COMPLETE:
            return int(outcome), 0
        if growth.shape[0] > 0:
            growth[turn] = normalized(desk.pairs, desk.drive[W], columns[0])
    status[CLOCK] = 0.0
    return COMPLETE, 0
