"""Row of one run: errors of its amplitudes and its CPU time; the front of both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import isfinite

import numpy as np

from vibeam.studies.cost.measure import Measurement
from vibeam.studies.cost.planning import CostModel
from vibeam.system.curves import Difference
from vibeam.system.response import Ended, FrequencyResponse, complete


@dataclass(frozen=True)
class RunRow:
    """One run: errors of the amplitudes where both motions repeat, and the CPU time.

    ``total``: against the exact motions of the finest fidelity. ``computed``: frequencies that it computed, ``found``:
    at which it found a motion. ``seconds``: CPU time of a frequency, NaN where not one was
    computed; ``used``: of all of it, also of a frequency at which it was given up. ``why``: reason of a failure or of
    being given up; a failed run has no errors.
    """

    fidelity: str
    modes: int
    solver: str
    method: str
    setting: str
    total: Difference = field(default_factory=Difference)
    computed: int = 0
    found: int = 0
    seconds: float = float("nan")
    used: float = 0.0
    periods: int = 0  #: drive periods of a frequency
    why: str = ""

    @property
    def label(self) -> str:
        """Solver and its setting."""
        return " ".join(filter(None, (self.solver, self.method, self.setting)))


def compared(model: CostModel, run: Measurement, finest: FrequencyResponse) -> RunRow:
    """Row of a run beside the exact motions of the ``finest`` fidelity."""
    setting, plan, response, count = run.setting, run.plan, run.response, len(run)
    total = response.off(finest) if count and not run.failure else Difference()
    return RunRow(
        model.name, model.system.size, setting.solver, setting.method, setting.setting, total, count,
        int(np.count_nonzero(complete(response))), run.seconds / count if count else float("nan"), run.used,
        plan.settle + plan.hold, _why(run, total),
    )  # fmt: skip


def _why(run: Measurement, total: Difference) -> str:
    count, response = len(run), run.response
    if run.failure:
        return run.failure
    if not run.done:
        return f"given up after {run.used:.2g} s, with {count} of {len(response)} frequencies"
    if total.points:
        return ""
    none = np.all(response.ended == Ended.NO_ORBIT.code)
    return Ended.NO_ORBIT.value if none else "no frequency at which both its motion and the reference's repeat"


def front(points: Sequence[tuple[float, float]]) -> list[int]:
    """Pareto front of (error, cost): indices of the points not dominated by any other.

    Points with NaN are never on it. In the order of rising error.
    """
    order = sorted((i for i, point in enumerate(points) if all(map(isfinite, point))), key=lambda i: points[i])
    kept: list[int] = []
    for i in order:
        if not kept or points[i][1] < points[kept[-1]][1]:
            kept.append(i)
    return kept
