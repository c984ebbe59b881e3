"""Joint estimation of keys of a case from measured frequency responses: values, intervals, and what stays open."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.studies.fit.advice import NextPoint, next_points
from vibeam.studies.fit.advice import in_words as advice_in_words
from vibeam.studies.fit.contour import contour_of
from vibeam.studies.fit.estimate import Minimum, estimate, settled
from vibeam.studies.fit.problem import MOTIONS, Problem
from vibeam.studies.fit.profile import BETTER, LEVEL, Profile, covariance, profile
from vibeam.studies.fit.words import on_directions, on_misfit, on_ridges, ridges

if TYPE_CHECKING:
    from vibeam.case.case import Case

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FitRow:
    """Estimated key in SI: ``value``, 95 % interval, linearised ``standard_error``; ``start``: the case's own.

    ``low_open``, ``high_open``: a bound of [fit], the key's or another's, ends the interval; where both are, the data
    do not determine the key and ``value`` is NaN.
    """

    key: str
    value: float
    low: float
    high: float
    unit: str
    standard_error: float
    start: float
    low_open: bool
    high_open: bool

    @property
    def determined(self) -> bool:
        """Whether the data fix the key."""
        return bool(np.isfinite(self.value))


@dataclass(frozen=True)
class FittedPoint:
    """Measured point, its fitted value and residual in standard uncertainties, and the motion that it lies on."""

    reference: str
    fidelity: str
    frequency: float
    measured: float
    uncertainty: float
    fitted: float
    residual: float
    motion: str
    actual: bool


@dataclass(frozen=True)
class FitStudy:
    """Fit of a case: rows, points, sentences; ``contour`` (m, 2) of the pair ``pair`` of least known keys, SI.

    ``covariance`` (P, P): linearised, SI. ``best`` (P,): the minimum itself, whether determined or not. ``next``: what
    to measure next, where it was asked for.
    """

    case: Case
    rows: tuple[FitRow, ...]
    points: tuple[FittedPoint, ...]
    sentences: tuple[str, ...]
    misfit: float
    best: Array
    covariance: Array
    pair: tuple[int, int] | None
    contour: Array
    next: tuple[NextPoint, ...] = ()
    problem: Problem = field(repr=False, kw_only=True)
    minimum: Minimum = field(repr=False, kw_only=True)
    profiles: tuple[Profile, ...] = field(repr=False, kw_only=True)


def fit(case: Case, tell: Callable[[str], None] | None = None, *, next_point: bool = False) -> FitStudy:
    """Estimate the keys of [fit] jointly; ValueError where a case cannot be fitted.

    ``tell``: called with what is being done. ``next_point``: also find what to measure next.
    """
    tell = tell or (lambda _: None)
    problem = Problem.of(case)
    tell(f"Least squares: {problem.count} points, {len(problem.keys)} keys")
    minimum, profiles = _minimum_and_profiles(problem, tell)
    pair = _pair(problem, minimum)
    advised = next_points(case, problem, minimum) if next_point else ()
    rows = tuple(_rows(problem, minimum, profiles))
    sentences = [*problem.notes, *on_misfit(problem, minimum), *on_directions(problem, minimum)]
    sentences += on_ridges(problem, minimum, profiles)
    if next_point:
        unit = next((row.unit for row in rows if advised and row.key == advised[0].key), "")
        sentences.append(advice_in_words(advised, unit))
    return FitStudy(
        case, rows, tuple(_points(problem, minimum)), tuple(sentences), minimum.misfit, problem.values(minimum.x),
        covariance(minimum) * np.outer(problem.width, problem.width), pair,
        contour_of(problem, minimum, pair) if pair else np.empty((0, 2)), advised,
        problem=problem, minimum=minimum, profiles=tuple(profiles),
    )  # fmt: skip


def _minimum_and_profiles(problem: Problem, tell: Callable[[str], None]) -> tuple[Minimum, list[Profile]]:
    """Minimum and profiles; anew, once, from a better minimum that a profile finds."""
    minimum = estimate(problem)
    profiles: list[Profile] = []
    for attempt in range(2):
        tell("Intervals by profile likelihood")
        profiles = [profile(problem, minimum, k) for k in range(len(problem.keys))]
        rows = np.concatenate([each.path for each in profiles])
        lowest = rows[int(np.argmin(rows[:, -1]))]
        if attempt or lowest[-1] > -BETTER:
            break
        better = settled(problem, lowest[:-1])
        if better.misfit >= minimum.misfit:
            break
        minimum = better
    return minimum, profiles


def _pair(problem: Problem, minimum: Minimum) -> tuple[int, int] | None:
    """The least determined pair: of the strongest ridge, or the two widest keys."""
    if len(problem.keys) < 2:
        return None
    found = ridges(problem, minimum)
    if found:
        return found[0]
    first, second = np.argsort(-np.diag(covariance(minimum)))[:2].tolist()
    return first, second


def _rows(problem: Problem, minimum: Minimum, profiles: list[Profile]) -> Iterator[FitRow]:
    from vibeam.studies.identification.modes import unit_of

    values, errors = problem.values(minimum.x), np.sqrt(np.diag(covariance(minimum))) * problem.width
    for k, (each, found) in enumerate(zip(problem.keys, profiles, strict=True)):
        ends = [each.low + share * (each.high - each.low) for share in (found.low, found.high)]
        value = float("nan") if all(found.open) else float(values[k])
        yield FitRow(each.key, value, ends[0], ends[1], unit_of(each.key), float(errors[k]), each.start, *found.open)


def _points(problem: Problem, minimum: Minimum) -> Iterator[FittedPoint]:
    fitted, _ = problem.predicted(minimum.x, minimum.chosen)
    names = [(each.reference, each.fidelity) for each in problem.groups for _ in range(len(each))]
    for j, (reference, fidelity) in enumerate(names):
        measured, uncertainty = float(problem.measured[j]), float(problem.uncertainty[j])
        value = float(fitted[0, j])
        yield FittedPoint(
            reference, fidelity, float(problem.frequency[j]), measured, uncertainty, value,
            (value - measured) / uncertainty, MOTIONS[int(minimum.chosen[j])], bool(minimum.actual[j]),
        )  # fmt: skip


def fitted_case(study: FitStudy) -> Case:
    """The case with the estimated values in place of its own; keys that are not determined keep theirs."""
    from vibeam.casefile.read import parse

    settings = {row.key: row.value for row in study.rows if row.determined}
    return replace(parse(study.case.text, study.case.path, settings), references=study.case.references)


__all__ = ["LEVEL", "FitRow", "FitStudy", "FittedPoint", "fit", "fitted_case"]
