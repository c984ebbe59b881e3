"""Joint estimation of keys of a case from measured frequency responses: values, intervals, and what stays open."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from math import sqrt
from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.source import of_source
from vibeam.store.shares import sharing
from vibeam.studies.fit.estimate import Minimum, Scan, estimate, met, refined
from vibeam.studies.fit.judgement import WIDEST, Judgement, alternatives, patterns, unit_factor, without_outliers
from vibeam.studies.fit.problem import FOLLOWED, LEFT, MOTIONS, Problem, value_of
from vibeam.studies.fit.profile import FitRow, NextPoint, Profile, next_points, profiled
from vibeam.studies.fit.profile import in_words as advice_in_words
from vibeam.studies.fit.words import facts, on_directions, on_misfit, on_ridges
from vibeam.system.labelled import ViewedTable
from vibeam.system.number_text import with_unit
from vibeam.system.progress import telling
from vibeam_models.arguments import counted
from vibeam_models.arrays import Array, ValueRecord

if TYPE_CHECKING:
    from vibeam.case.case import Case

Progress = Callable[[str], None]
MOST = 0.5  # share of the bounds that an interval ended by those of another key may span


@dataclass(frozen=True)
class FittedPoint:
    """Measured point, its fitted value and residual in standard uncertainties, and the motion that it lies on.

    ``left_out``: why it is, empty of one that is not; its fitted value is then that of the model's own motion there, or
    NaN (the motion does not repeat, or the point contradicts all others).
    """

    reference: str
    fidelity: str
    frequency: float
    measured: float
    uncertainty: float
    fitted: float
    residual: float
    motion: str
    actual: bool
    left_out: str = ""


@dataclass(frozen=True, eq=False, repr=False)
class FitStudy(ValueRecord, ViewedTable):
    """Fit of a case: rows, points, sentences, of these the ``facts``; ``shared``: relations that are known of keys
    that make up for each other.

    ``covariance`` (P, P): linearised, SI. ``next``: what to measure next, where it was asked for. ``judgement``:
    whether the model describes the points.
    """

    case: Case
    rows: tuple[FitRow, ...]
    points: tuple[FittedPoint, ...]
    sentences: tuple[str, ...]
    facts: tuple[str, ...]
    shared: tuple[str, ...]
    misfit: float
    covariance: Array
    next: tuple[NextPoint, ...]
    judgement: Judgement
    problem: Problem = field(repr=False, kw_only=True)
    minimum: Minimum = field(repr=False, kw_only=True)
    profiles: tuple[Profile, ...] = field(repr=False, kw_only=True)

    def branch(self, reference: str, motion: str, frequency: Array) -> tuple[Array, Array]:
        """Quantity of a reference (points,) on one motion at ``frequency`` (points,) Hz, and its standard error.

        The latter is linearised. NaN where there is no such motion.
        """
        x, group = self.minimum.x, next(each for each in self.problem.groups if each.reference == reference)
        if motion not in MOTIONS[:LEFT] or not self.problem.forward[group.fidelity].closed:
            numbers = {int(each) - FOLLOWED for each in self.minimum.chosen if each >= FOLLOWED}
            value, by = self.problem.trails.branch(numbers, reference, motion, x, frequency)
            return value, np.sqrt(np.einsum("kp,kl,lp->p", by, self.minimum.covariance, by))
        surface = self.problem.only(group.at(frequency)).about(x).surfaces[group.fidelity]
        found = value_of(group.at(frequency), *surface.with_tangents(x), MOTIONS.index(motion))
        error = np.sqrt(np.einsum("kp,kl,lp->p", found.by, self.minimum.covariance, found.by))
        return np.where(found.beyond == 0, found.value, np.nan), error


@of_source
def fit(case: Case, progress: Progress | bool | None = None, *, next_point: bool = False) -> FitStudy:
    """Estimate the keys of [fit] jointly; ValueError where a case cannot be fitted.

    ``progress``: True shows it, a function is told in lines. ``next_point``: also find what to measure next.

    >>> import vibeam
    >>> asked = {"keys": {"stop.restitution": [0.5, 0.9]}, "references": ["exact"]}
    >>> case = vibeam.load("cases/dtu_neutral.toml", {"fit": asked, "reference.exact.uncertainty": "1 %"})
    >>> [(row.key, round(row.value, 3)) for row in vibeam.fit(case).rows]  # the curve is the case's own
    [('stop.restitution', 0.72)]
    """
    with telling(progress, "fit") as told:
        return _study(case, told, next_point)


def _study(case: Case, tell: Progress, next_point: bool) -> FitStudy:
    whole = Problem.of(case)
    tell(f"Least squares: {counted(whole.count, 'point')}, {counted(len(whole.keys), 'key')}")
    problem, minimum, judgement = _judged(case, whole, tell)
    tell("Intervals by profile likelihood")
    profiles = profiled(problem, minimum, judgement.scale)
    advised = next_points(case, problem, minimum) if next_point else ()
    rows = tuple(_rows(problem, minimum, profiles, judgement))
    sentences = [*on_misfit(problem, minimum, judgement), *problem.notes]
    shared: list[str] = []
    if judgement.described or judgement.scale > 1:
        found = list(on_ridges(problem, minimum, profiles, rows))
        sentences += [*on_directions(problem, minimum), *(each.said for each in found)]
        shared = [each.shared for each in found if each.shared]
    if next_point:
        unit = next((row.unit for row in rows if advised and row.key == advised[0].key), "")
        sentences.append(advice_in_words(case, advised, unit))
    return FitStudy(
        case, rows, tuple(_points(problem, minimum, judgement)), tuple(sentences),
        tuple(facts(problem, minimum, judgement)), tuple(shared), minimum.misfit,
        minimum.covariance * np.outer(problem.width, problem.width), advised, judgement,
        problem=problem, minimum=minimum, profiles=tuple(profiles),
    )  # fmt: skip


def _judged(case: Case, whole: Problem, tell: Progress) -> tuple[Problem, Minimum, Judgement]:
    """Minimum without outliers, and what is said of it; other models are tried where none describes the points."""
    scan = Scan.of(whole)
    problem, minimum = estimate(whole, scan)
    if met(minimum.misfit, minimum.freedom):
        return problem, minimum, Judgement(True, patterns(problem, minimum))
    tell("The model does not describe the points: looking for one that does")
    found, factor = patterns(problem, minimum), unit_factor(whole, scan)
    with sharing(None):  # rounds within rounds
        others = () if factor != 1 else alternatives(case, whole, minimum)
    if factor == 1 and not any(each.met for each in others):
        without, outliers = without_outliers(whole, minimum)
        if outliers:
            problem, minimum = refined(whole, without, tuple(each.index for each in outliers))
            return problem, minimum, Judgement(True, patterns(problem, minimum), outliers)
    scale = sqrt(minimum.misfit / minimum.freedom)
    told = scale > WIDEST or factor != 1 or any(each.met for each in others) or any(each.significant for each in found)
    return problem, minimum, Judgement(False, found, (), factor, others, 1.0 if told else scale)


def _rows(problem: Problem, minimum: Minimum, profiles: list[Profile], judgement: Judgement) -> Iterator[FitRow]:
    values, errors = problem.values(minimum.x), np.sqrt(np.diag(minimum.covariance)) * problem.width
    for k, (each, found) in enumerate(zip(problem.keys, profiles, strict=True)):
        ends = [each.low + share * (each.high - each.low) for share in (found.low, found.high)]
        low, high = (float("nan"), float("nan")) if judgement.withheld else ends
        value = float("nan") if _undetermined(k, found) else float(values[k])
        error = float("nan") if judgement.withheld else judgement.scale * float(errors[k])
        bounds = [_bound(problem, number) for number in found.open]
        yield FitRow(each.key, value, low, high, each.unit, error, each.start, *bounds)


def _undetermined(k: int, found: Profile) -> bool:
    """Test whether bounds make both ends of the interval of key ``k``: its own one of them, or far apart."""
    own = any(number // 2 == k for number in found.open)
    return min(found.open) >= 0 and (own or found.high - found.low > MOST)


def _bound(problem: Problem, number: int) -> str:
    """Bound in words, of which there are two a key; empty where the data end an interval."""
    if number < 0:
        return ""
    key = problem.keys[number // 2]
    return f"{key.key} = {with_unit(key.high if number % 2 else key.low, key.unit)}"


def _points(problem: Problem, minimum: Minimum, judgement: Judgement) -> Iterator[FittedPoint]:
    fitted, _ = problem.predicted(minimum.x, minimum.chosen)
    names = [(each.reference, each.fidelity) for each in problem.groups for _ in range(len(each))]
    dropped = {each.index: each for each in judgement.outliers}
    for j, (reference, fidelity) in enumerate(names):
        measured, uncertainty = float(problem.measured[j]), float(problem.uncertainty[j])
        value, why = float(fitted[0, j]), ""
        if j in minimum.others:
            value, why = minimum.others[j].value, minimum.others[j].called
        elif j in dropped:
            why = "contradicts the other points"
        yield FittedPoint(
            reference, fidelity, float(problem.frequency[j]), measured, uncertainty, value,
            (value - measured) / uncertainty, problem.called(int(minimum.chosen[j])), bool(minimum.actual[j]), why,
        )  # fmt: skip


def estimated_case(study: FitStudy) -> str:
    """Text of the case's file with the estimated values in place of its own; keys that are not determined keep theirs.

    ValueError for a key that the file does not have, in a table written inline.
    """
    from vibeam.casefile.toml import read_text
    from vibeam.casefile.toml_writing import with_values

    rows = [row for row in study.rows if row.determined]
    found = {row.key: f'"{row.value:.6g} {row.unit}"' if row.unit else f"{row.value:.6g}" for row in rows}
    names = dict.fromkeys(point.reference for point in study.points)
    head = (
        f"# {', '.join(found) or 'nothing'}: estimated by vibeam fit from {', '.join(names)} of {study.case.path.name}"
    )
    return f"{head}\n\n{with_values(read_text(study.case.path), found)}"
