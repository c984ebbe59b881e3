"""Scene -> Structure: a cantilever of Hermite beam elements, its mass, stop and sensor (paper §6)."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from vibeam_models.damping import damped
from vibeam_models.effects import EFFECTS, LAST
from vibeam_models.scene import Beam, Scene
from vibeam_models.space import BeamSpace, nodes
from vibeam_models.structure import Structure, with_inertia

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
    structure, space = bare_beam(scene.carrier, _concentrated(scene))
    for effect in scene.effects:
        if effect.on_bare_beam:
            structure, space = effect.apply(structure, space, scene)
    structure = _observed(structure, space, scene)
    if scene.mass is not None:
        structure = with_inertia(structure, space.row(scene.mass.position), scene.mass.mass, translation=1.0)
    structure, space = _applied(structure, space, scene)
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
    """Positions of concentrated loads in m: the mass, the stop, the ends of the rigid zone.

    Inside that zone, or within a thousandth of the length of these, the stop needs no node, for the cubics reach it to
    10⁻⁹; with one the elements there would be so short and stiff that their round-off drowned the beam's stiffness.
    """
    stop = scene.stop.position
    if scene.mass is None:
        return [stop]
    middle, half = scene.mass.position, scene.rigid_half_width
    ends = [] if half == 0 else [x for x in (middle - half, middle + half) if 0 < x < scene.beam.length]
    near = min(abs(stop - x) for x in (middle, *ends)) < NEAR * scene.beam.length
    return [middle, *([] if near or abs(stop - middle) < half else [stop]), *ends]


def _applied(structure: Structure, space: BeamSpace, scene: Scene) -> tuple[Structure, BeamSpace]:
    """With every effect on the beam but those of its support."""
    for name in _order(scene):
        for effect in scene.named(name):
            if not effect.on_bare_beam:
                structure, space = effect.apply(structure, space, scene)
    return structure, space


def _order(scene: Scene) -> list[str]:
    """The names of the effects on the beam as they are applied: those that are not registered after the others."""
    registered = [name for name, home in EFFECTS.items() if home.on == "beam" and name != LAST]
    further = dict.fromkeys(effect.name for effect in scene.effects if effect.name not in EFFECTS)
    return [*registered, *further, LAST]


def _check_positions(scene: Scene) -> None:
    places = {} if scene.mass is None else {"mass": scene.mass.position}
    places |= {"stop": scene.stop.position, "sensor": scene.sensor.position}
    length = scene.beam.length
    faults = [f"{name}.position: {x} m is outside (0, {length}] m" for name, x in places.items() if not 0 < x <= length]
    if faults:
        raise ValueError("; ".join(faults))
