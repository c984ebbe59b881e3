"""Closed forms of motions with one impact a drive period at many frequencies: both roots, and their stability."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibeam.periodic.modal_sums import balance, sums
from vibeam.periodic.multipliers import stability
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array


class OrbitCurve(NamedTuple):
    """Roots at each frequency, (points, 2), the harder impact first; NaN where there is none."""

    impulse: Array
    phase: Array
    velocity: Array
    stable: NDArray[np.bool_]


def orbit_curve(system: ImpactSystem, omega: ArrayLike, amplitude: float) -> OrbitCurve:
    """Roots at frequencies ``omega`` (points,) rad/s."""
    total = sums(system, np.asarray(omega, dtype=float), 1)
    found = balance(system, total, amplitude, system.gap)
    real = found.impulse < 0
    rows = (np.where(real, row, np.nan) for row in (found.impulse, found.phase, found.velocity))
    return OrbitCurve(*rows, stability(system, total, found, real))
