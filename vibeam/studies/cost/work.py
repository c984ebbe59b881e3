"""Work of a run: CPU time over repeats, impacts, evaluations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite
from statistics import median

from vibeam.flight.pause import Clock
from vibeam.studies.cost.measure import Measured


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


def timed(run: Callable[[], Measured], clock: Clock, repeats: int, spend: float) -> tuple[Measured, Work]:
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
