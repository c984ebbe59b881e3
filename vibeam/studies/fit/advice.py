"""The point to measure next: that which shortens the widest interval most (optimal design by the Jacobian).

With the covariance C of the shares (the bounds as weak priors), a further point with derivatives j and standard
uncertainty σ leaves C − C j jᵀ C/(σ² + jᵀ C j). Candidates are motions that the fitted model has, at frequencies of the
sweep, at half, the same and twice the drive, and at three gaps; their relative uncertainty is the median of what was
measured.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.studies.fit.estimate import Minimum
from vibeam.studies.fit.explanation import actual
from vibeam.studies.fit.points import Points
from vibeam.studies.fit.problem import MOTIONS, Problem, value_of
from vibeam.studies.fit.profile import LEVEL
from vibeam.studies.fit.surface import Forward
from vibeam.studies.identification.modes import unit_of
from vibeam.system.number_text import with_unit
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.case.case import Case


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
