"""Points of plain systems, task by task, by the compiled kernels alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.batch.plain import plain_points
from vibeam.batch.points import Points
from vibeam.batch.record import Plan, Record
from vibeam.flight.kernels.thresholds import ELASTIC, PANEL
from vibeam.flight.points.points import SIDE_BY_SIDE, Settings, compute

Whole = NDArray[np.int64]

TASK, LEAST = 1024, 256  # points of one task of a thread at most, and at least where there are as many


def is_compiled(points: Points, output: str) -> NDArray[np.bool_]:
    """Which points the kernels take: those of plain systems, read as displacements."""
    plain = [not base.beyond_plain and base.derivative(output) is None for base in points.bases]
    return np.array(plain)[points.base]


def tasks_of(points: Points, which: Whole) -> list[Whole]:
    """The points ``which`` in tasks of what is packed alike, neighbours side by side."""
    level = np.floor(np.log2(PANEL / points.omega[which]))  # of the longest panels: see ``linear.packing.top_level``
    elastic = 1.0 - points.restitution[which] < ELASTIC
    order = np.lexsort((points.omega[which], points.damping[which], points.base[which], level, elastic))
    which, kind = which[order], np.stack([level, elastic])[:, order]
    found = []
    for part in np.split(which, np.flatnonzero(np.any(np.diff(kind), axis=0)) + 1):
        found += _portions(part)
    return sorted(found, key=len, reverse=True)


def _portions(part: Whole) -> list[Whole]:
    """Large tasks, which cost little beside their points, then smaller ones, so that all threads end about together."""
    found = []
    while len(part):
        size = min(TASK, max(LEAST, len(part) // 3))
        found.append(part[:size])
        part = part[size:]
    return found


def run_task(points: Points, which: Whole, plan: Plan, record: Record) -> None:
    """Compute the points ``which`` and keep them in ``record``."""
    elastic = bool(1.0 - points.restitution[which[0]] < ELASTIC)
    settings = Settings(plan.settle, plan.hold, plan.output, plan.strobes, elastic, SIDE_BY_SIDE if plan.lanes else 0)
    for some, results in compute(plain_points(points, which), settings):
        record.fill(which[some], results.response, results.states, results.resting, results.strobes)
    if plan.lyapunov:
        from vibeam.batch.exponents import largest_exponents

        record.lyapunov[which] = largest_exponents(points, which, plan.lyapunov, record)
