"""Map of existence, clearance and stability of motions with one impact per n drive periods."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from vibeam.periodic.bifurcation_functions import DrivePerLevel, Kind, MotionsAt, clearances, motions
from vibeam.periodic.contours import BoundaryCurve, Plane, beyond_touching, boundary_curves, map_function
from vibeam.periodic.multipliers import real_crossing
from vibeam.periodic.orbit_curve import checked, proven, stability
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, Flags, ValueRecord

ENOUGH = 1e-9  # clearance, as a share of the motion, above which the gap is not refined further
LOSSES = (Kind.DOUBLING, Kind.NEIMARK_SACKER)
BOTH = (Kind.GRAZING, Kind.TOUCHING, *LOSSES)
CURVES = ((Kind.FOLD, 0), *((kind, branch) for kind in BOTH for branch in (0, 1)))


@dataclass(frozen=True, eq=False, repr=False)
class OrbitMap(ValueRecord):
    """Motions over ``omega`` (columns,) rad/s and ``values`` (rows,) of gap (m) or amplitude (m, or a level), ``over``.

    Arrays (rows, columns, 2), the harder impact first. ``curves``: the boundaries, located to round-off wherever they
    pass between neighbours of the grid; period doubling and Neimark–Sacker only of motions without a multiplier > 1.
    """

    periods: int
    over: str
    omega: Array
    values: Array
    velocity: Array  #: m/s; NaN where there is no motion
    admissible: Flags  #: clear of the stop between its impacts, proved
    stable: Flags  #: clear, and all Floquet multipliers lie within the unit circle
    curves: tuple[BoundaryCurve, ...]


def orbit_map(
    system: ImpactSystem, omega: ArrayLike, amplitude: ArrayLike, periods: int = 1, gap: ArrayLike | None = None,
    per_level: DrivePerLevel | None = None,
) -> OrbitMap:  # fmt: skip
    """Compute the map over ascending ``omega`` (rad/s) and either ``amplitude`` or ``gap`` (m; None: the system's own).

    ``per_level``: amplitude of the drive at level 1, a function of ``omega`` (points,), as of a constant acceleration;
    ``amplitude`` is then its level. Exactly one of the two is an ascending array. A curve of lost stability may end up
    to a step of the grid short of a fold or a grazing that it runs into. ValueError where none or both are arrays, or a
    grid does not ascend, and as in ``orbits``.

    >>> import vibeam
    >>> system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, restitution=0.5)
    >>> plane = vibeam.orbit_map(system, [1.9, 2.0, 2.1], 0.1, gap=[0.0, 0.05])
    >>> plane.over, plane.stable.shape
    ('gap', (2, 3, 2))
    """
    grid = checked(system, omega, periods)
    given = {"amplitude": np.asarray(amplitude, float), "gap": np.asarray(system.gap if gap is None else gap, float)}
    over = [name for name, value in given.items() if value.ndim == 1]
    if len(over) != 1:
        raise ValueError(f"amplitude, gap: exactly one must be an array, not {len(over)}")
    values, held = given.pop(over[0]), float(*given.values())
    for name, row in (("omega", grid), (over[0], values)):
        if len(row) < 2 or not np.all(np.isfinite(row)) or not np.all(np.diff(row) > 0):
            raise ValueError(f"{name}: must be two or more finite numbers that ascend")
    plane = Plane(system, int(periods), over[0], grid, values, held, per_level)
    points, shape = plane.grid(), (len(values), len(grid), 2)
    share = _shares(system, points)
    velocity, admissible, stable = _read(system, points, share)
    return OrbitMap(
        int(periods), over[0], grid, values,
        velocity.reshape(shape), admissible.reshape(shape), stable.reshape(shape), _curves(plane, points, share),
    )  # fmt: skip


class OrbitPoints(NamedTuple):
    """Motions with one impact at points, (points, 2) as in ``OrbitMap``."""

    velocity: Array
    admissible: Flags
    stable: Flags


def orbit_points(system: ImpactSystem, periods: int, omega: Array, amplitude: Array, gap: Array) -> OrbitPoints:
    """Motions at points (points,) of frequency (rad/s), amplitude of the drive (m) and gap (m)."""
    points = motions(system, periods, omega, amplitude, gap)
    return _read(system, points, _shares(system, points))


def _read(system: ImpactSystem, points: MotionsAt, share: dict[int, Array]) -> OrbitPoints:
    admissible = np.stack([share[branch] > 0 for branch in (0, 1)], axis=1)
    velocity = np.where(points.roots.impulse < 0, points.roots.velocity, np.nan)
    return OrbitPoints(velocity, admissible, stability(system, points.total, points.roots, admissible))


def plane_boundaries(plane: Plane) -> tuple[BoundaryCurve, ...]:
    """The boundaries of ``orbit_map`` over any plane, one whose drive depends on the frequency too."""
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
