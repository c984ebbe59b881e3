"""Quantities to which an accuracy applies, and the distance between two readings."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.system.response import FrequencyResponse

Array = NDArray[np.float64]

OVER_AMPLITUDE = ("maximum", "minimum")  # quantities that may be zero: their errors are shares of the amplitude


def reading_of(quantities: Sequence[str]) -> int:
    """Level of detail that the flight solver must read off for the quantities."""
    return layout.REACH_TOO if "reach" in quantities else layout.OUTPUT_ALONE


def values(response: FrequencyResponse, quantities: Sequence[str]) -> Array:
    """Values (points, quantities)."""
    return np.stack([getattr(response, name) for name in quantities], axis=1)


def distance(found: FrequencyResponse, truth: FrequencyResponse, quantities: Sequence[str]) -> Array:
    """Signed relative errors (points, quantities); those of maximum and minimum over the amplitude.

    Zero where neither has a value (no impact, no velocity), ∞ where one alone has.
    """
    ours, theirs = values(found, quantities), values(truth, quantities)
    scales = [truth.amplitude if name in OVER_AMPLITUDE else getattr(truth, name) for name in quantities]
    with np.errstate(divide="ignore", invalid="ignore"):
        error = (ours - theirs) / np.abs(np.stack(scales, axis=1))
    error = np.where(ours == theirs, 0.0, error)
    neither = np.isnan(ours) & np.isnan(theirs)
    return np.asarray(np.where(neither, 0.0, np.where(np.isnan(error), np.inf, error)))
