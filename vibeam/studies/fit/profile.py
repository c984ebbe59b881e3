"""Intervals of the keys by profile likelihood, and the point to measure next.

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

from vibeam.store.blocks import Values
from vibeam.store.shares import evaluate_each
from vibeam.studies.fit.estimate import Minimum, minimise
from vibeam.studies.fit.explanation import actual, other_motions
from vibeam.studies.fit.points import Points
from vibeam.studies.fit.problem import MOTIONS, Problem, value_of
from vibeam.studies.fit.surface import Forward
from vibeam.system.curves import evenly
from vibeam.system.number_text import with_unit
from vibeam_models.arrays import Array, Index

if TYPE_CHECKING:
    from vibeam.case.case import Case

LEVEL = 3.841458820694124  # χ² of one degree of freedom, 95 %
TRIES = 24  # for a crossing
NEAR = 0.01  # of the root's height, where the crossing is found
BOUND = 1e-3  # share of the bounds within which a key is at one
STRETCH = 3.0  # of the distance from the minimum, in one step outward
NEARLY = 0.05  # share of the bounds within which a bound is tried itself
ENOUGH = 1e-4  # relative tolerance of a misfit whose rise is looked at


@dataclass(frozen=True)
class Profile:
    """Interval of one key as shares of its bounds; ``open``: the bound that ends it below, above, −1 where the data do.

    Bound 2k is the lower one of key k, 2k + 1 its upper one.
    ``path`` (m, P + 1): shares of all keys along the profile, and the rise of the misfit, ascending in the key.
    """

    low: float
    high: float
    open: tuple[int, int]
    path: Array = field(repr=False)


@dataclass(frozen=True)
class FitRow:
    """Estimated key in SI: ``value``, 95 % interval, linearised ``standard_error``; ``start``: the case's own.

    ``low_bound``, ``high_bound``: bound of [fit] that ends the interval, as key = value; empty where the data do. Where
    no end is the data's and the key's own bounds make one, or the interval spans most of them, the data do not
    determine the key and ``value`` is NaN. An interval that is withheld is NaN (``FitStudy.judgement``).
    """

    key: str
    value: float
    low: float
    high: float
    unit: str
    standard_error: float
    start: float
    low_bound: str
    high_bound: str

    @property
    def determined(self) -> bool:
        """Test whether the data fix the key."""
        return bool(np.isfinite(self.value))

    def ends(self, between: str) -> str:
        """Ends of the interval in words, each with the bound that makes it."""
        low, high = (with_unit(end, self.unit) for end in (self.low, self.high))
        if self.low_bound == self.high_bound != "":
            return f"{low}{between}{high}, both{self._by(self.low_bound)}"
        return f"{low}{self._by(self.low_bound)}{between}{high}{self._by(self.high_bound)}"

    def _by(self, bound: str) -> str:
        return "" if not bound else " by its bound" if bound.startswith(f"{self.key} = ") else f" by the bound {bound}"


def profile(problem: Problem, minimum: Minimum, k: int, scale: float = 1.0) -> Profile:
    """Profile of key ``k``; ``scale``: factor on all uncertainties."""
    away = minimum.covariance[:, k] / np.sqrt(minimum.covariance[k, k])
    search = ProfileSearch(scale * float(np.sqrt(LEVEL)))
    (low, below, before), (high, above, after) = (
        search.along(problem, minimum, side * away, k) for side in (-1.0, 1.0)
    )
    path = np.array(sorted([np.append(minimum.x, 0.0), *before, *after], key=lambda row: float(row[k])))
    return Profile(float(low[k]), float(high[k]), (below, above), path)


def profiled(problem: Problem, minimum: Minimum, scale: float) -> list[Profile]:
    """Profiles of all keys, each with trails of its own: what one finds another does not hang on."""
    found: dict[int, Profile] = {}

    def along(k: int) -> Values:
        made = profile(replace(problem, trails=problem.trails.apart()), minimum, k, scale)
        return {"ends": np.array([made.low, made.high]), "open": np.array(made.open), "path": made.path}

    def keep(k: int, made: Values) -> None:
        (low, high), (before, after) = made["ends"].tolist(), made["open"].tolist()
        found[k] = Profile(low, high, (before, after), made["path"])

    of = f"{problem.key} {minimum.x.tobytes()!r} {minimum.chosen.tobytes()!r} {scale!r}"
    evaluate_each("profiles", of, range(len(problem.keys)), along, keep, workers=1)
    return [found[k] for k in range(len(problem.keys))]


@dataclass(frozen=True)
class ProfileSearch:
    """Search for where the root of the misfit's rise is ``target``."""

    target: float

    def along(self, problem: Problem, minimum: Minimum, away: Array, k: int) -> tuple[Array, int, list[Array]]:
        """Shares (P,) at the crossing, the bound that comes first or −1, rows of the path: shares, rise of the misfit.

        From the minimum on in the direction ``away`` (P,) that raises the linearised root as fast as the distance, key
        ``k`` on that line, the others at their best.
        """
        ray, middle, rows = float(away[k]), float(minimum.x[k]), list[Array]()
        most, distance = ((1 - middle) / ray if ray > 0 else -middle / ray if ray < 0 else np.inf), self.target
        inside: tuple[float, float, Array] = (0.0, 0.0, minimum.x)
        outside: tuple[float, float] | None = None
        for _ in range(TRIES):
            distance = min(distance, most)
            x = np.clip(inside[2] + (distance - inside[0]) * away, 0.0, 1.0)
            fixed = {k: min(max(middle + distance * ray, 0.0), 1.0)}
            x, misfit = _least(problem, x, minimum.chosen, fixed)
            height = float(np.sqrt(max(misfit - minimum.misfit, 0.0)))
            if height <= 4 * self.target:
                rows.append(np.append(x, misfit - minimum.misfit))
            if abs(height - self.target) < NEAR * self.target:
                break
            if height < self.target and distance == most:
                return x, 2 * k + (ray > 0), rows
            inside, outside = ((distance, height, x), outside) if height < self.target else (inside, (distance, height))
            distance = self._next(inside[:2], outside, most, NEARLY / abs(ray))
        room = np.stack([x, 1 - x], axis=1)
        room[k] = np.inf
        return x, int(np.argmin(room)) if room.min() < BOUND else -1, rows

    def _next(
        self, inside: tuple[float, float], outside: tuple[float, float] | None, most: float, nearly: float
    ) -> float:
        """Next distance: by the secant between inside and outside, or from the minimum on and a little beyond, to the
        bound, which is tried itself where it is ``nearly`` reached."""
        if outside is None:
            further = inside[0] * min(1.1 * self.target / max(inside[1], 1e-3 * self.target), STRETCH)
            return most if further > most - nearly else further
        if outside[1] > 1e3 * self.target:
            return (inside[0] + outside[0]) / 2
        share = (self.target - inside[1]) / (outside[1] - inside[1])
        return inside[0] + (share if 0.1 < share < 0.9 else 0.5) * (outside[0] - inside[0])


def _least(problem: Problem, x: Array, chosen: Index, fixed: dict[int, float]) -> tuple[Array, float]:
    """Least misfit over the keys that are not ``fixed``; also from within, as one at a bound may be another minimum."""
    found = minimise(problem, x, chosen, fixed, tolerance=ENOUGH)
    ended = [j for j, share in enumerate(found[0].tolist()) if j not in fixed and min(share, 1 - share) < BOUND]
    if not ended:
        return found
    within = found[0].copy()
    within[ended] = 0.5
    return min(found, minimise(problem, within, chosen, fixed, tolerance=ENOUGH), key=lambda each: each[1])


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
    frequency = grid[evenly(0, len(grid) - 1, MOST)]
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


def _place(forward: Forward, key: str) -> int | None:
    """Place of a key that is estimated and changes the model; None of any other."""
    return next((k for k, each in enumerate(forward.keys) if each.key == key and forward.changed[k]), None)


def _current(forward: Forward, values: Array, key: str) -> float:
    k = _place(forward, key)
    return float(forward.model.value(key) if k is None else values[k])


def _moved(forward: Forward, key: str, value: float, values: Array) -> Forward:
    """Forward model with a key at another value; an estimated one is still varied, about that value."""
    k, offsets = _place(forward, key), list(forward.offsets)
    if k is None:
        return replace(forward, model=forward.model.at({key: value}))
    offsets[k] += value - float(values[k])
    return replace(forward, offsets=tuple(offsets))


def _candidates(
    problem: Problem, minimum: Minimum, where: tuple[Points, Array], variant: tuple[dict[str, float], Forward],
    known: tuple[Array, int],
) -> Iterator[NextPoint]:  # fmt: skip
    (group, frequency), (settings, forward), (spread, target) = where, variant, known
    asked = replace(group.at(frequency), periods=1, several=False)
    relative = float(np.median(problem.uncertainty / np.abs(problem.measured)))
    try:
        motions = list(_motions(problem.only(asked, forward), minimum.x))
    except ValueError:
        return
    for j, called, value, slope in motions:
        after = _after(spread, slope, relative * abs(value))[target]
        half = np.sqrt(LEVEL * np.array([spread[target, target], after])) * problem.width[target]
        yield NextPoint(
            problem.keys[target].key, float(frequency[j]), settings, called, group.fidelity, value, float(half[0]),
            float(half[1]),
        )  # fmt: skip


def _motions(problem: Problem, x: Array) -> Iterator[tuple[int, str, float, Array]]:
    """Motions that the model of one group has, with derivatives: point, the motion in words, value, derivatives."""
    (group,) = problem.groups
    if not problem.forward[group.fidelity].closed:
        for j, others in other_motions(problem, x, np.arange(len(group))).items():
            for number in {each.number for each in others if each.number is not None}:
                orbit = problem.trails.every[number].at(x)
                if orbit.differentiable and orbit.by is not None:
                    yield j, orbit.called, orbit.value, orbit.by
        return
    own = problem.about(x)
    allowed = actual(own, x, own.motions(x)[1])
    data, tangents = own.surfaces[group.fidelity].with_tangents(x)
    for motion in range(3):
        found = value_of(group, data, tangents, motion)
        for j in np.flatnonzero(allowed[motion] & np.isfinite(found.value) & (np.abs(found.value) > 0)).tolist():
            yield j, MOTIONS[motion], float(found.value[j]), found.by[:, j]


def _after(spread: Array, slope: Array, uncertainty: float) -> Array:
    """Variances (P,) with one further point."""
    seen = spread @ slope
    return np.asarray(np.diag(spread) - seen**2 / (uncertainty**2 + slope @ seen))


def in_words(case: Case, best: Sequence[NextPoint], unit: str) -> str:
    """Sentence on what to measure next."""
    if not best:
        return "Next: the fitted model has no motion at the sweep's frequencies."
    first = best[0]
    settings = ", ".join(f"{key} = {with_unit(value, case.keys.unit(key))}" for key, value in first.settings.items())
    return (
        f"Next: {first.frequency:.5g} Hz at {settings} ({first.motion}): the interval of {first.key} would go from "
        f"± {with_unit(first.before, unit, 3)} to ± {with_unit(first.after, unit, 3)}."
    )
