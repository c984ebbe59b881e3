"""Statistics of the samples: distribution of a number, shares of the inputs in a variance, errors side by side.

First-order and total indices after Sobol' and Saltelli (Comput. Phys. Commun. 181 (2010) 259, Table 2 (b) and (f)) from
two independent values of all inputs, A and B, and, for each input, A with only that input's value from B. All intervals
are those of ``replicates``.

The errors of a peak are those of ASME V&V 20: comparison error E = S − D of simulation S and measurement D; u_val² =
u_num² + u_input² + u_D² of numerical, input and data uncertainty. |E| well above u_val is error of the model's form;
below it nothing is told apart.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import hypot, nan
from typing import TYPE_CHECKING

import numpy as np

from vibeam.studies.uncertainty.replicates import (
    LEAST,
    estimated,
    half_width,
    quantile_ends,
    quantiles,
    replicates,
    scrambled,
)
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.runs.result import Result


@dataclass(frozen=True)
class Indices:
    """``first`` and ``total`` (d, k): of each input in each of k quantities; ``low`` and ``high``: 95 % of the total.

    NaN where a sample has no value, or all are the same; no interval by few samples.
    """

    first: Array
    total: Array
    low: Array
    high: Array


def saltelli(inputs: int, samples: int, seed: int) -> Array:
    """Shares (samples, 2 + d, d) of the distributions: A, B, and A with the value of B in one column each.

    Samples of one replicate follow each other.
    """
    both = scrambled(2 * inputs, samples, seed).reshape(samples, 2 * inputs)
    first, second = both[:, ::2], both[:, 1::2]  # neighbours: few points of two columns far apart lie badly
    mixed = [np.where(np.arange(inputs) == column, second, first) for column in range(inputs)]
    return np.stack([first, second, *mixed], axis=1)


def indices(values: Array) -> Indices:
    """Indices of quantities (samples, 2 + d, k) at the shares of ``saltelli``."""
    samples, inputs, count = len(values), values.shape[1] - 2, values.shape[2]
    found = np.full((4, inputs, count), np.nan)
    whole = np.isfinite(values).all(axis=(0, 1)) & (np.ptp(values, axis=(0, 1)) > 0)
    if whole.any():
        sets = values[:, :, whole].reshape(replicates(samples), -1, 2 + inputs, int(whole.sum()))
        total = estimated(_total, sets)
        ends = [total.low, total.high] if sets.shape[1] >= LEAST else [np.full_like(total.value, np.nan)] * 2
        found[:, :, whole] = np.stack([_first(sets), total.value, *ends])
    return Indices(*found)


def _first(sets: Array) -> Array:
    """First-order indices (d, k) by A, B and A with one column of B each, (replicates, samples, 2 + d, k)."""
    centred = sets - np.mean(sets[:, :, :2], axis=(0, 1, 2))
    product = centred[:, :, 1:2] * (centred[:, :, 2:] - centred[:, :, :1])
    return np.asarray(np.mean(product, axis=(0, 1)) / _variance(sets))


def _variance(sets: Array) -> Array:
    return np.asarray(np.var(sets[:, :, :2], axis=(0, 1, 2)))


def _total(sets: Array) -> Array:
    """Total indices (d, k) by the same."""
    return np.asarray(0.5 * np.mean((sets[:, :, :1] - sets[:, :, 2:]) ** 2, axis=(0, 1)) / _variance(sets))


LEVELS = (0.05, 0.25, 0.5, 0.75, 0.95)  # quantiles of the bands


@dataclass(frozen=True)
class Distribution:
    """Distribution of one number over the samples: ``nominal`` at the case's own values; NaN where there is none.

    ``share``: of the samples that have the number. ``mean_within`` and ``within``: 95 % intervals of the mean and of
    each quantile, infinite where there are too few samples.
    """

    nominal: float
    mean: float
    deviation: float
    quantiles: tuple[float, ...]
    share: float = float("nan")
    mean_within: tuple[float, float] = (-np.inf, np.inf)
    within: tuple[tuple[float, float], ...] = ()

    @classmethod
    def of(cls, nominal: float, values: Array) -> Distribution:
        """Distribution of the finite ones of values (k, m) of k replicates."""
        known = values[np.isfinite(values)]
        share = len(known) / max(values.size, 1)
        if len(known) < 2:
            return cls(nominal, float("nan"), float("nan"), (float("nan"),) * len(LEVELS), share)
        found = tuple(map(float, quantiles(known, LEVELS)))
        each = [own[np.isfinite(own)] for own in values]
        ends = tuple(quantile_ends(each, LEVELS))
        return cls(nominal, float(known.mean()), float(known.std(ddof=1)), found, share, _mean_ends(each), ends)


def _mean_ends(each: list[Array]) -> tuple[float, float]:
    """Interval of the mean; infinite where a replicate has no number."""
    if not min(map(len, each)):
        return -np.inf, np.inf
    means = np.array([own.mean() for own in each])
    half = float(half_width(means))
    return float(means.mean()) - half, float(means.mean()) + half


@dataclass(frozen=True)
class ErrorRow:
    """Peak of one fidelity, all in its unit; NaN where not known.

    ``numerical``: distance of the fidelity from its own limit; ``given``: standard deviation by the inputs;
    ``measured`` value and its ``uncertainty``, ``chose``: keys of the fidelity that it chose, so that it validates
    nothing; ``form``: difference to the finest, which is error of the reduction.
    """

    fidelity: str
    peak: float
    numerical: float
    given: float
    measured: float
    uncertainty: float
    form: float
    chose: tuple[str, ...] = ()

    @property
    def comparison(self) -> float:
        """E = S − D."""
        return self.peak - self.measured

    @property
    def validation(self) -> float:
        """u_val of what is known of it; NaN without a measurement."""
        known = [each for each in (self.numerical, self.given, self.uncertainty) if each == each]
        return hypot(*known) if self.measured == self.measured else nan


def error_rows(result: Result, peaks: Mapping[str, Distribution]) -> tuple[ErrorRow, ...]:
    """A row for each fidelity; ``result``: of the case's own values, with its comparisons."""
    limits = {each.finest: each.limit.held.peak for each in result.comparisons if not each.limit.why}
    finest = list(peaks)[-1]
    rows = []
    for name, spread in peaks.items():
        measured = next(
            (each for each in result.case.measured.values() if each.fidelity == name and each.quantity == "peak"), None
        )
        rows.append(
            ErrorRow(
                name,
                spread.nominal,
                abs(limits[name]) * spread.nominal if name in limits else nan,
                spread.deviation,
                nan if measured is None else measured.value,
                nan if measured is None or measured.uncertainty is None else measured.uncertainty,
                nan if name == finest else spread.nominal - peaks[finest].nominal,
                () if measured is None else measured.chose,
            )
        )
    return tuple(rows)
