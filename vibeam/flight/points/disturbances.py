"""Disturbances carried along the motions of many points by compiled code: monodromy matrices, growth by period."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vibeam.flight.engine.entries import carry_disturbances
from vibeam.flight.engine.threads import resumed
from vibeam.flight.kernels import layout
from vibeam.flight.points.kernels import layout as row
from vibeam.flight.points.kernels.layout import Disturbances
from vibeam.flight.points.packing import blank
from vibeam.flight.points.points import LIMIT, Packed, PlainPoints, PointSettings, packed_alike, room_of, task_of
from vibeam_models.arrays import Array, Flags, Index


@dataclass(frozen=True)
class Carried:
    """Disturbances of points (m,) at the end: their columns (m, c, 2, n), the factor by which a single one has
    grown in each period (m, p), the states (m, 2, n) at the end. ``known``: where no rest, no end of a chatter, no
    plastic impact (``lost``: these) and no fault came in the way; elsewhere the numbers say nothing.
    """

    columns: Array
    growth: Array
    states: Array
    known: Flags
    lost: Flags


def carry(points: PlainPoints, elastic: bool, periods: Index, columns: Array, single: bool) -> Carried:
    """Carry disturbances, columns (m, c, 2, n), along each point's motion over ``periods`` (m,) of the drive, from 0.

    ``single``: one column each, made of size 1 in units of velocity at the end of every period; all of as many periods.
    """
    m, n = len(points.omega), points.systems[0].size
    settings = PointSettings(0, 1, "contact", 0, elastic, 0)
    growth = np.zeros((m, int(periods.max(initial=0)) if single else 0))
    found = Carried(
        np.zeros(columns.shape), growth, np.zeros((m, 2, n)), np.zeros(m, dtype=bool), np.zeros(m, dtype=bool)
    )
    for which, made in packed_alike(points, settings):
        part = _run(points.of(which), made, settings, periods[which], columns[which], growth[which])
        for whole, values in zip(vars(found).values(), vars(part).values(), strict=True):
            whole[which] = values
    return found


def _run(
    points: PlainPoints, made: list[Packed], settings: PointSettings, periods: Index, columns: Array, growth: Array
) -> Carried:
    task, watch = task_of(points, made, settings), room_of(made[0][0], settings)
    of_system = [np.flatnonzero(points.system == i) for i in range(len(made))]
    inward = np.empty(columns.shape)
    for (packing, _), which in zip(made, of_system, strict=True):
        inward[which] = packing.inward(columns[which])
    given = Disturbances(periods, inward, np.ascontiguousarray(growth), np.zeros((len(periods), 2), dtype=np.int64))
    engines, status = blank(task.packs, 1), np.zeros(layout.STATUS_ROWS)
    counts = np.zeros(layout.COUNT_ROWS, dtype=np.int64)
    resumed(lambda first: carry_disturbances(task, engines, watch, given, status, counts, first, LIMIT))
    states, after = task.poses, given.columns
    for (packing, _), which in zip(made, of_system, strict=True):
        states[which], after[which] = packing.outward(states[which]), packing.outward(after[which])
    complete, lost = given.ended[:, 0] == layout.COMPLETE, given.ended[:, 1] == row.DIRECTION_LOST
    return Carried(after, given.growth, states, complete & ~lost & (task.kinds != layout.RESTING), complete & lost)
