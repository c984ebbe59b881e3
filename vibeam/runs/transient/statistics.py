"""Statistics of ensembles and of correlated series: means with their standard errors and effective numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from vibeam_models.arrays import Array

LEAST = 16  # values of a series of which a correlation is estimated


@dataclass(frozen=True)
class SampleMean:
    """Mean of ``n`` values with its standard ``error``, NaN of fewer than two; worth ``effective`` independent ones."""

    mean: float
    error: float
    n: int
    effective: float


NOTHING = SampleMean(float("nan"), float("nan"), 0, 0.0)


def mean_of(values: ArrayLike) -> SampleMean:
    """Mean of independent values, NaN among them left out: the error is s/√n."""
    known = _finite(values)
    if not len(known):
        return NOTHING
    error = float(np.std(known, ddof=1) / np.sqrt(len(known))) if len(known) > 1 else float("nan")
    return SampleMean(float(np.mean(known)), error, len(known), float(len(known)))


def mean_of_series(values: ArrayLike) -> SampleMean:
    """Mean of successive values of one motion, which are correlated: s √(τ/n), worth n/τ independent ones.

    τ = 1 + 2 Σ ρ_k over the initial positive sequence, sums of two successive correlations as long as they are positive
    and do not grow (Geyer, Statistical Science 7 (1992) 473, section 3.3). Too few values have no error.
    """
    known = _finite(values)
    if len(known) < LEAST:
        return NOTHING if not len(known) else SampleMean(float(np.mean(known)), float("nan"), len(known), float("nan"))
    time = correlation_time(known)
    effective = len(known) / time
    return SampleMean(
        float(np.mean(known)), float(np.std(known, ddof=1) / np.sqrt(effective)), len(known), float(effective)
    )


def correlation_time(series: Array) -> float:
    """Integrated correlation time τ of a series, in its steps; 1 of an independent one, and of a constant one."""
    away = series - series.mean()
    size = 2 ** int(np.ceil(np.log2(2 * len(away))))
    covariance = np.fft.irfft(np.abs(np.fft.rfft(away, size)) ** 2, size)[: len(away)]
    if not covariance[0] > 0:
        return 1.0
    correlation = covariance / covariance[0]
    pairs = correlation[: len(away) // 2 * 2].reshape(-1, 2).sum(axis=1)
    negative = np.flatnonzero(pairs <= 0)
    pairs = np.minimum.accumulate(pairs[: negative[0] if len(negative) else len(pairs)])
    return max(2 * float(np.sum(pairs)) - 1, 1.0 / len(away))


def windowed_rate(times: Array, begin: float, end: float, windows: int = 64) -> SampleMean:
    """Events a second with its error: the counts of equal ``windows`` of the time are a correlated series."""
    counts, _ = np.histogram(times, windows, (begin, end))
    return mean_of_series(counts * (windows / (end - begin)))


def paired(values: ArrayLike, others: ArrayLike) -> SampleMean:
    """Mean difference of ``values`` from ``others`` on the same realisations, as a share of the mean of these."""
    one, two = (np.asarray(each, dtype=float) for each in (values, others))
    known = np.isfinite(one) & np.isfinite(two)
    scale = float(np.mean(two[known])) if known.any() else 0.0
    return mean_of((one[known] - two[known]) / abs(scale)) if scale else NOTHING


def _finite(values: ArrayLike) -> Array:
    found = np.asarray(values, dtype=float).ravel()
    return np.asarray(found[np.isfinite(found)])
