"""Statistics of impacts: how many a second are harder than a velocity, with their sampling error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vibeam_models.arrays import Array, ValueRecord

THRESHOLDS = 200


@dataclass(frozen=True, eq=False, repr=False)
class Exceedance(ValueRecord):
    """Impacts a second (k,), 1/s, that are at least as hard as each ``velocity`` (k,), ascending, m/s.

    ``error``: standard errors (k,) over the realisations; NaN of one alone.
    """

    velocity: Array
    rate: Array
    error: Array


def exceedance_of(velocities: Sequence[Array], duration: float, most: int = THRESHOLDS) -> Exceedance:
    """Exceedance of the impact velocities, m/s, of realisations of equal ``duration``, s.

    At each of them, of many at ``most`` evenly spaced in rank, the hardest among them. ValueError without a duration.
    """
    if not duration > 0:
        raise ValueError(f"duration: {duration:g} s, must be positive")
    pooled = np.sort(np.concatenate([np.empty(0), *velocities]))
    ranks = np.unique(np.round(np.linspace(0, len(pooled) - 1, min(most, len(pooled)))).astype(int))
    levels = np.unique(pooled[ranks])
    counts = np.array([len(own) - np.searchsorted(np.sort(own), levels, side="left") for own in velocities])
    counts = counts.reshape(len(velocities), len(levels)) / duration
    many = len(velocities)
    error = counts.std(axis=0, ddof=1) / np.sqrt(many) if many > 1 else np.full(len(levels), np.nan)
    return Exceedance(levels, counts.mean(axis=0) if many else np.zeros(len(levels)), error)
