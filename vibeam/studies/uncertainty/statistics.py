"""Statistics of the samples: distribution of a number, shares of the inputs in a variance, errors side by side.

First-order and total indices after Sobol' and Saltelli (Comput. Phys. Commun. 181 (2010) 259, Table 2 (b) and (f)) from
two independent sets of samples A, B and, for each input, the set in which only that input's values come from B. Their
intervals are by scipy's bootstrap, with a generator of the study's seed, which that of ``sobol_indices`` takes not.

The errors of a peak are those of ASME V&V 20: comparison error E = S − D of simulation S and measurement D; u_val² =
u_num² + u_input² + u_D² of numerical, input and data uncertainty. |E| well above u_val is error of the model's form;
below it nothing is told apart.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import hypot, nan
from typing import TYPE_CHECKING
from warnings import catch_warnings

import numpy as np

from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.runs.result import Result


@dataclass(frozen=True)
class Indices:
    """``first`` and ``total`` (d, k): of each input in each of k quantities; ``low`` and ``high``: 95 % of the total.

    NaN where a sample has no value, or all are the same.
    """

    first: Array
    total: Array
    low: Array
    high: Array


def saltelli(inputs: int, samples: int, seed: int) -> Array:
    """Shares ((2 + d)·n, d) of the distributions: A, B, then A with the values of B in one column each; n = 2^m."""
    from scipy.stats.qmc import Sobol

    both = Sobol(2 * inputs, scramble=True, rng=np.random.default_rng(seed)).random(samples)
    both = np.clip(both, 1e-12, 1 - 1e-12)
    first, second = both[:, :inputs], both[:, inputs:]
    mixed = [np.where(np.arange(inputs) == column, second, first) for column in range(inputs)]
    return np.concatenate([first, second, *mixed])


def indices(values: Array, inputs: int, seed: int) -> Indices:
    """Indices of quantities (k, (2 + d)·n) at the shares of ``saltelli``."""
    from scipy.stats import bootstrap

    samples, found = values.shape[1] // (2 + inputs), np.full((4, inputs, len(values)), np.nan)
    whole = np.isfinite(values).all(axis=1) & (np.ptp(values, axis=1) > 0)
    if whole.any():
        sets = np.moveaxis(values[whole].reshape(-1, 2 + inputs, samples), 1, 0)
        sets = sets - np.mean(sets[:2], axis=(0, -1))[:, None]
        found[0][:, whole], found[1][:, whole] = (
            np.mean(sets[1] * (sets[2:] - sets[0]), axis=-1) / _variance(sets),
            _total(sets),
        )
        with catch_warnings(action="ignore"), np.errstate(all="ignore"):  # an input without influence has no interval
            spread = bootstrap(
                [np.arange(samples)], lambda at: _total(sets[..., at]), n_resamples=200, rng=np.random.default_rng(seed)
            ).confidence_interval
        found[2][:, whole], found[3][:, whole] = spread
    return Indices(*found)


def _variance(sets: Array) -> Array:
    return np.asarray(np.var(sets[:2], axis=(0, -1)))


def _total(sets: Array) -> Array:
    """Total indices (d, k) by the sets A, B, and A with one column of B each, (2 + d, k, n)."""
    return np.asarray(0.5 * np.mean((sets[0] - sets[2:]) ** 2, axis=-1) / _variance(sets))


LEVELS = (0.05, 0.25, 0.5, 0.75, 0.95)  # quantiles of the bands


@dataclass(frozen=True)
class Distribution:
    """Distribution of one number over the samples: ``nominal`` at the case's own values; NaN where there is none.

    ``share``: of the samples that have the number. ``within``: 95 % interval of each quantile, infinite where there
    are too few samples.
    """

    nominal: float
    mean: float
    deviation: float
    quantiles: tuple[float, ...]
    share: float = float("nan")
    within: tuple[tuple[float, float], ...] = ()

    @classmethod
    def of(cls, nominal: float, values: Array) -> Distribution:
        """Distribution of the finite values."""
        known = values[np.isfinite(values)]
        share = len(known) / max(len(values), 1)
        if len(known) < 2:
            return cls(nominal, float("nan"), float("nan"), (float("nan"),) * len(LEVELS), share)
        found = tuple(map(float, np.quantile(known, LEVELS)))
        return cls(nominal, float(known.mean()), float(known.std(ddof=1)), found, share, _within(known))


def _within(known: Array) -> tuple[tuple[float, float], ...]:
    """Order statistics beside each quantile: how many of independent samples are below it is binomial."""
    from scipy.stats import binom

    ordered = np.concatenate([[-np.inf], np.sort(known), [np.inf]])
    first, last = binom.ppf([[0.025], [0.975]], len(known), LEVELS).astype(int)
    return tuple(zip(ordered[first].tolist(), ordered[last + 1].tolist(), strict=True))


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
