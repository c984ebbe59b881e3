"""Intervals of repeated studies beside what brute force found: how many hold it, and how wide they should be.

Stored is a line of numbers for each list, so that whoever reads the results counts anew.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.stats import t as student

from vibeam.studies.uncertainty.statistics import LEVELS

Array = Any
KEPT = 500  # quantiles of the plain samples
NAMES = ("mean", *(f"{level:.0%}" for level in LEVELS))


def written(values: Sequence[float] | Array) -> str:
    """Numbers as one line of the stored results."""
    return " ".join(f"{value:.9g}" for value in values)


def read(line: str) -> Array:
    """Numbers of a line."""
    return np.array(line.split(), dtype=float)


def hits(low: Array, high: Array, value: float, error: float) -> int:
    """Intervals that hold a value known to a standard ``error``: 1.96 of it and the half width added as independent."""
    return int(np.count_nonzero(np.abs(value - (low + high) / 2) <= np.hypot((high - low) / 2, 1.96 * error)))


def held(found: Mapping[str, Any], moved: float = 0.0) -> dict[str, int]:
    """Hits of a rig's intervals by name, where the truth is moved by so many of their half widths."""
    truths = [(found["mean"], found["error"]), *zip(found["quantiles"], found["quantile_errors"], strict=True)]
    counts = {}
    for name, (value, error) in zip(NAMES, truths, strict=True):
        low, high = (read(found["studies"][name][side]) for side in ("low", "high"))
        counts[name] = hits(low, high, value + moved * float(np.mean(high - low)) / 2, error)
    return counts


def widths(found: Mapping[str, Any]) -> dict[str, float]:
    """Mean half width of the intervals over Student's t times the scatter of the estimates, by name."""
    width = student.ppf(0.975, found["replicates"] - 1)
    return {
        name: float(np.mean(read(each["high"]) - read(each["low"])) / 2 / (width * read(each["value"]).std(ddof=1)))
        for name, each in found["studies"].items()
    }


def inside(found: Mapping[str, Any]) -> Array:
    """Share of the plain samples (repetitions,) between the 5 % and the 95 % that a study gives."""
    ends = (found["studies"][name]["value"] for name in (NAMES[1], NAMES[-1]))
    low, high = (np.interp(read(each), read(found["all"]), np.linspace(0, 1, KEPT + 1)) for each in ends)
    return np.asarray(high - low)
