"""Tasks of a batch: plain systems by the compiled kernels alone, any other point by the solver that a sweep takes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.batches.points import Points, plain_points
from vibeam.batches.response import Plan, Record
from vibeam.flight.engine.threads import pause
from vibeam.flight.kernels.thresholds import ELASTIC, PANEL
from vibeam.flight.points.points import SIDE_BY_SIDE, PointSettings, compute
from vibeam.solvers import solver
from vibeam.system.ended import Ended
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.state import State
from vibeam_models.arrays import Array

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
    most = SIDE_BY_SIDE if plan.lanes else 0
    settings = PointSettings(plan.settle, plan.hold, plan.output, plan.strobes, elastic, most)
    for some, results in compute(plain_points(points, which), settings):
        record.fill(which[some], results.response, results.states, results.resting, results.strobes)
    if plan.lyapunov:
        from vibeam.batches.exponents import largest_exponents

        record.exponents[:, which] = largest_exponents(points, which, plan.lyapunov, record)


def run_points(points: Points, which: NDArray[np.int64], plan: Plan, record: Record) -> None:
    """Compute the points ``which`` and note each in ``record``: what a sweep of one frequency gives, to the bit."""
    made: dict[tuple[float, ...], ImpactSystem] = {}
    for point in which.tolist():
        pause()
        key = (points.base[point], points.gap[point], points.restitution[point], points.damping[point])
        if key not in made:
            made = {key: points.system(point)}
        _run(points, point, made[key], plan, record)


def _run(points: Points, point: int, system: ImpactSystem, plan: Plan, record: Record) -> None:
    omega, states, strobes = float(points.omega[point]), list[State](), list[Array]()
    response, after = solver("flight", system, omega).steady(
        np.array([omega]), float(points.amplitude[point]), points.start(point), plan.settle, plan.hold, plan.output,
        states=states, strobes=strobes,
    )  # fmt: skip
    record.note(point, response, after, plan.strobed(system, strobes[0]))
    if plan.lyapunov and response.ended[0] == Ended.COMPLETE.code:
        from vibeam.batches.exponents import largest_exponent

        record.exponents[:, point] = largest_exponent(points, point, plan.lyapunov, record)
