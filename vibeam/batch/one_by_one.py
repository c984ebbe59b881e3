"""Points of a batch one after another by the solver that a sweep takes: any system, law and output."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.batch.points import Points
from vibeam.batch.record import Plan, Record
from vibeam.flight.pause import pause
from vibeam.solvers import solver
from vibeam.system.ended import Ended
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.state import State

Array = NDArray[np.float64]


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
        from vibeam.batch.exponents import largest_exponent

        record.lyapunov[point] = largest_exponent(points, point, plan.lyapunov, record)
