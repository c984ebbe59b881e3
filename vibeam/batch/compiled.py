"""Points of plain systems, task by task, by the compiled kernels alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.batch.points import Points, changed
from vibeam.batch.record import Plan, Record
from vibeam.flight.kernels.thresholds import ELASTIC, PANEL
from vibeam.flight.points.points import SIDE_BY_SIDE, PlainPoints, Settings, compute

Whole = NDArray[np.int64]

TASK = 512  # points of one task of a thread at most


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
        size = min(TASK, max(64, len(part) // 16))
        found += [part[first : first + size] for first in range(0, len(part), size)]
    return found


def run_task(points: Points, which: Whole, plan: Plan, record: Record) -> None:
    """Compute the points ``which`` and keep them in ``record``."""
    elastic = bool(1.0 - points.restitution[which[0]] < ELASTIC)
    settings = Settings(plan.settle, plan.hold, plan.output, plan.strobes, elastic, SIDE_BY_SIDE if plan.lanes else 0)
    for some, results in compute(_plain(points, which), settings):
        record.fill(which[some], results.response, results.states, results.resting, results.strobes)


def _plain(points: Points, which: Whole) -> PlainPoints:
    """The points ``which``, their distinct dampings as systems."""
    kinds, system = np.unique(np.stack([points.base[which], points.damping[which]]), axis=1, return_inverse=True)
    bases = [points.bases[int(base)] for base in kinds[0]]
    systems = [changed(b, b.gap, b.restitution, float(d)) for b, d in zip(bases, kinds[1], strict=True)]
    starts = None if points.state is None else points.state[which].reshape(len(which), 2, points.size)
    resting = None if points.resting is None else points.resting[which]
    return PlainPoints(
        systems, system.ravel(), points.omega[which], points.amplitude[which], points.gap[which],
        points.restitution[which], starts, resting,
    )  # fmt: skip
