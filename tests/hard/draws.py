"""Random numbers and choices."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.random import Generator


def log(rng: Generator, low: float, high: float) -> float:
    """Uniform in the logarithm."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def chosen(rng: Generator, *options: Any) -> Any:
    """One of the options, all alike."""
    return options[int(rng.integers(len(options)))]
