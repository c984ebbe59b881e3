"""Independent scramblings of Sobol' points, and intervals from their scatter.

Points of one scrambling depend on each other: their mean errs far less than that of independent ones, by how much they
do not tell themselves. Each scrambling is unbiased and independent of the others (Owen, J. Complexity 11 (1995) 1), so
that k of them are k independent estimates of any number; Student's t with k − 1 degrees of freedom bounds their mean.

A ratio of means is biased for few samples. Its estimates are therefore the
pseudo-values k θ − (k − 1) θ₋ⱼ of the jackknife (Tukey 1958): θ by all samples, θ₋ⱼ by all but those of replicate j. Of
a mean these are the replicates' own means.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from vibeam_models.arrays import Array

FEW, MANY, LARGE = 8, 16, 512  # replicates of fewer than so many samples, and of more
LEVEL = 0.95
LEAST = 8  # numbers of a replicate below which nothing but a mean has an interval


def replicates(samples: int) -> int:
    """Number of independent scramblings that so many samples, a power of two, are made of."""
    return FEW if samples < LARGE else MANY


@dataclass(frozen=True)
class Estimate:
    """``value`` of a number by all samples, or an array of them, and its 95 % interval, NaN where there is none."""

    value: Array
    low: Array
    high: Array


def estimated(estimate: Callable[[Array], Array], values: Array) -> Estimate:
    """What ``estimate`` finds in values (k, …) of k replicates, any number of which it takes."""
    count, whole = len(values), np.asarray(estimate(values), dtype=float)
    others = np.stack([estimate(np.delete(values, j, axis=0)) for j in range(count)])
    half = half_width(count * whole - (count - 1) * others)
    return Estimate(whole, whole - half, whole + half)


def half_width(each: Array) -> Array:
    """Half of Student's interval of the mean of independent estimates (k, …)."""
    from scipy.stats import t as student

    return np.asarray(student.ppf((1 + LEVEL) / 2, len(each) - 1) * each.std(axis=0, ddof=1) / np.sqrt(len(each)))


def quantiles(known: Array, levels: Array | tuple[float, ...]) -> Array:
    """Quantiles of numbers: the i-th of n in order is that at (i − ½)/n, as Sobol' points lie."""
    return np.asarray(np.quantile(known, levels, method="hazen"))


def quantile_ends(each: list[Array], levels: tuple[float, ...]) -> list[tuple[float, float]]:
    """Intervals of quantiles from the numbers that each replicate has, infinite where these do not reach so far.

    The share of the numbers below the quantile is a mean of the replicates' shares; the quantiles at the ends of its
    interval are those of the quantile (Woodruff, J. Am. Stat. Assoc. 47 (1952) 635). A share of few numbers is rounded.
    """
    known, few = np.concatenate(each), min(map(len, each))
    share = np.array([np.mean(own[:, None] <= quantiles(known, levels), axis=0) for own in each if len(own)])
    rounded = half_width(share) if few else np.full(len(levels), np.inf)
    places = np.asarray(levels)
    low, high = (quantiles(known, np.clip(places + sign * rounded, 0, 1)) for sign in (-1, 1))
    reached = (few >= LEAST) & (few * np.minimum(places, 1 - places) >= 1)
    ends = zip(np.where(reached, low, -np.inf), np.where(reached, high, np.inf), strict=True)
    return [(float(one), float(other)) for one, other in ends]


def scrambled(inputs: int, samples: int, seed: int) -> Array:
    """Shares (k, samples / k, inputs) in (0, 1): Sobol' points, scrambled anew for each of the k replicates."""
    from scipy.stats.qmc import Sobol

    seeds = np.random.SeedSequence(seed).spawn(replicates(samples))
    each = [Sobol(inputs, rng=np.random.default_rng(own)).random(samples // len(seeds)) for own in seeds]
    return np.asarray(np.clip(np.stack(each), 1e-12, 1 - 1e-12))
