"""Judgement of a misfit: whether the model describes the points, and what would where it does not.

**Misfit.** χ² of n − P degrees of freedom; below a probability of 1 % the model does not describe the points.

**Pattern.** With the Jacobian J and residuals r in standard uncertainties, a further parameter with derivatives z would
lower χ² by (z⊥·r)²/|z⊥|², z⊥ = z less its projection on J, its value being −z⊥·r/|z⊥|²: the added-variable test, or
Rao's score test (Proc. Camb. Phil. Soc. 44 (1948)), with F = Δχ²/((χ² − Δχ²)/(n − P − 1)) of 1 and n − P − 1 degrees
of freedom, so that it asks for no known scale of the noise. Tried are a restitution that changes with ln v, a factor on
all values, one that changes with frequency, one that changes with the value, and a shift of all frequencies;
probabilities are times their number (Bonferroni).

**Outlier.** Of the points the one is tried that is furthest off under Cauchy's loss. Its deletion residual is
t = (y − ŷ₍ⱼ₎)/√(σ² + var ŷ₍ⱼ₎), with ŷ₍ⱼ₎ from all other points (Cook & Weisberg, Residuals and Influence, 1982,
§2.2.2), its probability n erfc(|t|/√2). Points are outliers where each is below 1 %, the rest is described, they lower
χ² by more than any pattern does, no two are neighbours that are off on the same side, and no other model that is tried
describes all points.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations
from math import erfc, log, sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.exchange.faults import CaseError
from vibeam.periodic.tangents import Tangents
from vibeam.studies.fit.estimate import UNLIKELY, Minimum, Scan, best, met, minimise, settled
from vibeam.studies.fit.problem import LEFT, NO_CONTACT, Problem, value_of
from vibeam_models.arrays import Array
from vibeam_reductions.declaration import REDUCTIONS

if TYPE_CHECKING:
    from vibeam.case.case import Case

UNITS = (1e3, 1e-3, 1e6, 1e-6)  # factors that a wrong unit makes
CLEAR = 0.5  # share of the loss that a factor must leave at most
MODES = 8
STARTS = 3  # of another model


@dataclass(frozen=True)
class Alternative:
    """Other model, in words, and its misfit of so many degrees of freedom."""

    called: str
    misfit: float
    freedom: int

    @property
    def met(self) -> bool:
        """Test whether it describes the points."""
        return met(self.misfit, self.freedom)


def unit_factor(problem: Problem, scan: Scan) -> float:
    """Factor on the measured values, a power of 1000, with which the model comes much nearer to them; 1: none."""
    here = float(scan.losses(problem).min())
    found = {factor: float(scan.losses(problem, factor).min()) for factor in UNITS}
    factor = min(found, key=lambda each: found[each])
    return factor if found[factor] < CLEAR * here else 1.0


def alternatives(case: Case, problem: Problem, minimum: Minimum) -> tuple[Alternative, ...]:
    """Models with one thing changed, those that describe the points first."""
    found = []
    for called, settings in _changes(case, problem):
        try:
            made = Problem.of(replace(case.with_keys(settings), fit=case.fit))
        except (CaseError, ValueError):
            continue
        scan = Scan.of(made)
        order = np.argsort(scan.losses(made), kind="stable")[:STARTS]
        reached = best([settled(made, x) for x in (minimum.x, *scan.x[order])])
        found.append(Alternative(called, reached.misfit, reached.freedom))
    return tuple(sorted(found, key=lambda each: (not each.met, each.misfit)))


def _changes(case: Case, problem: Problem) -> Iterator[tuple[str, dict[str, Any]]]:
    """Changes in words, with their settings: conventions of numbers that are held, and the number of modes."""
    model = next(iter(problem.forward.values())).model
    estimated = [each.key for each in problem.keys]
    for number, words in (("gap", ("contact", "sensor")), ("restitution", ("contact", "first mode"))):
        key = "gap_at" if number == "gap" else "restitution_of"
        now = model.value(f"stop.{key}")
        if now in words and f"stop.{number}" not in estimated and model.value(f"stop.{number}"):
            other = words[1 - words.index(now)]
            yield f'stop.{key} = "{other}"', {f"stop.{key}": other}
    for name in problem.forward:
        fidelity = case.fidelities[name]
        counts = REDUCTIONS[fidelity.reduction].counts or fidelity.reduction == "static_mode"
        if counts and (fidelity.modes or 1) < MODES:
            settings = {f"fidelity.{name}.reduction": "modal", f"fidelity.{name}.modes": MODES}
            yield f"{MODES} modes in fidelity.{name}", settings


WIDEST = 3.0  # factor on all uncertainties up to which intervals are given
SHARE = 10  # one in so many points may be an outlier
DECISIVE = 1e-3  # probability of a pattern below which it rejects the model
DISTINCT = 1e-3  # part of an added variable that the keys cannot make up for, from which on it is tested
NUDGE = 1e-5  # relative step of a frequency


@dataclass(frozen=True)
class Pattern:
    """Added variable ``name``: its estimated ``size`` and standard ``error``, probability, and ``decrease`` of χ²."""

    name: str
    size: float
    error: float
    probability: float
    decrease: float

    @property
    def significant(self) -> bool:
        """Test whether it is unlikely, and lowers χ² by more than 1, what any parameter of noise does."""
        return self.probability < UNLIKELY and self.decrease > 1.0


@dataclass(frozen=True)
class Outlier:
    """Point ``index`` that contradicts all others: its deletion residual in standard uncertainties, probability."""

    index: int
    residual: float
    probability: float


@dataclass(frozen=True)
class Judgement:
    """Judgement of a model: are the points ``described``; patterns of the residuals, most significant first; outliers.

    ``unit``: factor on the measured values, a power of 1000, with which the model comes much nearer. ``others``: models
    that were tried in its place. ``scale``: factor on all uncertainties that the intervals hold for.
    """

    described: bool
    patterns: list[Pattern]
    outliers: tuple[Outlier, ...] = ()
    unit: float = 1.0
    others: tuple[Alternative, ...] = ()
    scale: float = 1.0

    @property
    def rejected(self) -> bool:
        """Test whether a pattern of the residuals rejects the model that their size alone does not."""
        return self.described and any(each.significant and each.probability < DECISIVE for each in self.patterns)

    @property
    def withheld(self) -> bool:
        """Test whether no intervals are given."""
        return not self.described and self.scale == 1.0


def patterns(problem: Problem, minimum: Minimum) -> list[Pattern]:
    """Patterns of the residuals, the most significant first."""
    from scipy.special import fdtrc

    rows = np.concatenate([minimum.used, minimum.used])
    jacobian, residual = minimum.jacobian[rows], minimum.residual[rows]
    basis, free, found = np.linalg.qr(jacobian)[0], minimum.freedom - 1, []
    added = dict(_added(problem, minimum))
    for name, column in added.items():
        scaled = np.concatenate([column / problem.uncertainty, np.zeros(problem.count)])[rows]
        own = scaled - basis @ (basis.T @ scaled)
        size = float(own @ own)
        if free < 1 or size <= (DISTINCT**2) * float(scaled @ scaled):
            continue
        decrease = float(own @ residual) ** 2 / size
        left = max(minimum.misfit - decrease, 1e-300) / free
        share = min(1.0, len(added) * float(fdtrc(1, free, decrease / left)))
        found.append(Pattern(name, -float(own @ residual) / size, sqrt(left / size), share, decrease))
    return sorted(found, key=lambda each: each.probability)


def _added(problem: Problem, minimum: Minimum) -> Iterator[tuple[str, Array]]:
    """Names and derivatives (points,) of added variables; NaN, of points that are left out, is 0."""
    value, _ = problem.predicted(minimum.x, minimum.chosen)
    now, frequency = np.nan_to_num(value[0]), problem.frequency
    middle = float(np.exp(np.mean(np.log(frequency))))
    yield "factor", now
    yield "frequency", now * np.log(frequency / middle)
    sizes = np.log(np.maximum(np.abs(now), 1e-300) / np.median(np.abs(now[minimum.used])))
    yield "amplitude", np.where(minimum.used, now * sizes, 0.0)
    speed, by_restitution = _struck(problem, minimum)
    touching = speed > 0
    if np.count_nonzero(touching) > 2:
        middle = float(np.exp(np.mean(np.log(speed[touching]))))
        yield "velocity", np.where(touching, by_restitution * np.log(np.where(touching, speed, middle) / middle), 0.0)
    yield "shift", _by_frequency(problem, minimum)


def _struck(problem: Problem, minimum: Minimum) -> tuple[Array, Array]:
    """Impact velocity (points,), 0 without, and derivative of the value by the restitution of the contact."""
    speed, by = np.zeros((2, problem.count))
    for group, at, own in problem.parts():
        if group.fidelity not in problem.surfaces:
            continue
        data = problem.surfaces[group.fidelity].at(minimum.x)
        row = np.zeros((1, len(data.packed())))
        row[0, 6 * len(data.omega) + 1] = 1.0
        tangents = Tangents.unpacked(row, len(data.omega))
        for motion in (0, 1):
            some = np.flatnonzero(minimum.chosen[at] == motion)
            if len(some):
                points, given = group.some(some), (data.driven(own[some]), tangents.driven(own[some]))
                by[at[some]] = value_of(points, *given, motion).by[0]
                speed[at[some]] = value_of(replace(points, quantity="impact_velocity"), *given, motion).value
    return np.nan_to_num(speed), np.nan_to_num(by)


def _by_frequency(problem: Problem, minimum: Minimum) -> Array:
    """Derivative of the values by the logarithm of all frequencies, drives held."""
    moved = tuple(replace(each, frequency=each.frequency * (1 + NUDGE)) for each in problem.groups)
    further, _ = replace(problem, groups=moved).predicted(minimum.x, minimum.chosen)
    now, _ = problem.predicted(minimum.x, minimum.chosen)
    return np.asarray(np.nan_to_num((further[0] - now[0]) / NUDGE))


def without_outliers(problem: Problem, minimum: Minimum) -> tuple[Minimum, tuple[Outlier, ...]]:
    """The minimum without the points that contradict all others, and these; the same one where there are none."""
    now, dropped, found = minimum, [], []
    for _ in range(max(1, problem.count // SHARE)):
        if now.freedom < 2:
            return minimum, ()
        x, _ = minimise(problem, now.x, now.chosen, loss="cauchy")
        off = problem.residuals(x, now.chosen)[0][: problem.count]
        dropped.append(int(np.argmax(np.abs(off))))
        now = settled(problem, x, tuple(dropped), nearby=True)
        if met(now.misfit, now.freedom):
            break
    for j in dropped:
        found.append(_deleted(problem, now, j))
    trend = max((each.decrease for each in patterns(problem, minimum)[:1] if each.significant), default=0.0)
    lower = (minimum.misfit - now.misfit) / len(dropped)
    sure = all(each.probability < UNLIKELY for each in found) and not _together(problem, found)
    return (now, tuple(found)) if met(now.misfit, now.freedom) and sure and lower > trend else (minimum, ())


def _together(problem: Problem, found: list[Outlier]) -> bool:
    """Test whether two of the points are neighbours and off on the same side: that is the model's doing."""
    place = np.argsort(np.argsort(problem.frequency))
    return any(
        abs(int(place[one.index]) - int(place[other.index])) == 1 and one.residual * other.residual > 0
        for one, other in combinations(found, 2)
    )


def _deleted(problem: Problem, minimum: Minimum, j: int) -> Outlier:
    """Deletion residual of a point that is left out, by its nearest motion."""
    from vibeam.studies.fit.explanation import explained

    chosen = np.full(problem.count, LEFT)
    chosen[j] = explained(problem, minimum.x).chosen[j]
    chosen[j] = NO_CONTACT if chosen[j] == LEFT else chosen[j]
    residual, jacobian = problem.residuals(minimum.x, chosen)
    spread = float(jacobian[j] @ minimum.covariance @ jacobian[j])
    off = float(residual[j]) / sqrt(1 + spread)
    return Outlier(j, off, min(1.0, problem.count * erfc(abs(off) / sqrt(2))))


def doubled(pattern: Pattern) -> float:
    """Change for each doubling of the variable of a pattern that goes with its logarithm."""
    return pattern.size * log(2.0)
