"""Contact velocities after many impacts at once."""

from __future__ import annotations

import numpy as np

from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array
from vibeam_models.laws.restitution import PlasticRestitution, TableRestitution, ViscousRestitution


def rebound(system: ImpactSystem, speeds: Array) -> Array:
    """Contact velocities R(v) v off a hard stop after impacts at ``speeds`` v, m/s."""
    law = system.law
    if isinstance(law, TableRestitution):
        return _tabulated(law, speeds) * speeds
    if isinstance(law, ViscousRestitution):
        return np.asarray(np.maximum(0.0, 1 - law.factor * speeds**law.exponent) * speeds)
    if isinstance(law, PlasticRestitution):
        elastic = law.velocity * law.coefficient ** (1 / law.exponent)
        fast = np.maximum(speeds, elastic)
        return np.where(speeds > elastic, law.coefficient * (fast / law.velocity) ** -law.exponent, 1.0) * speeds
    return np.asarray(system.restitution * speeds)


def _tabulated(law: TableRestitution, speeds: Array) -> Array:
    """R by the monotone cubics of the table, constant beyond its ends."""
    v, r, slope = np.array(law.speeds), np.array(law.coefficients), np.array(law.slopes())
    i = np.clip(np.searchsorted(v, speeds, side="right") - 1, 0, len(v) - 2)
    h = v[i + 1] - v[i]
    u = np.clip((speeds - v[i]) / h, 0.0, 1.0)
    bend = h * u * (1 - u) * ((1 - u) * slope[i] - u * slope[i + 1])
    return np.asarray(r[i] + (r[i + 1] - r[i]) * u * u * (3 - 2 * u) + bend)


def rebound_slope(system: ImpactSystem, speeds: Array) -> Array:
    """Derivatives d(R(v) v)/dv of ``rebound`` by the impact velocity."""
    law = system.law
    if isinstance(law, TableRestitution):
        return _tabulated(law, speeds) + _tabulated_slope(law, speeds) * speeds
    if isinstance(law, ViscousRestitution):
        fallen = law.factor * speeds**law.exponent
        return np.where(fallen < 1, 1 - (1 + law.exponent) * fallen, 0.0)
    if isinstance(law, PlasticRestitution):
        share = rebound(system, speeds) / speeds
        return np.where(share < 1, (1 - law.exponent) * share, 1.0)
    return np.full(len(speeds), system.restitution)


def _tabulated_slope(law: TableRestitution, speeds: Array) -> Array:
    """dR/dv of the table's monotone cubics, 0 beyond its ends."""
    from scipy.interpolate import CubicHermiteSpline

    v = np.array(law.speeds)
    inside = (speeds >= v[0]) & (speeds <= v[-1])
    slope = CubicHermiteSpline(v, law.coefficients, law.slopes()).derivative()
    return np.where(inside, slope(np.clip(speeds, v[0], v[-1])), 0.0)
