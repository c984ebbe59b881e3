"""Exact boundaries of motions with one impact a drive period over frequency and gap, or frequency and drive level.

A level scales the drive as the case has it: the base's amplitude is level · B₁(Ω), so that the boundaries, contours of
exact test functions (``orbits.contours``), are exact on a platform too.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from vibeam.periodic.bifurcation_functions import DrivePerLevel, Kind
from vibeam.periodic.contours import Plane
from vibeam.periodic.orbit_map import plane_boundaries
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array


@dataclass(frozen=True)
class PlaneBoundary:
    """Part of a boundary with an admissible motion: Hz, and gap at the contact (m) or level of the drive, (points,).

    ``branch``: 0 the harder impact, 1 the softer.
    """

    kind: Kind
    branch: int
    frequency: Array
    value: Array


def boundaries_over(
    system: ImpactSystem, over: Literal["gap", "amplitude"], omega: Array, values: Array, gap: float,
    unit: DrivePerLevel,
) -> Iterator[PlaneBoundary]:  # fmt: skip
    """Boundaries over ``omega`` (columns,) rad/s and ``values`` (rows,), both ascending.

    ``values``: gaps at the contact (m), or levels where ``over`` is "amplitude", with ``gap`` held. ``unit``: amplitude
    of the base (m) at angular frequencies, at level 1. The system is a plain one.
    """
    plane = Plane(system, 1, over, omega, values, 1.0 if over == "gap" else gap, unit)
    for curve in plane_boundaries(plane):
        for part in _stretches(curve.clear):
            yield PlaneBoundary(curve.kind, curve.branch, curve.omega[part] / (2 * np.pi), curve.value[part])


def _stretches(clear: NDArray[np.bool_]) -> list[NDArray[np.int64]]:
    """Stretches of a curve whose motion keeps clear of the stop between impacts."""
    parts = np.split(np.arange(len(clear)), np.flatnonzero(np.diff(clear)) + 1)
    return [part for part in parts if clear[part[0]]]
