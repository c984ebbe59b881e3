"""Intervals by profile likelihood: the range of one key in which the least misfit rises by no more than χ²₁(95 %).

The misfit Σ r² at a held value of key k, minimised over the others, less its minimum, is the likelihood-ratio
statistic; its root is linear in the key where the model is (Venzon & Moolgavkar, Appl. Statist. 37 (1988)), so that the
crossing is found by regula falsi on that root. Where the bounds of the case come first the interval is open there: what
lies beyond is not known from the data.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vibeam.studies.fit.estimate import Minimum, minimise
from vibeam.studies.fit.problem import Problem

Array = NDArray[np.float64]

LEVEL = 3.841458820694124  # χ² of one degree of freedom, 95 %

TRIES = 24

NEAR = 0.01  # of the root's height, where the crossing is found

BOUND = 1e-3  # share of the bounds within which a key is at one

STRETCH = 3.0  # of the distance from the minimum, in one step outward

NEARLY = 0.05  # share of the bounds within which a bound is tried itself

ENOUGH = 1e-4  # relative tolerance of a misfit whose rise is looked at

BETTER = 1e-3  # decrease of the misfit that is another minimum


@dataclass(frozen=True)
class Profile:
    """Interval of one key as shares of its bounds; ``open``: the lower, upper end is that of a bound, its own or
    another key's, not the data's.

    ``path`` (m, P + 1): shares of all keys along the profile, and the rise of the misfit, ascending in the key.
    """

    low: float
    high: float
    open: tuple[bool, bool]
    path: Array = field(repr=False)

    @property
    def width(self) -> float:
        """Width, share of the bounds."""
        return self.high - self.low


def profile(problem: Problem, minimum: Minimum, k: int, scale: float = 1.0) -> Profile:
    """Profile of key ``k``; ``scale``: factor on all uncertainties."""
    rows = [np.append(minimum.x, 0.0)]
    ends, opened = [], []
    for side in (-1.0, 1.0):
        end, is_open = _end(problem, minimum, k, side, rows, scale)
        ends.append(end)
        opened.append(is_open)
    path = np.array(sorted(rows, key=lambda row: float(row[k])))
    return Profile(ends[0], ends[1], (opened[0], opened[1]), path)


def _end(
    problem: Problem, minimum: Minimum, k: int, side: float, rows: list[Array], scale: float
) -> tuple[float, bool]:
    """End of the interval on one side, and whether it is the bound."""
    spread, target = minimum.covariance, scale * float(np.sqrt(LEVEL))
    along = spread[:, k] / spread[k, k]
    bound, inside, outside = (1.0 if side > 0 else 0.0), (float(minimum.x[k]), 0.0, minimum.x), None
    at = inside[0] + side * target * float(np.sqrt(spread[k, k]))
    for _ in range(TRIES):
        at = min(max(at, 0.0), 1.0)
        start = np.clip(inside[2] + along * (at - inside[0]), 0.0, 1.0)
        x, misfit = minimise(problem, start, minimum.chosen, {k: at}, tolerance=ENOUGH)
        height = float(np.sqrt(max(misfit - minimum.misfit, 0.0)))
        if height <= 4 * target:
            rows.append(np.append(x, misfit - minimum.misfit))
        if abs(height - target) < NEAR * target:
            return at, _at_bounds(x, k)
        if height < target:
            if at == bound:
                return bound, True
            inside = (at, height, x)
        else:
            outside = (at, height)
        at = _next(inside, outside, bound, target, float(minimum.x[k]))
    return at, _at_bounds(inside[2], k)


def _at_bounds(x: Array, k: int) -> bool:
    """Whether another key is at its bound, so that it is that bound which ends the interval."""
    return bool(np.any(np.delete(np.minimum(x, 1 - x), k) < BOUND))


def _next(
    inside: tuple[float, float, Array], outside: tuple[float, float] | None, bound: float, target: float, origin: float
) -> float:
    """Next value: by the secant between inside and outside, or from the minimum on and a little beyond, to the bound.

    A bound that is nearly reached is tried itself.
    """
    if outside is None:
        stretch = min(1.1 * target / max(inside[1], 1e-3 * target), STRETCH)
        further = origin + stretch * (inside[0] - origin)
        return bound if (further - bound) * (bound - origin) > 0 or abs(further - bound) < NEARLY else further
    if outside[1] > 1e3 * target:
        return (inside[0] + outside[0]) / 2
    share = (target - inside[1]) / (outside[1] - inside[1])
    return inside[0] + (share if 0.1 < share < 0.9 else 0.5) * (outside[0] - inside[0])


def misfit_at(problem: Problem, minimum: Minimum, k: int, share: float) -> float:
    """Rise of the least misfit where key ``k`` is held at a share of its bounds."""
    spread = minimum.covariance
    start = np.clip(minimum.x + spread[:, k] / spread[k, k] * (share - minimum.x[k]), 0.0, 1.0)
    return minimise(problem, start, minimum.chosen, {k: share})[1] - minimum.misfit
