"""Distribution of one number over the samples."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LEVELS = (0.05, 0.25, 0.5, 0.75, 0.95)  # quantiles of the bands


@dataclass(frozen=True)
class Spread:
    """Distribution of one number over the samples: ``nominal`` at the case's own values; NaN where there is none.

    ``share``: of the samples that have the number.
    """

    nominal: float
    mean: float
    deviation: float
    quantiles: tuple[float, ...]
    share: float = float("nan")

    @classmethod
    def of(cls, nominal: float, values: Array) -> Spread:
        """Distribution of the finite values."""
        known = values[np.isfinite(values)]
        share = len(known) / max(len(values), 1)
        if len(known) < 2:
            return cls(nominal, float("nan"), float("nan"), (float("nan"),) * len(LEVELS), share)
        found = np.quantile(known, LEVELS)
        return cls(nominal, float(known.mean()), float(known.std(ddof=1)), tuple(map(float, found)), share)
