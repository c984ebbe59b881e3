"""Row of one run: errors against the reference and its own fidelity, their parts, and the work."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite
from statistics import median

import numpy as np

from vibeam.flight.engine.threads import Clock
from vibeam.runs.models import Model
from vibeam.studies.cost.error_split import Part, part, shares
from vibeam.studies.cost.measure import Measurement, Plan, Setting
from vibeam.studies.cost.reference import RunErrors, errors
from vibeam.system.response import Ended, complete


@dataclass(frozen=True)
class Work:
    """CPU seconds of a run (least and median of ``repeats``), its drive periods, impacts and evaluations."""

    cpu_min: float
    cpu_median: float
    repeats: int
    periods: int
    impacts: int
    evaluations: int

    @property
    def per_period(self) -> float:
        """CPU seconds a drive period."""
        return self.cpu_min / self.periods if self.periods else float("nan")

    @property
    def per_impact(self) -> float:
        """CPU seconds an impact; NaN without impacts (a closed form computes none)."""
        return self.cpu_min / self.impacts if self.impacts else float("nan")


def timed(run: Callable[[], Measurement], clock: Clock, repeats: int, spend: float) -> tuple[Measurement, Work]:
    """Result of the first ``run``, and its work over as many of the ``repeats`` as ``spend`` seconds allow."""
    found, seconds = None, list[float]()
    while len(seconds) < repeats and (not seconds or sum(seconds) + seconds[-1] <= spend):
        begun = clock()
        again = run()
        seconds.append(clock() - begun)
        found = found or again
    assert found is not None
    counts = found.periods, found.impacts, found.evaluations
    return found, Work(min(seconds), median(seconds), len(seconds), *counts)


def front(points: list[tuple[float, float]]) -> list[int]:
    """Pareto front of (error, cost): indices of the points not dominated by any other.

    Points with NaN are never on it. In the order of rising error.
    """
    order = sorted((i for i, point in enumerate(points) if all(map(isfinite, point))), key=lambda i: points[i])
    kept: list[int] = []
    for i in order:
        if not kept or points[i][1] < points[kept[-1]][1]:
            kept.append(i)
    return kept


PARTS = ("solver", "settling", "modelling", "total")


@dataclass(frozen=True)
class RunRow:
    """One run: ``total`` error against the reference, ``numerical`` against the exact motion of its own fidelity.

    ``parts`` of its amplitude's error, which add up: solver, settling, modelling. ``why``: reason of a
    failure; the errors are then NaN.
    """

    fidelity: str
    modes: int
    solver: str
    method: str
    setting: str
    total: RunErrors
    numerical: RunErrors
    parts: tuple[Part, ...]
    work: Work | None
    found: int = 0  #: frequencies at which it found a motion
    why: str = ""

    @property
    def label(self) -> str:
        """Solver and its setting."""
        return " ".join(filter(None, (self.solver, self.method, self.setting)))


@dataclass(frozen=True)
class References:
    """References of a run: its fidelity's exact motion, settled as long as the run (``short``) and as long as
    needed (``own``), and the reference.
    """

    short: Measurement
    own: Measurement
    reference: Measurement


def stopped(model: Model, setting: Setting, why: str) -> RunRow:
    """Row of a run that did not end."""
    return _row(model, setting, RunErrors(), RunErrors(), (), None, 0, why)


def compared(
    model: Model, setting: Setting, plan: Plan, found: Measurement, work: Work, references: References
) -> RunRow:
    """Row of a run that ended, with or without failed points."""
    motions = int(np.count_nonzero(complete(found.response)))
    if found.failure:
        return _row(model, setting, RunErrors(), RunErrors(), (), work, motions, found.failure)
    total, numerical = (errors(found, truth, plan) for truth in (references.reference, references.own))
    why = "" if total.amplitude.points or np.isfinite(total.statistics) else _nothing(found)
    chain = (found, references.short, references.own, references.reference)
    parts = tuple(part(name, each) for name, each in zip(PARTS, shares([c.response for c in chain]), strict=True))
    return _row(model, setting, total, numerical, parts, work, motions, why)


def _row(
    model: Model, setting: Setting, total: RunErrors, numerical: RunErrors, parts: tuple[Part, ...], work: Work | None,
    motions: int, why: str,
) -> RunRow:  # fmt: skip
    return RunRow(
        model.name, model.system.size, setting.solver, setting.method, setting.setting,
        total, numerical, parts, work, motions, why,
    )  # fmt: skip


def _nothing(found: Measurement) -> str:
    none = np.all(found.response.ended == Ended.NO_ORBIT.code)
    return Ended.NO_ORBIT.value if none else "no frequency at which both its motion and the reference's repeat"
