"""Row of one run: errors against the reference and its own fidelity, the work; split of the error.

The split is that of a chain of models from one fidelity to the finest, one change at each link. The difference of the
ends is the sum of the links' differences, point by point and so in the mean:

    a − a_finest = Σ (a_i − a_{i+1}).

The links are: the contact law (R does not carry over between models: the fidelity takes the R that gives its first mode
the R₁ of the finest), the reduction (the finest's, with that same R₁), the effects left out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import isfinite
from statistics import median
from typing import Any

import numpy as np

from vibeam.flight.engine.threads import Clock
from vibeam.studies.cost.measure import Measurement, Plan, Setting
from vibeam.studies.cost.planning import CostModel, first_mode_restitution_of
from vibeam.studies.cost.reference import RunErrors, errors
from vibeam.system.response import Ended, FrequencyResponse, complete, periodic
from vibeam_models.arrays import Array

LINKS = ("contact law", "reduction", "effects left out", "finest fidelity itself")  # last link, to a reference file


@dataclass(frozen=True)
class Part:
    """Contribution of one link to the amplitude's error, over the finest's amplitude.

    Signed are ``mean``, ``lowest``, ``highest`` and ``peak``, the value at the finest's peak, NaN where not all of the
    chain repeats there; means and values at the peak add up. ``worst``: the largest, without its sign. ``note``: reason
    for missing numbers (NaN); the next link then holds both contributions.
    """

    name: str
    mean: float = np.nan
    rms: float = np.nan
    worst: float = np.nan
    note: str = ""
    lowest: float = np.nan
    highest: float = np.nan
    peak: float = np.nan


@dataclass(frozen=True)
class Split:
    """Exact error of a fidelity against the finest and its parts, over ``points`` at which the whole chain is periodic.

    ``restitution``: of its first mode. ``cpu``: seconds of its exact run.
    """

    fidelity: str
    modes: int
    restitution: float
    total: Part
    parts: tuple[Part, ...]
    points: int
    cpu: float


@dataclass(frozen=True)
class LinkShare:
    """Relative difference in amplitude over a link, (points,), and ``at_peak`` of the last curve (NaN: not there)."""

    values: Array
    at_peak: float


def shares(chain: Sequence[FrequencyResponse]) -> list[LinkShare]:
    """Shares of each link and, last, of the chain, over the points where all are periodic."""
    last = chain[-1]
    where = np.logical_and.reduce([periodic(each) for each in chain]) & (last.amplitude > 0)
    top = last.peak.point if last.peak.point >= 0 and where[last.peak.point] else None
    steps = [np.divide(each.amplitude, last.amplitude, out=np.full(len(last), np.nan), where=where) for each in chain]
    pairs = [*pairwise(steps), (steps[0], steps[-1])]
    return [
        LinkShare((one - other)[where], np.nan if top is None else float((one - other)[top])) for one, other in pairs
    ]


def part(name: str, found: LinkShare) -> Part:
    """Part from the share of one link."""
    values = found.values
    if not len(values):
        return Part(name, note="no point where all of the chain repeats")
    low, high = float(np.min(values)), float(np.max(values))
    mean, rms = float(np.mean(values)), float(np.sqrt(np.mean(values**2)))
    return Part(name, mean, rms, max(abs(low), abs(high)), lowest=low, highest=high, peak=found.at_peak)


def split(model: CostModel, chain: Sequence[FrequencyResponse], why: str, cpu: float) -> Split:
    """Split of the error of ``model`` over the ``chain`` of responses; ``why`` the first link has no part."""
    *steps, whole = shares(chain)
    parts = [part(name, each) for name, each in zip(LINKS, steps, strict=False)]
    parts[0] = Part(LINKS[0], note=why) if why else parts[0]
    seen, total = first_mode_restitution_of(model.system), part("total", whole)
    return Split(model.name, model.system.size, seen, total, tuple(parts), len(whole.values), cpu)


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


@dataclass(frozen=True)
class RunRow:
    """One run: ``total`` error against the reference, ``numerical`` against the exact motion of its own fidelity.

    ``why``: reason of a failure; the errors are then NaN.
    """

    fidelity: str
    modes: int
    solver: str
    method: str
    setting: str
    total: RunErrors = field(default_factory=RunErrors)
    numerical: RunErrors = field(default_factory=RunErrors)
    work: Work | None = None
    found: int = 0  #: frequencies at which it found a motion
    why: str = ""

    @property
    def label(self) -> str:
        """Solver and its setting."""
        return " ".join(filter(None, (self.solver, self.method, self.setting)))


def run_row(model: CostModel, setting: Setting, **found: Any) -> RunRow:
    """Row of a run by what was ``found``; without any it did not end."""
    return RunRow(model.name, model.system.size, setting.solver, setting.method, setting.setting, **found)


def compared(
    model: CostModel, setting: Setting, plan: Plan, found: Measurement, work: Work, truths: Sequence[Measurement]
) -> RunRow:
    """Row of a run that ended, with or without failed points.

    ``truths``: its fidelity's exact motion, the reference.
    """
    motions = int(np.count_nonzero(complete(found.response)))
    if found.failure:
        return run_row(model, setting, work=work, found=motions, why=found.failure)
    numerical, total = (errors(found, truth, plan) for truth in truths)
    why = "" if total.amplitude.points or np.isfinite(total.statistics) else _nothing(found)
    return run_row(model, setting, total=total, numerical=numerical, work=work, found=motions, why=why)


def _nothing(found: Measurement) -> str:
    none = np.all(found.response.ended == Ended.NO_ORBIT.code)
    return Ended.NO_ORBIT.value if none else "no frequency at which both its motion and the reference's repeat"
