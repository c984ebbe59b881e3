"""Frequency curves of periodic motions in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibeam.periodic.modal_sums import Roots, Sums, balance, fault, sums
from vibeam.periodic.multipliers import multipliers, real_crossing
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arguments import count, floats, refuse, require
from vibeam_models.arrays import Array, ValueRecord

CERTAIN = 1e8  # size of D(±1) up to which its sign is trusted


@dataclass(frozen=True, eq=False, repr=False)
class OrbitCurve(ValueRecord):
    """Motions with one impact per ``periods`` drive periods; arrays (points, 2), NaN where there is none.

    The two columns are the two roots, the harder impact first, each smooth along the axis. They satisfy contact and
    restitution at the impact; ``orbits`` decides whether they stay clear of the stop in between.
    """

    omega: Array
    periods: int
    impulse: Array  #: N s per unit modal mass, negative: away from the stop
    phase: Array  #: drive phase Ωt at the impact, 0 … 2π
    velocity: Array  #: before the impact, toward the stop, m/s
    stable: NDArray[np.bool_]  #: all 2n Floquet multipliers within the unit circle; False where there is no motion


def checked(system: ImpactSystem, omega: ArrayLike, periods: int) -> Array:
    """Return the frequencies as an array; ValueError where no curve is defined."""
    require("system", system, ImpactSystem)
    grid = np.atleast_1d(floats("omega", omega))
    if grid.ndim != 1 or not np.all(np.isfinite(grid) & (grid > 0)):
        raise ValueError("omega: must be positive frequencies in rad/s")
    faults: list[str] = []
    count("periods", periods, faults, least=1)
    refuse("", faults)
    reason = fault(system)
    if reason:
        raise ValueError(reason)
    return grid


def orbit_curve(system: ImpactSystem, omega: ArrayLike, amplitude: float, periods: int = 1) -> OrbitCurve:
    """Compute both motions at frequencies ``omega`` (points,) rad/s under base motion of ``amplitude`` m.

    The cost of motion and of D(±1) is linear in the number of modes; eigenvalues (n³) are computed only where D(±1)
    leave stability open, never at both roots of a point. Exact resonances of undamped modes are NaN. ValueError as in
    ``orbits``.

    >>> import vibeam
    >>> system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, restitution=0.5)
    >>> curve = vibeam.orbit_curve(system, [1.9, 2.0, 2.1], 0.1)
    >>> curve.velocity.shape, curve.stable[:, 0].tolist()
    ((3, 2), [True, True, True])
    """
    grid = checked(system, omega, periods)
    total = sums(system, grid, periods)
    found = balance(system, total, amplitude, system.gap)
    real = found.impulse < 0
    impulse, phase, velocity = (np.where(real, row, np.nan) for row in (found.impulse, found.phase, found.velocity))
    return OrbitCurve(grid, int(periods), impulse, phase, velocity, stability(system, total, found, real))


def stability(system: ImpactSystem, total: Sums, found: Roots, asked: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Stability of the motions marked by ``asked`` (points, 2); False for the others."""
    open_ = asked.copy()
    for side in (total.plus, total.minus):
        for k in (0, 1):
            open_[:, k] &= ~proven(real_crossing(system, side, found.relative_acceleration[:, k]))
    stable = np.zeros(open_.shape, dtype=bool)
    rows, _ = np.nonzero(open_)
    values = multipliers(system, total.span[rows], found.relative_acceleration[open_])
    stable[open_] = np.abs(values[:, 0]) < 1
    return stable


def proven(beyond: Array) -> NDArray[np.bool_]:
    """Test for D < 0 beyond doubt: near the double pole of an undamped mode its sign is round-off."""
    return (beyond < 0) & (beyond > -CERTAIN)
