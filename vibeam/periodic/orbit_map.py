"""Existence, clearance, stability of motions with one impact per n drive periods; their boundaries over a plane."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vibeam.periodic.bifurcation_functions import Kind, MotionsAt, clearances, motions
from vibeam.periodic.contours import BoundaryCurve, Plane, beyond_touching, boundary_curves, map_function
from vibeam.periodic.multipliers import proven, real_crossing, stability
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, Flags

ENOUGH = 1e-9  # clearance, as a share of the motion, above which the gap is not refined further
LOSSES = (Kind.DOUBLING, Kind.NEIMARK_SACKER)
BOTH = (Kind.GRAZING, Kind.TOUCHING, *LOSSES)
CURVES = ((Kind.FOLD, 0), *((kind, branch) for kind in BOTH for branch in (0, 1)))


class OrbitPoints(NamedTuple):
    """Motions with one impact at points, arrays (points, 2), the harder impact first."""

    velocity: Array  #: m/s; NaN where there is no motion
    admissible: Flags  #: clear of the stop between its impacts, proved
    stable: Flags  #: clear, and all Floquet multipliers lie within the unit circle


def orbit_points(system: ImpactSystem, periods: int, omega: Array, amplitude: Array, gap: Array) -> OrbitPoints:
    """Motions at points (points,) of frequency (rad/s), amplitude of the drive (m) and gap (m)."""
    points = motions(system, periods, omega, amplitude, gap)
    share = _shares(system, points)
    admissible = np.stack([share[branch] > 0 for branch in (0, 1)], axis=1)
    velocity = np.where(points.roots.impulse < 0, points.roots.velocity, np.nan)
    return OrbitPoints(velocity, admissible, stability(system, points.total, points.roots, admissible))


def plane_boundaries(plane: Plane) -> tuple[BoundaryCurve, ...]:
    """Boundaries over a plane, located to round-off wherever they pass between neighbours of its grid.

    Period doubling and Neimark–Sacker only of motions without a multiplier > 1: such a curve may end up to a step of
    the grid short of a fold or a grazing that it runs into.
    """
    points = plane.grid()
    return _curves(plane, points, _shares(plane.system, points))


def _shares(system: ImpactSystem, points: MotionsAt) -> dict[int, Array]:
    """Clearance of either branch, as a share of the motion's size."""
    return {branch: clearances(system, points, branch, ceiling=ENOUGH) for branch in (0, 1)}


def _curves(plane: Plane, points: MotionsAt, share: dict[int, Array]) -> tuple[BoundaryCurve, ...]:
    shape = len(plane.values), len(plane.omega)
    return tuple(
        curve
        for kind, branch in CURVES
        for curve in boundary_curves(
            plane, kind, branch, _values(plane.system, kind, branch, points, share).reshape(shape)
        )
    )


def _values(system: ImpactSystem, kind: Kind, branch: int, points: MotionsAt, share: dict[int, Array]) -> Array:
    """Test function on the grid; NaN for a loss of stability where the motion is unstable already."""
    if kind is Kind.TOUCHING:
        return beyond_touching(share[branch])
    if kind in LOSSES:
        unstable = proven(real_crossing(system, points.total.plus, points.roots.relative_acceleration[:, branch]))
        relative_acceleration = np.where(unstable[:, None], np.nan, points.roots.relative_acceleration)
        points = points._replace(roots=points.roots._replace(relative_acceleration=relative_acceleration))
    return map_function(system, kind, branch, points)
