"""Observed rate of a sequence over doubled numbers of modes, its limit by extrapolation, or the refusal.

With x_N = x + a N⁻ᵖ + …, the differences d_k = x_{2N} − x_N fall by 2⁻ᵖ at each doubling, and

    p = log₂ |d_{k−1}/d_k|,        x = x_K + d_K/(2ᵖ − 1)        (Richardson, Aitken's Δ² with q = 2⁻ᵖ)

The rate of the last three differences must agree for that. Where it does not, as where single modes count more than
others, the remainder is bounded by the decay of the largest later difference; where that does not decay there is no
limit in sight.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import nan

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LEAST = 4  # values from which a rate is observed

SLOWEST = 0.4  # rate below which differences are not taken to sum up

STEADY = 0.25  # largest difference of two successive rates of a sequence that is extrapolated

ROUND_OFF = 1e-9  # relative difference at which a sequence has arrived

TOO_FEW = "too few numbers of modes to observe a rate"

DIVERGES = "no limit in sight: from N = {0} to {1} it still changes by {2:.2g} %, no less than before"


@dataclass(frozen=True)
class ObservedLimit:
    """Limit with its ``uncertainty``, and the ``rate`` p of N⁻ᵖ; ``why``: it is refused, and the limit is NaN.

    ``extrapolated``: by the rate; else it is the last value, and the uncertainty bounds what is left.
    """

    limit: float
    uncertainty: float
    rate: float
    extrapolated: bool = False
    why: str = ""


def observed_limit(counts: Sequence[int], values: Sequence[float]) -> ObservedLimit:
    """Limit of ``values`` at numbers of modes ``counts``, each twice the one before."""
    x = np.asarray(values, dtype=float)
    if len(x) < LEAST or not np.isfinite(x).all():
        return ObservedLimit(nan, nan, nan, why=TOO_FEW)
    steps = np.diff(x)
    scale = max(abs(float(x[-1])), 1e-300)
    if np.all(np.abs(steps[-2:]) <= ROUND_OFF * scale):
        return ObservedLimit(float(x[-1]), ROUND_OFF * scale, nan)
    with np.errstate(divide="ignore"):
        rates = np.log2(np.abs(steps[:-1] / steps[1:]))
    one_way = bool(np.all(steps[-3:] > 0) or np.all(steps[-3:] < 0))
    if one_way and rates[-1] > SLOWEST and abs(rates[-1] - rates[-2]) < STEADY:
        return _extrapolated(x, steps, float(rates[-1]), float(rates[-2]))
    return _bounded(counts, x, steps)


def _extrapolated(x: Array, steps: Array, rate: float, before: float) -> ObservedLimit:
    """Richardson's limit; uncertain by what it changes with the rate observed before."""
    here, there = (float(x[-1] + steps[-1] / (2**p - 1)) for p in (rate, max(before, SLOWEST)))
    previous = float(x[-2] + steps[-2] / (2 ** max(before, SLOWEST) - 1))
    return ObservedLimit(here, max(abs(here - there), abs(here - previous)), rate, extrapolated=True)


def _bounded(counts: Sequence[int], x: Array, steps: Array) -> ObservedLimit:
    """Last value, with the geometric bound on the rest by the decay of the largest later difference."""
    later = np.maximum.accumulate(np.abs(steps)[::-1])[::-1]
    rate = float(-np.polyfit(np.arange(len(later)), np.log2(np.maximum(later, 1e-300)), 1)[0])
    recent = float(np.log2(later[-3] / later[-1]) / 2) if len(later) > 2 else rate
    if min(rate, recent) <= SLOWEST:
        change = 100 * abs(float(steps[-1])) / max(abs(float(x[-1])), 1e-300)
        return ObservedLimit(nan, nan, rate, why=DIVERGES.format(counts[-2], counts[-1], change))
    return ObservedLimit(float(x[-1]), float(later[-1] / (2 ** min(rate, recent) - 1)), rate)
