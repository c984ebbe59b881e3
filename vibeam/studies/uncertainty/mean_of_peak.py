"""Mean of the finest fidelity's peak from few of its runs and many of cheaper models, and what that saves.

Cheaper models are the other fidelities; all but the finest by a coarse sweep; all of them in closed form, the finest
too, which follows the finest's sweep to round-off where that is on a motion with one impact a period; where there is no
closed form, all of them by orbits (``orbit_peaks``); and a quadratic surface of the finest's closed form or orbits (of
its sweep, where it has neither). Which of them are used, and how often, follows from correlations and costs as
measured. A structure that was assembled a short while ago is kept: so the cost of each is taken at inputs of its own.

The estimate is that of multi-fidelity Monte Carlo. After Peherstorfer, Willcox & Gunzburger, SIAM J. Sci. Comput. 38
(2016) A3163. Of models 1 (finest) … k with costs w_i, correlations ρ_i with the finest (ρ_1 = 1, ρ_{k+1} = 0) and
standard deviations σ_i, the estimator

    ŝ = ȳ¹(m_1) + Σ α_i (ȳⁱ(m_i) − ȳⁱ(m_{i−1})),   α_i = ρ_i σ_1/σ_i

on nested samples m_1 ≤ m_2 ≤ … has, for a cost p, its least variance at m_i = r_i m_1 (eq. 3.5),

    r_i = √(w_1 (ρ_i² − ρ_{i+1}²) / (w_i (1 − ρ_2²))),   Var ŝ = σ_1²/p (Σ √(w_i (ρ_i² − ρ_{i+1}²)))²,

where both ρ_i² and w_i fall fast enough: w_{i−1}/w_i > (ρ_{i−1}² − ρ_i²)/(ρ_i² − ρ_{i+1}²). All sets of models are
tried. The finest alone has the variance σ_1² w_1/p: the gain is the ratio of the two.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations, pairwise
from typing import Any

import numpy as np

from vibeam.studies.uncertainty.orbit_peaks import OrbitPeaks, orbits_known
from vibeam.studies.uncertainty.samples import (
    ClosedFormPeaks,
    Responses,
    Sampler,
    Surface,
    inputs_of,
    known,
    runs,
)
from vibeam_models.arrays import Array

RESAMPLES = 500  # of the bootstrap


@dataclass(frozen=True)
class Pilot:
    """A few runs of every model at the same inputs: ``values`` (n,) and mean cost in s, by name, the finest first."""

    values: Mapping[str, Array]
    seconds: Mapping[str, float]

    @property
    def finest(self) -> str:
        """Name of the finest model."""
        return next(iter(self.values))

    def correlation(self, name: str) -> float:
        """Correlation of a model with the finest, of the samples where both have a value; NaN where it has none."""
        one, other = self.values[self.finest], self.values[name]
        both = np.isfinite(one) & np.isfinite(other)
        if both.sum() < 3 or not (np.ptp(one[both]) > 0 and np.ptp(other[both]) > 0):
            return float("nan")
        return float(np.corrcoef(one[both], other[both])[0, 1])

    def deviation(self, name: str) -> float:
        """Standard deviation of a model's values."""
        return float(np.nanstd(self.values[name], ddof=1))


@dataclass(frozen=True)
class Allocation:
    """Models used, the finest first: samples of each per sample of the finest (``ratios``), ``weights`` α, ``gain``.

    ``gain``: variance of the finest alone over that of the estimate, at the same cost.
    """

    names: tuple[str, ...]
    ratios: tuple[float, ...]
    weights: tuple[float, ...]
    gain: float

    def counts(self, finest: int, most: Sequence[float]) -> tuple[int, ...]:
        """Samples of each model where the finest has so many, at ``most`` so many; never fewer than of the one before.

        A model that follows the finest to round-off would else be run without end.
        """
        found = [finest]
        for ratio, limit in zip(self.ratios[1:], most[1:], strict=True):
            found.append(max(found[-1], round(min(ratio * finest, limit))))
        return tuple(found)


def allocation(pilot: Pilot) -> Allocation:
    """The set of models with the largest gain."""
    others = [name for name in pilot.values if name != pilot.finest and np.isfinite(pilot.correlation(name))]
    others.sort(key=lambda name: -abs(pilot.correlation(name)))
    found = [Allocation((pilot.finest,), (1.0,), (1.0,), 1.0)]
    for count in range(1, len(others) + 1):
        sets = (_allocated(pilot, (pilot.finest, *chosen)) for chosen in combinations(others, count))
        found += [each for each in sets if each is not None]
    return max(found, key=lambda each: each.gain)


def _allocated(pilot: Pilot, names: tuple[str, ...]) -> Allocation | None:
    """Allocation to a set of models in falling correlation; None where it has no least variance."""
    squares = [1.0, *(pilot.correlation(name) ** 2 for name in names[1:]), 0.0]
    steps = [max(one - other, 0.0) for one, other in pairwise(squares)]
    costs = [pilot.seconds[name] for name in names]
    pairs = zip(pairwise(costs), pairwise(steps), strict=True)
    if min(steps) <= 0 or not all(w / other > step / further for (w, other), (step, further) in pairs):
        return None
    ratios = [float(np.sqrt(costs[0] * step / (cost * steps[0]))) for cost, step in zip(costs, steps, strict=True)]
    weights = [pilot.correlation(name) * pilot.deviation(names[0]) / pilot.deviation(name) for name in names[1:]]
    gain = costs[0] / sum(np.sqrt(cost * step) for cost, step in zip(costs, steps, strict=True)) ** 2
    return Allocation(names, tuple(ratios), (1.0, *weights), float(gain))


@dataclass(frozen=True)
class MeanEstimate:
    """Estimate of a mean with its 95 % bootstrap interval, its standard error, and the CPU seconds that it cost."""

    mean: float
    low: float
    high: float
    error: float
    seconds: float


def estimate(chosen: Allocation, values: Mapping[str, Array], seconds: float, seed: int) -> MeanEstimate:
    """Estimate from ``values`` of each model at the first m_i of the same inputs; samples without a value left out.

    The bootstrap resamples the parts m_1, m_2 − m_1 … apart, each with its values of all models together. It takes the
    weights and the scatter about them as known; they are of the m_1 samples of the finest, so that its deviations are
    widened as Student's t of m_1 less the number of models is wider than the normal distribution.
    """
    from scipy.stats import norm
    from scipy.stats import t as student

    rng = np.random.default_rng(seed)
    counts = [len(values[name]) for name in chosen.names]
    parts = list(pairwise([0, *counts]))
    sizes = [high - low for low, high in parts]
    once = _means(chosen, values, parts, [np.ones((1, size)) for size in sizes])
    drawn = _means(chosen, values, parts, [_drawn(rng, size) for size in sizes])
    free = max(counts[0] - len(counts), 1)
    drawn = once + np.sqrt(counts[0] / free) * student.ppf(0.975, free) / norm.ppf(0.975) * (drawn - once)
    low, high = np.quantile(drawn, [0.025, 0.975])
    return MeanEstimate(float(once[0]), float(low), float(high), float(drawn.std(ddof=1)), seconds)


def _drawn(rng: np.random.Generator, size: int) -> Array:
    """Counts by which each of so many samples is drawn (RESAMPLES, size); a part may have none."""
    rows = (rng.integers(max(size, 1), size=size) for _ in range(RESAMPLES))
    return np.stack([np.bincount(row, minlength=size) for row in rows], dtype=float)


def _means(
    chosen: Allocation, values: Mapping[str, Array], parts: Sequence[tuple[int, int]], weights: Sequence[Any]
) -> Array:
    """Estimates (k,) with the samples of each part counted as often as its weights (k, samples) say."""
    found = np.zeros(len(weights[0]))
    for place, name in enumerate(chosen.names):
        known = np.isfinite(values[name])
        filled = np.where(known, values[name], 0.0)
        own = list(zip(weights, parts[: place + 1], strict=False))
        sums = np.cumsum([w @ filled[low:high] for w, (low, high) in own], 0)
        mean = sums / np.maximum(np.cumsum([w @ known[low:high] for w, (low, high) in own], 0), 1)
        found += chosen.weights[place] * (mean[-1] - (mean[-2] if place else 0.0))
    return found


PILOT = 32  # samples from which correlations are taken
MOST = 20_000  # runs of any model
TIMED = 12  # further samples from which costs are taken


@dataclass(frozen=True)
class MeanPeak:
    """Mean of the finest fidelity's peak: by that alone, and by several models (``chosen``) with ``counts`` of runs.

    ``correlations`` with the finest, from the pilot; ``seconds``: CPU time a run, of the pilot. ``saving``: cost of the
    finest alone over that of the several, at equal variance, as measured.
    """

    chosen: Allocation
    counts: tuple[int, ...]
    correlations: Mapping[str, float]
    seconds: Mapping[str, float]
    alone: MeanEstimate
    several: MeanEstimate

    @property
    def saving(self) -> float:
        """(error² · seconds) of the finest alone over that of the several."""
        return self.alone.error**2 * self.alone.seconds / (self.several.error**2 * self.several.seconds)


@dataclass(frozen=True)
class _PeakModel:
    """A fidelity by one kind of solution, its responses to the first inputs, and CPU ``seconds`` of another one."""

    sampler: Callable[[str, Array], Responses]
    fidelity: str
    known: Responses
    seconds: float
    before: float = 0.0  # CPU seconds that it takes once

    def peaks(self, inputs: Array) -> tuple[Array, float]:
        """Peaks (m,) at inputs that begin with those known, and the CPU time that they cost."""
        count = min(len(inputs), len(self.known.inputs))
        same = (inputs[:count] == self.known.inputs[:count]).all(axis=1)
        count = int(np.argmin(np.append(same, False)))
        if count == len(inputs):
            return self.known.peak[:count], count * self.seconds
        further = self.sampler(self.fidelity, inputs[count:])
        seconds = count * self.seconds + float(further.seconds.sum())
        return np.concatenate([self.known.peak[:count], further.peak]), seconds


def mean_of_peak(
    sampler: Sampler, found: Mapping[str, Responses], finest: str, count: int, seed: int, tell: Callable[[str], None]
) -> MeanPeak | None:
    """Mean of the finest one's peak, by a quarter of its runs and as many of cheaper models as serve it best.

    None where no cheaper model saves any.
    """
    models = _models(sampler, found, finest, seed)
    pilot = Pilot(
        {name: each.known.peak[:PILOT] for name, each in models.items()},
        {name: each.seconds for name, each in models.items()},
    )
    chosen = allocation(pilot)
    if len(chosen.names) < 2:
        return None
    budget = pilot.seconds[finest] * count  # no model is run for longer than the finest alone
    most = [min(budget / pilot.seconds[name], MOST) for name in chosen.names]
    counts = chosen.counts(max(PILOT, count // 4), most)
    asked = dict(zip(chosen.names, counts, strict=True))
    inputs = _further(sampler, found[finest].inputs[:count], max(counts), seed)
    tell(f"mean of the peak: {', '.join(f'{number} × {name}' for name, number in asked.items())}")
    several = {name: models[name].peaks(inputs[:number]) for name, number in asked.items()}
    values = {name: peaks for name, (peaks, _) in several.items()}
    seconds = sum(each for _, each in several.values()) + sum(models[name].before for name in several)
    alone = estimate(
        Allocation((finest,), (1.0,), (1.0,), 1.0), {finest: found[finest].peak[:count]},
        pilot.seconds[finest] * count, seed,
    )  # fmt: skip
    correlations = {name: pilot.correlation(name) for name in models if name != finest}
    return MeanPeak(chosen, counts, correlations, pilot.seconds, alone, estimate(chosen, values, seconds, seed))


def _models(sampler: Sampler, found: Mapping[str, Responses], finest: str, seed: int) -> dict[str, _PeakModel]:
    """The finest model, then the cheaper ones, by name."""
    first = found[finest].inputs[:PILOT]
    rng = np.random.default_rng([seed, 2])

    def timed(kind: Callable[[str, Array], Responses], name: str) -> _PeakModel:
        apart = inputs_of(sampler.case.uncertain, rng.random((TIMED, len(sampler.keys))))
        return _PeakModel(kind, name, kind(name, first), float(np.mean(kind(name, apart).seconds)))

    models = {
        name: _PeakModel(sampler, name, found[name], float(np.mean(found[name].seconds)))
        for name in (finest, *(name for name in found if name != finest))
    }
    coarse = replace(sampler, coarse=True)
    models |= {f"{name}, coarse sweep": timed(coarse, name) for name in found if name != finest}
    closed = ClosedFormPeaks(sampler.case, sampler.keys)
    models |= {f"{name}, closed form": timed(closed, name) for name in found if known(sampler.case, name)}
    orbits = OrbitPeaks(sampler.case, sampler.keys)
    for name in filter(partial(orbits_known, sampler.case), found):
        models[f"{name}, orbits"] = replace(timed(orbits, name), before=orbits.begun(name))
    shot = orbits if orbits_known(sampler.case, finest) else sampler
    cheapest: Callable[[str, Array], Responses] = closed if known(sampler.case, finest) else shot
    drawn = inputs_of(sampler.case.uncertain, rng.random((runs(len(sampler.keys)), len(sampler.keys))))
    surface = Surface.of(cheapest, finest, drawn)
    if surface is not None:
        models[f"{finest}, quadratic surface"] = replace(timed(surface, finest), before=surface.seconds)
    return models


def _further(sampler: Sampler, inputs: Array, count: int, seed: int) -> Array:
    """``count`` inputs: those given, then independent ones."""
    missing = max(count - len(inputs), 0)
    shares = np.random.default_rng([seed, 1]).random((missing, len(sampler.keys)))
    further = inputs_of(sampler.case.uncertain, shares) if missing else inputs[:0]
    return np.concatenate([inputs, further])[:count]
