"""Contour of two keys: where the misfit, least over the others, has risen by χ²₂(95 %)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.studies.fit.estimate import Minimum, minimise
from vibeam.studies.fit.problem import Problem
from vibeam.studies.fit.profile import ENOUGH

Array = NDArray[np.float64]

LEVEL = 5.991464547107979  # χ² of two degrees of freedom, 95 %

RAYS = 16

TRIES = 4

NEAR = 0.05


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
    middle, target = minimum.x[at], float(np.sqrt(LEVEL))
    with np.errstate(divide="ignore"):
        room = np.where(ray > 0, (1 - middle) / ray, np.where(ray < 0, -middle / ray, np.inf))
    most = float(room.min())
    inside, outside, radius = (0.0, 0.0), (most, np.inf), min(target, most)
    for _ in range(TRIES):
        pair = np.clip(middle + radius * ray, 0.0, 1.0)
        fixed = dict(zip(at, pair.tolist(), strict=True))
        start = np.clip(minimum.x + along @ (pair - middle), 0.0, 1.0)
        _, misfit = minimise(problem, start, minimum.chosen, fixed, tolerance=ENOUGH)
        height = float(np.sqrt(max(misfit - minimum.misfit, 0.0)))
        if abs(height - target) < NEAR * target or (height < target and radius == most):
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
