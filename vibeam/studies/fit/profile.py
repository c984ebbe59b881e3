"""Intervals of the keys by profile likelihood, the contour of two, and the point to measure next.

The misfit Σ r² at a held value of key k, minimised over the others, less its minimum, is the likelihood-ratio
statistic; its root is linear in the key where the model is (Venzon & Moolgavkar, Appl. Statist. 37 (1988)), so that the
crossing is found by regula falsi on that root. Where the bounds of the case come first the interval is open there: what
lies beyond is not known from the data.

Next is the point that shortens the widest interval most (optimal design by the Jacobian). With the covariance C of the
shares (the bounds as weak priors), a further point with derivatives j and standard uncertainty σ leaves C − C j jᵀ
C/(σ² + jᵀ C j). Candidates are motions that the fitted model has, at frequencies of the sweep, at half, the same and
twice the drive, and at three gaps; their relative uncertainty is the median of what was measured.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.studies.fit.estimate import Minimum, minimise
from vibeam.studies.fit.explanation import actual
from vibeam.studies.fit.points import Points
from vibeam.studies.fit.problem import MOTIONS, Problem, value_of
from vibeam.studies.fit.surface import Forward
from vibeam.studies.identification.modes import unit_of
from vibeam.system.number_text import with_unit
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.case.case import Case

LEVEL = 3.841458820694124  # χ² of one degree of freedom, 95 %
TRIES = 24
NEAR = 0.01  # of the root's height, where the crossing is found
BOUND = 1e-3  # share of the bounds within which a key is at one
STRETCH = 3.0  # of the distance from the minimum, in one step outward
NEARLY = 0.05  # share of the bounds within which a bound is tried itself
ENOUGH = 1e-4  # relative tolerance of a misfit whose rise is looked at


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


LEVELS = ("voltage", "amplitude", "velocity", "acceleration", "force")
FACTORS = (0.5, 1.0, 2.0)  # of the drive
MOST = 25  # frequencies
BEST = 5  # candidates told


@dataclass(frozen=True)
class NextPoint:
    """Candidate: ``frequency`` Hz, ``settings`` of the drive and the gap, kind of ``motion``, predicted ``value``.

    ``before``, ``after``: half-widths of the 95 % interval of ``key``, SI, linearised.
    """

    key: str
    frequency: float
    settings: dict[str, float]
    motion: str
    fidelity: str
    value: float
    before: float
    after: float


def next_points(case: Case, problem: Problem, minimum: Minimum) -> tuple[NextPoint, ...]:
    """Best candidates for the key with the widest interval, one a setting, the best first."""
    spread = minimum.covariance
    target = int(np.argmax(np.diag(spread)))
    group = problem.groups[0]
    grid = case.sweep.frequency
    frequency = grid[np.unique(np.linspace(0, len(grid) - 1, min(len(grid), MOST)).round().astype(int))]
    found: list[NextPoint] = []
    for settings, forward in _variants(problem, minimum, group):
        found += _candidates(problem, minimum, (group, frequency), (settings, forward), (spread, target))
    found.sort(key=lambda each: each.after)
    distinct: dict[tuple[Any, ...], NextPoint] = {}
    for each in found:
        distinct.setdefault(tuple(each.settings.values()), each)
    return tuple(list(distinct.values())[:BEST])


def _variants(problem: Problem, minimum: Minimum, group: Points) -> Iterator[tuple[dict[str, float], Forward]]:
    forward, values = problem.forward[group.fidelity], problem.values(minimum.x)
    names = [name for name in LEVELS if isinstance(forward.model.value(f"drive.{name}"), float)]
    largest = float(np.max(np.abs(problem.measured))) if group.quantity != "impact_velocity" else 0.0
    shift = float(f"{largest / 4:.1g}") if largest > 0 else 0.0
    gap = _current(forward, values, "stop.gap")
    for factor in FACTORS if names else (1.0,):
        settings, changed = {}, forward
        if names:
            key = f"drive.{names[0]}"
            settings[key] = factor * _current(forward, values, key)
            changed = _moved(changed, key, settings[key], values)
        for off in dict.fromkeys((-shift, 0.0, shift)):
            yield {**settings, "stop.gap": gap + off}, _moved(changed, "stop.gap", gap + off, values)


def _current(forward: Forward, values: Array, key: str) -> float:
    for k, each in enumerate(forward.keys):
        if each.key == key and forward.changed[k]:
            return float(values[k])
    return float(forward.model.value(key))


def _moved(forward: Forward, key: str, value: float, values: Array) -> Forward:
    """Forward model with a key at another value; an estimated one is still varied, about that value."""
    for k, each in enumerate(forward.keys):
        if each.key == key and forward.changed[k]:
            offsets = list(forward.offsets)
            offsets[k] += value - float(values[k])
            return replace(forward, offsets=tuple(offsets))
    return replace(forward, model=forward.model.at({key: value}))


def _candidates(
    problem: Problem, minimum: Minimum, where: tuple[Points, Array], variant: tuple[dict[str, float], Forward],
    known: tuple[Array, int],
) -> Iterator[NextPoint]:  # fmt: skip
    (group, frequency), (settings, forward), (spread, target) = where, variant, known
    asked = replace(group.at(frequency), periods=1)
    try:
        own = problem.only(asked, forward).about(minimum.x)
        _, beyond = own.motions(minimum.x)
        allowed = actual(own, minimum.x, beyond)
        data, tangents = own.surfaces[group.fidelity].with_tangents(minimum.x)
    except ValueError:
        return
    relative = float(np.median(problem.uncertainty / np.abs(problem.measured)))
    for motion in range(3):
        found = value_of(asked, data, tangents, motion)
        for j in np.flatnonzero(allowed[motion] & np.isfinite(found.value) & (np.abs(found.value) > 0)).tolist():
            slope = found.by[:, j]
            after = _after(spread, slope, relative * abs(found.value[j]))[target]
            half = np.sqrt(LEVEL * np.array([spread[target, target], after])) * problem.width[target]
            yield NextPoint(
                problem.keys[target].key, float(frequency[j]), settings, MOTIONS[motion], group.fidelity,
                float(found.value[j]), float(half[0]), float(half[1]),
            )  # fmt: skip


def _after(spread: Array, slope: Array, uncertainty: float) -> Array:
    """Variances (P,) with one further point."""
    seen = spread @ slope
    return np.asarray(np.diag(spread) - seen**2 / (uncertainty**2 + slope @ seen))


def in_words(best: Sequence[NextPoint], unit: str) -> str:
    """Sentence on what to measure next."""
    if not best:
        return "Next: the fitted model has no motion at the sweep's frequencies."
    first = best[0]
    settings = ", ".join(f"{key} = {with_unit(value, unit_of(key))}" for key, value in first.settings.items())
    return (
        f"Next: {first.frequency:.5g} Hz at {settings} ({first.motion}): the interval of {first.key} would go from "
        f"± {with_unit(first.before, unit, 3)} to ± {with_unit(first.after, unit, 3)}."
    )
