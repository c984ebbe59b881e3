"""Intervals of repeated studies beside what brute force found: how many hold it, and how wide they should be.

Stored is a line of numbers for each list, so that whoever reads the results counts anew.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from vibeam.studies.uncertainty.statistics import LEVELS

Array = Any
KEPT = 500  # quantiles of the plain samples


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
    asked = {
        name: (found[name]["low"], found[name]["high"], found["mean"], found["error"]) for name in ("several", "alone")
    }
    known = zip(LEVELS, found["quantile_ends"], found["quantiles"], found["quantile_errors"], strict=True)
    asked |= {f"{level:.0%}": (*ends, value, error) for level, ends, value, error in known}
    counts = {}
    for name, (first, last, value, error) in asked.items():
        low, high = read(first), read(last)
        counts[name] = hits(low, high, value + moved * float(np.mean(high - low)) / 2, error)
    return counts


def scatter(found: Mapping[str, Any], name: str) -> float:
    """Standard deviation of the means over the repetitions, over their stated error."""
    return float(read(found[name]["mean"]).std(ddof=1) / read(found[name]["error"]).mean())


def inside(found: Mapping[str, Any]) -> Array:
    """Share of the plain samples (repetitions,) between the 5 % and the 95 % that a study gives."""
    low, high = (np.interp(read(ends), read(found["all"]), np.linspace(0, 1, KEPT + 1)) for ends in found["bands"])
    return high - low


def savings(found: Mapping[str, Any]) -> dict[str, float]:
    """Cost of other ways over that of the multi-fidelity mean, at equal variance.

    ``stated``: of independent sweeps of the finest, by the study's own errors and CPU times. The others by the scatter
    of the repetitions and all CPU time of their means, pilots too: ``plain`` of the same sweeps, ``brute`` of brute
    force, ``sobol`` of sweeps of the finest at the study's own points, which are not independent.
    """
    seconds, own = found["seconds"], read(found["several"]["mean"]).var(ddof=1)
    sweep = found["flown"]["seconds"]
    stated = np.mean(read(found["several"]["error"]) ** 2) * seconds["several"]
    own *= seconds["study"]
    sobol = read(found["alone"]["mean"]).var(ddof=1) * found["points"] * sweep
    return {
        "stated": float(found["deviation"] ** 2 * sweep / stated),
        "plain": float(found["deviation"] ** 2 * sweep / own),
        "brute": float(found["error"] ** 2 * seconds["brute"] / own),
        "sobol": float(sobol / own),
    }
