"""Entry point: disturbances carried along the motions of points, one point after the other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.events import advance
from vibeam.flight.kernels.layout import Engine, Watch
from vibeam.flight.points.kernels.compiler import entry
from vibeam.flight.points.kernels.layout import Task
from vibeam.flight.points.kernels.point import engine_of, fill_engine, set_point
from vibeam.flight.points.tangents import layout as tangent_layout
from vibeam.flight.points.tangents.along import carry_along, normalized
from vibeam.flight.points.tangents.layout import Disturbances
from vibeam_models.arrays import Array

Counts = NDArray[np.int64]
BUDGET = 100_000  # impacts between two pauses


@entry
def carry(
    task: Task, engines: Engine, watch: Watch, disturbances: Disturbances, status: Array, counts: Counts, first: int,
    limit: int,
) -> tuple[int, int]:  # fmt: skip
    """Carry the disturbances of the points from ``first`` on: outcome, the next point.

    PAUSED: called again with that point it goes on as if it had not been. ``engines``: room for one engine. Each point
    is carried on from its pose in ``task`` at the drive's phase 0, and its end is put there.
    """
    work = 0
    engine = engine_of(engines, 0)
    for point in range(first, task.pack.shape[0]):
        if work > BUDGET:
            return layout.PAUSED, point
        fill_engine(engine, engine_of(task.packs, task.pack[point]))
        set_point(task, engine, point)
        status[:], counts[:] = 0.0, 0
        status[layout.KIND] = task.kinds[point]
        outcome, lost = go_along(
            engine, task.poses[point], watch, disturbances.columns[point], disturbances.growth[point], status, counts,
            disturbances.periods[point], limit,
        )  # fmt: skip
        task.kinds[point] = status[layout.KIND]
        disturbances.ended[point, 0], disturbances.ended[point, 1] = outcome, lost
        task.counts[point, layout.IMPACTS] = counts[layout.IMPACTS]
        work += counts[layout.IMPACTS] + 100
    return layout.COMPLETE, task.pack.shape[0]


@kernel
def go_along(
    engine: Engine, pose: Array, watch: Watch, columns: Array, growth: Array, status: Array, counts: Counts,
    periods: int, limit: int,
) -> tuple[int, int]:  # fmt: skip
    """Carry one point's pose and disturbances over some drive periods: outcome, LOST where a direction is lost."""
    for turn in range(periods):
        left = engine.drive[layout.PERIOD]
        most = counts[layout.IMPACTS] + limit
        status[layout.CLOCK], counts[layout.EVENTS] = 0.0, 0
        outcome = layout.FULL
        while outcome in (layout.FULL, layout.PAUSED):
            if outcome == layout.FULL:
                counts[layout.SEGMENTS] = 0
            outcome, done = advance(engine, pose, status, left, most, watch.trace, watch.poses, counts)
            if outcome == layout.PAUSED:
                continue
            left -= done
            if carry_along(
                engine.pairs,
                engine.modes,
                engine.drive,
                watch.trace,
                watch.poses,
                pose,
                counts[layout.SEGMENTS],
                columns,
            ):
                return layout.COMPLETE, tangent_layout.LOST
        if outcome != layout.COMPLETE:
            return int(outcome), 0
        if growth.shape[0] > 0:
            growth[turn] = normalized(engine.pairs, engine.drive[layout.W], columns[0])
    status[layout.CLOCK] = 0.0
    return layout.COMPLETE, 0
