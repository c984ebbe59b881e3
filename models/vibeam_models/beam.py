"""Scene -> Structure: a beam of finite elements on its supports, with mass, stop and sensor (paper §6)."""

from __future__ import annotations

from functools import singledispatch

from vibeam_models.damping import damped
from vibeam_models.effects import EFFECTS, LAST
from vibeam_models.scene import AnyScene, Scene
from vibeam_models.space import NEAR, BeamSpace, bare_beam
from vibeam_models.structure import Structure, with_inertia


@singledispatch
def structure_of(scene: AnyScene) -> Structure:
    """The structure of a scene of any kind on a base held still; ValueError where it is impossible."""
    raise TypeError(f"structure_of: {type(scene).__name__} is no kind of scene")


@structure_of.register
def assemble(scene: Scene) -> Structure:
    """The finite-element structure of a scene, its coordinates relative to the base.

    Outputs ``"sensor"`` and ``"tip"`` in m, and those of the scene; of a velocity or acceleration the row is that of
    the displacement. The contact row reads the deflection at the stop. The load is −M r of a base that moves, or that
    of a force on the beam where the scene's drive is one. ValueError names what stands off the beam.
    """
    return assemble_with_space(scene)[0]


def assemble_with_space(scene: Scene) -> tuple[Structure, BeamSpace]:
    """``assemble`` and the finite-element space that its coordinates belong to: rows at any x, mode shapes."""
    check_positions(scene)
    structure, space = bare_beam(scene.carrier, _concentrated(scene))
    structure = _observed(structure, space, scene)
    if scene.mass is not None:
        structure = with_inertia(structure, space.row(scene.mass.position), scene.mass.mass, translation=1.0)
    structure, space = _applied(structure, space, scene)
    return damped(_driven(structure, space, scene), scene.beam.damping), space


def _driven(structure: Structure, space: BeamSpace, scene: Scene) -> Structure:
    """The structure under its drive: effects have taken the load as −M r, so that a force comes after all of them.

    The force F sin Ωt = −b̈ with b = F/Ω² sin Ωt does on the beam what a base motion does by −M r: the load is minus
    the row of deflection, or of slope, at its place.
    """
    place = scene.base.on_beam
    if place is None:
        return structure
    if not scene.carrier.density and (place[1] or place[0] not in [x for _, x in scene.weights]):
        raise ValueError("base.at: what drives a massless beam must be a force on one of its masses")
    return structure.with_(load=-space.row(*place))


def _observed(structure: Structure, space: BeamSpace, scene: Scene) -> Structure:
    outputs = {"sensor": space.row(scene.sensor.position), **structure.outputs}
    units = dict.fromkeys(outputs, "m")
    for each in scene.outputs:
        outputs[each.name], units[each.name] = each.row(space, scene.shaped_beam), each.kind.unit
    return structure.with_(contact=space.row(scene.stop.position), outputs=outputs, units=units)


def _concentrated(scene: Scene) -> list[float]:
    """Positions of concentrated loads in m: the mass, the stop, the ends of rigid zones, the drive's force.

    Inside such a zone, or within a thousandth of the length of these or of a break of the beam, stop and force need no
    node, for the cubics reach them to 10⁻⁹; with one the elements there would be so short and stiff that their
    round-off drowned the beam's stiffness.
    """
    middles = [*([] if scene.mass is None else [scene.mass.position]), *(middle for middle, _ in scene.rigid_zones)]
    ends = [
        x for middle, half in scene.rigid_zones for x in (middle - half, middle + half) if 0 < x < scene.beam.length
    ]
    breaks = scene.shaped_beam.breaks
    others = _apart([scene.stop.position], [*middles, *ends, *breaks], scene)
    driven = [] if scene.base.at is None else [scene.base.at]
    return [*middles, *others, *ends, *_apart(driven, [*middles, *others, *ends, *breaks], scene)]


def _apart(places: list[float], nodes: list[float], scene: Scene) -> list[float]:
    """Those ``places`` that need a node of their own beside ``nodes``."""
    near = NEAR * scene.beam.length
    return [
        x
        for x in places
        if all(abs(x - node) >= near for node in nodes)
        and not any(abs(x - middle) < half for middle, half in scene.rigid_zones)
    ]


def _applied(structure: Structure, space: BeamSpace, scene: Scene) -> tuple[Structure, BeamSpace]:
    """With every effect on the beam."""
    for name in _order(scene):
        for effect in scene.named(name):
            if effect.carried_by == "beam":
                structure, space = effect.apply(structure, space, scene)
    return structure, space


def _order(scene: Scene) -> list[str]:
    """The names of the effects on the beam as they are applied: those that are not registered after the others."""
    registered = [name for name, home in EFFECTS.items() if home.on == "beam" and name != LAST]
    further = dict.fromkeys(effect.name for effect in scene.effects if effect.name not in EFFECTS)
    return [*registered, *further, LAST]


def check_positions(scene: Scene) -> None:
    """ValueError that names every place of a scene off its beam."""
    places = {} if scene.mass is None else {"mass": scene.mass.position}
    places |= {"stop": scene.stop.position, "sensor": scene.sensor.position}
    places = {f"{name}.position": x for name, x in places.items()}
    places |= {} if scene.base.at is None else {"base.at": scene.base.at}
    length = scene.beam.length
    faults = [f"{name}: {x} m is outside (0, {length}] m" for name, x in places.items() if not 0 < x <= length]
    faults += [
        f"output.{each.name}.position: {each.position} m is outside [0, {length}] m"
        for each in scene.outputs
        if not 0 <= each.position <= length
    ]
    if faults:
        raise ValueError("; ".join(faults))
