"""Branches of the fitted model over frequency, for figures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vibeam.orbits.tangents import Tangents
from vibeam.studies.fit.problem import MOTIONS, Problem, value_of

Array = NDArray[np.float64]


def branch(problem: Problem, x: Array, reference: str, motion: str, frequency: Array) -> Array:
    """Quantity of a reference (points,) on one motion at ``frequency`` (points,) Hz; NaN where there is none."""
    group = next(each for each in problem.groups if each.reference == reference)
    asked = replace(group, frequency=frequency, value=np.ones_like(frequency), uncertainty=np.ones_like(frequency))
    try:
        data = problem.forward[group.fidelity].data(problem.values(x), asked.omega)
    except ValueError:  # values that make no system
        return np.full(len(frequency), np.nan)
    none = Tangents.unpacked(np.zeros((0, len(data.packed()))), len(data.omega))
    found = value_of(asked, data, none, MOTIONS.index(motion))
    return np.where(found.beyond == 0, found.value, np.nan)
