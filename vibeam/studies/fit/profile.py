"""Profile likelihood: the interval of one key, and the contour of two, in which the least misfit rises by χ²(95 %).

The misfit Σ r² at a held value of key k, minimised over the others, less its minimum, is the likelihood-ratio
statistic; its root is linear in the key where the model is (Venzon & Moolgavkar, Appl. Statist. 37 (1988)), so that the
crossing is found by regula falsi on that root. Where the bounds of the case come first the interval is open there: what
lies beyond is not known from the data.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from vibeam.studies.fit.estimate import Minimum, minimise
from vibeam.studies.fit.problem import Problem
from vibeam_models.arrays import Array

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
    """Test whether another key is at its bound, so that it is that bound which ends the interval."""
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


LEVEL_OF_TWO = 5.991464547107979  # χ² of two degrees of freedom, 95 %
RAYS = 16
TRIES_OF_TWO = 4
NEAR_OF_TWO = 0.05


def contour_of(problem: Problem, minimum: Minimum, pair: tuple[int, int]) -> Array:
    """Closed contour (rays + 1, 2) in SI, cut off at the bounds; rays are even in the linearised ellipse."""
    at = list(pair)
    shape = np.linalg.cholesky(minimum.covariance[np.ix_(at, at)])
    angles = np.linspace(0.0, 2 * np.pi, RAYS, endpoint=False)
    spread = minimum.covariance
    along = spread[:, at] @ np.linalg.inv(spread[np.ix_(at, at)])  # the other keys' best, linearised
    found = [_radius(problem, minimum, at, shape @ [np.cos(each), np.sin(each)], along) for each in angles]
    shares = np.array([*found, found[0]])
    return np.asarray(problem.low[at] + shares * problem.width[at])


def _radius(problem: Problem, minimum: Minimum, at: list[int], ray: Array, along: Array) -> Array:
    """Shares of the pair where a ray from the minimum crosses the contour, or leaves the bounds."""
    middle, target = minimum.x[at], float(np.sqrt(LEVEL_OF_TWO))
    with np.errstate(divide="ignore"):
        room = np.where(ray > 0, (1 - middle) / ray, np.where(ray < 0, -middle / ray, np.inf))
    most = float(room.min())
    inside, outside, radius = (0.0, 0.0), (most, np.inf), min(target, most)
    for _ in range(TRIES_OF_TWO):
        pair = np.clip(middle + radius * ray, 0.0, 1.0)
        fixed = dict(zip(at, pair.tolist(), strict=True))
        start = np.clip(minimum.x + along @ (pair - middle), 0.0, 1.0)
        _, misfit = minimise(problem, start, minimum.chosen, fixed, tolerance=ENOUGH)
        height = float(np.sqrt(max(misfit - minimum.misfit, 0.0)))
        if abs(height - target) < NEAR_OF_TWO * target or (height < target and radius == most):
            break
        if height < target:
            inside = (radius, height)
        else:
            outside = (radius, height)
        radius = _between(inside, outside, target, most)
    return np.asarray(np.clip(middle + radius * ray, 0.0, 1.0))


def _between(inside: tuple[float, float], outside: tuple[float, float], target: float, most: float) -> float:
    if not np.isfinite(outside[1]):
        return min(most, inside[0] * min(target / max(inside[1], 0.2 * target), 3.0))
    if outside[1] > 1e3 * target:
        return (inside[0] + outside[0]) / 2
    share = (target - inside[1]) / (outside[1] - inside[1])
    return inside[0] + min(max(share, 0.1), 0.9) * (outside[0] - inside[0])
