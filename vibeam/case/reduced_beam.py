"""Reduced structure of a scene, kept for the next case with the same beam: gap, law and drive are not part of it."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

from vibeam_models.scene import Base, Scene, Stop
from vibeam_models.structure import Structure
from vibeam_reductions.declaration import REDUCTIONS, ReductionDeclaration

KEPT = 64  # reduced structures

OURS = "vibeam_models."  # effects of this package read no more of the stop than its position


def reduced_beam(scene: Scene, reduction: str, modes: int | None) -> tuple[Structure, float]:
    """Reduced structure of a scene, and the deflection of its static mode at the contact, 1 at the sensor.

    It is assembled anew only where beam, masses, sensor, effects or position of the stop changed, or where an effect
    is not of this package. ValueError for an impossible structure or more modes than it has.
    """
    if all(type(effect).__module__.startswith(OURS) for effect in scene.effects):
        scene = replace(scene, stop=Stop(scene.stop.position, 0.0), base=Base())
        return _kept(scene, REDUCTIONS[reduction], modes)
    return _made(scene, REDUCTIONS[reduction], modes)


def _made(scene: Scene, declared: ReductionDeclaration, modes: int | None) -> tuple[Structure, float]:
    from vibeam_models.beam import assemble
    from vibeam_reductions.static_mode import static_mode

    structure = assemble(scene)
    return declared.make(structure, modes).structure, float(static_mode(structure).structure.contact[0])


_kept = lru_cache(maxsize=KEPT)(_made)  # the arrays of a Structure are never written to
