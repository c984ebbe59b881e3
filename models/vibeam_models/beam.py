"""Scene -> Structure: a cantilever of Hermite beam elements, its mass, stop and sensor (paper §6)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

import numpy as np

from vibeam_models.damping import damped
from vibeam_models.scene import Beam, Gravity, Mass, Scene, Torsion
from vibeam_models.space import BeamSpace, nodes
from vibeam_models.structure import Structure, with_inertia

if TYPE_CHECKING:
    from vibeam_models.effects import Effect


NEAR = 1e-3  # share of the length: a node at the stop must be this far from those of mass and rigid zone


def assemble(scene: Scene) -> Structure:
    """The finite-element structure of a scene, clamped at x = 0, its coordinates relative to the base.

    Outputs ``"sensor"`` and ``"tip"`` in m; the contact row reads the deflection at the stop. ValueError names what
    stands off the beam.
    """
    return assemble_with_space(scene)[0]


def assemble_with_space(scene: Scene) -> tuple[Structure, BeamSpace]:
    """``assemble`` and the finite-element space that its coordinates belong to: rows at any x, mode shapes."""
    _check_positions(scene)
    structure, space = bare_beam(scene.beam, _concentrated(scene))
    if scene.clamp is not None:
        from vibeam_models.effects.sprung_clamp import SprungClamp

        structure, space = SprungClamp(scene.clamp.stiffness, scene.beam).apply(structure, space)
    structure = _observed(structure, space, scene)
    if scene.mass is not None:
        structure = with_inertia(structure, space.row(scene.mass.position), scene.mass.mass, translation=1.0)
    for effect in _effects(scene):
        structure, space = effect.apply(structure, space)
    return damped(structure, scene.beam.damping), space


def bare_beam(beam: Beam, inserted: Iterable[float] = ()) -> tuple[Structure, BeamSpace]:
    """The undamped cantilever alone and its space, with extra mesh nodes at ``inserted`` (m).

    Contact and the only output, ``"tip"``, are the deflection at the free end. The load is −M r with the clamp moving
    along: r is 1 there too.
    """
    space = BeamSpace.clamped(nodes(beam.length, beam.elements, inserted))
    free = space.constraint
    mass = space.mass(beam.mass_per_length)
    tip = space.row(beam.length)
    structure = Structure(
        M=free.T @ mass @ free,
        C=np.zeros((space.size, space.size)),
        K=free.T @ space.stiffness(beam.bending_stiffness) @ free,
        load=-free.T @ mass @ space.translation(),
        static=np.zeros(space.size),
        contact=tip,
        outputs={"tip": tip},
        units={"tip": "m"},
    )
    return structure, space


def _observed(structure: Structure, space: BeamSpace, scene: Scene) -> Structure:
    outputs = {"sensor": space.row(scene.sensor.position), **structure.outputs}
    units = dict.fromkeys(outputs, "m")
    return structure.with_(contact=space.row(scene.stop.position), outputs=outputs, units=units)


def _concentrated(scene: Scene) -> list[float]:
    """Where concentrated loads act: the mass, the stop, the ends of the rigid zone.

    Inside that zone, or within a thousandth of the length of these, the stop needs no node, for the cubics reach it to
    10⁻⁹; with one the elements there would be so short and stiff that their round-off drowned the beam's stiffness.
    """
    stop = scene.stop.position
    if scene.mass is None:
        return [stop]
    middle, half = scene.mass.position, scene.mass.rigid_half_width or 0.0
    ends = [] if half == 0 else [x for x in (middle - half, middle + half) if 0 < x < scene.beam.length]
    near = min(abs(stop - x) for x in (middle, *ends)) < NEAR * scene.beam.length
    return [middle, *([] if near or abs(stop - middle) < half else [stop]), *ends]


def _effects(scene: Scene) -> Iterator[Effect]:
    """The effects that the scene names, each imported only then."""
    if scene.added_masses:
        from vibeam_models.effects.added_mass import PointMass

        yield from (PointMass(added.mass, added.position) for added in scene.added_masses)
    if scene.mass is not None:
        yield from _of_mass(scene.mass)
    if scene.torsion is not None:
        yield _torsion(scene, scene.torsion)
    if scene.gravity is not None:
        yield _gravity(scene, scene.gravity)
    if scene.beam.massless:
        from vibeam_models.effects.massless_beam import MasslessBeam

        yield MasslessBeam()


def _of_mass(mass: Mass) -> Iterator[Effect]:
    """What the attached mass has beyond being a point."""
    if mass.rotary_inertia is not None:
        from vibeam_models.effects.rotary_inertia import RotaryInertia

        yield RotaryInertia(mass.rotary_inertia, mass.position)
    if mass.rigid_half_width is not None:
        from vibeam_models.effects.rigid_zone import RigidZone

        yield RigidZone(mass.position, mass.rigid_half_width)


def _torsion(scene: Scene, torsion: Torsion) -> Effect:
    from vibeam_models.effects.torsion import StVenantTorsion

    if scene.mass is None:
        raise ValueError("torsion: it has the polar inertia of an attached mass, and the scene has none")
    return StVenantTorsion(
        torsion.eccentricity,
        torsion.shear_modulus,
        torsion.polar_inertia,
        scene.beam,
        scene.mass.position,
        scene.stop.position,
        scene.mass.rigid_half_width or 0.0,
    )


def _gravity(scene: Scene, gravity: Gravity) -> Effect:
    from vibeam_models.effects.gravity import AxialGravity, TransverseGravity

    if gravity.direction == "transverse":
        return TransverseGravity(gravity.acceleration)
    downward = 1 if gravity.direction == "hanging" else -1
    return AxialGravity(downward * gravity.acceleration, scene.beam, scene.weights)


def _check_positions(scene: Scene) -> None:
    places = {} if scene.mass is None else {"mass": scene.mass.position}
    places |= {"stop": scene.stop.position, "sensor": scene.sensor.position}
    length = scene.beam.length
    faults = [f"{name}.position: {x} m is outside (0, {length}] m" for name, x in places.items() if not 0 < x <= length]
    if faults:
        raise ValueError("; ".join(faults))
