"""Reduced structure of a scene, kept for the next case with the same one; the flight that some reductions are made of.

Gap, law and size of the drive are no part of it. That of a solid is kept on disk too.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from math import nan
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.beam import structure_of
from vibeam_models.registry import loaded
from vibeam_models.scene import RigScene
from vibeam_models.structure import Structure
from vibeam_reductions.declaration import REDUCTIONS, ReductionDeclaration

if TYPE_CHECKING:
    from vibeam.system.impact_system import ImpactSystem
    from vibeam_reductions.pod import Snapshots

KEPT = 64  # reduced structures
FEW = 8  # structures before their reduction, each for all of its fidelities
OURS = "vibeam_models."  # effects of this package read no more of the stop than its position


Parameters = tuple[tuple[str, Any], ...]  # of a reduction, by name


def reduced_structure(
    scene: RigScene, reduction: str, modes: int | None, parameters: Mapping[str, Any] | None = None
) -> tuple[Structure, float]:
    """Reduced structure of a scene, and the deflection of its static mode at the contact, 1 at the sensor.

    The latter is NaN where there is no static mode, as of a free body.
    ``parameters``: of the reduction, by name. It is assembled anew only where beam, masses, sensor, effects or position
    of stop or force changed, or where an effect is not of this package. ValueError for an impossible structure or more
    modes than it has.
    """
    declared, further = REDUCTIONS[reduction], tuple(sorted((parameters or {}).items()))
    if not all(type(effect).__module__.startswith(OURS) for effect in scene.effects):
        return _made(*_structure(scene), declared, modes, further)
    return _kept(scene.structural(), declared, modes, further)


@lru_cache(maxsize=KEPT)  # the arrays of a Structure are never written to
def _kept(
    scene: RigScene, declared: ReductionDeclaration, modes: int | None, parameters: Parameters
) -> tuple[Structure, float]:
    if not scene.spatial:
        return _made(*_kept_structure(scene), declared, modes, parameters)
    files = loaded(scene.spatial)
    place = files.place_of(scene, declared.name, modes, parameters)
    known: tuple[Structure, float] | None = files.kept(place)
    if known is None:
        files.keep(place, *(known := _made(*_kept_structure(scene), declared, modes, parameters)))
    return known


def _made(
    structure: Structure, static: float, declared: ReductionDeclaration, modes: int | None, parameters: Parameters
) -> tuple[Structure, float]:
    return declared.make(structure, modes, **dict(parameters)).structure, static


def static_at_contact(structure: Structure) -> float:
    """Deflection of the static mode at the contact, 1 at the sensor; NaN of a free body, which has none."""
    from vibeam_reductions.static_shapes import static_shape

    try:
        return float((structure.contact @ static_shape(structure))[0])
    except ValueError:
        return nan


def _structure(scene: RigScene) -> tuple[Structure, float]:
    structure = structure_of(scene)
    return structure, static_at_contact(structure)


_kept_structure = lru_cache(maxsize=FEW)(_structure)


PERIODS = 50  # of a flight
FLIGHTS = 8
Flight = Callable[..., tuple[Array, Array]]  # (system, drive, periods) to displacements and velocities


def with_snapshots(
    scene: RigScene, parameters: Mapping[str, Any], full: Callable[[RigScene], ImpactSystem], flight: Flight
) -> Mapping[str, Any]:
    """Parameters of a reduction, with the ``snapshots`` of a flight in place of its frequency and periods.

    ``full``: the scene's full model, which ``flight`` flies. ValueError on a platform, whose own motion is none of the
    beam's modes.
    """
    if scene.platform is not None:
        raise ValueError(
            "pod: its flight is over a base that moves as prescribed, and this rig has a platform: "
            'write reduction = "residual_flexibility"'
        )
    given = dict(parameters)
    snapshots = _flown(scene, given.pop("frequency"), given.pop("periods", PERIODS), full, flight)
    return given | {"snapshots": snapshots}


@lru_cache(maxsize=FLIGHTS)
def _flown(
    scene: RigScene, frequency: float, periods: int, full: Callable[[RigScene], ImpactSystem], flight: Flight
) -> Snapshots:
    from vibeam.system.impact_system import Drive
    from vibeam_models.base_motion import drive_amplitude
    from vibeam_reductions.pod import Snapshots

    omega = 2 * np.pi * frequency
    amplitude = float(np.ravel(drive_amplitude(scene, np.array([omega])))[0])
    return Snapshots(*flight(full(scene), Drive(omega, amplitude), periods))
