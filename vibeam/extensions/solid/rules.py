"""Solids of a case: the rules of [solid] and of fidelities that fly one, their scenes, and a mesh of the user's own."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields, replace
from pathlib import Path as File
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from vibeam.casefile.coordinates import digests
from vibeam.casefile.quantities import LENGTH, to_si
from vibeam.casefile.scenes import base_of, damping_of, stop_of
from vibeam.casefile.tables.beam import damping_checks
from vibeam.casefile.tables.effects import effects_in, effects_of_scene
from vibeam.casefile.tables.given import given_rules
from vibeam.casefile.tables.outputs import main_output, quantity_named
from vibeam.casefile.tables.sweep import model_named
from vibeam.casefile.tables.table import plan_of
from vibeam.casefile.toml_writing import to_toml
from vibeam.exchange.faults import Complaint, KeyPath
from vibeam.extensions.solid.elasticity.plan import CLAMPS, GroupMass, GroupMaterial, OwnMesh, Solid, SurfaceMotion
from vibeam.extensions.solid.elasticity.scene import SolidScene
from vibeam.extensions.solid.table import OF_BODY, OF_MESH
from vibeam_models.beams.beam import Beam
from vibeam_models.given import GivenScene, GivenStructure
from vibeam_models.keys import keys_of
from vibeam_models.outputs import DISPLACEMENT
from vibeam_models.scene import Scene

if TYPE_CHECKING:
    from vibeam.extensions.solid.meshes.body import OwnFault

OURS = "vibeam_models."  # effects of this package, which a solid knows
ON_BASE = ("platform", "shaker")  # effects that a mesh leaves to the case
INCOMPRESSIBLE, MOST_RATIO = 0.5, 0.49
SAME = 1e-9  # share of a length that is round-off
WHOLE = ("full", "pod")  # reductions that need all modes, or a flight of them


def solid_rules(case: SimpleNamespace, folder: File) -> Iterator[Complaint]:
    """Complaints about [solid] beside a beam, and about fidelities of it that fly a solid."""
    if case.solid is not None:
        yield from _said(case.solid)
        for name in ("damping", "damping_ratio"):
            if getattr(case.solid, name) is not None:
                yield ("solid", name), f"beam.{name} says it: leave it out here"
        if case.solid.mass_size is not None and case.mass is None:
            yield ("solid", "mass_size"), "is of an attached mass: add [mass], or leave it out"
        yield from _patch(case)
    flown = {name: each for name, each in case.fidelity.items() if model_named(each) == "solid"}
    if any(not (getattr(each, "set", None) or getattr(each, "without", None)) for each in flown.values()):
        yield from _of_mesh(case, folder) if _has_mesh(case) else _refused(case)
        for name in ("beam", "torsion"):
            ratio = getattr(getattr(case, name), "poissons_ratio", None)
            if ratio is not None and ratio >= INCOMPRESSIBLE and not (case.solid and case.solid.material):
                said = f"is {ratio:g}, and a solid's stiffness grows without limit toward 0.5"
                yield (name, "poissons_ratio"), f"{said}: write {MOST_RATIO} at most"
    yield from _reduced(flown)


def _reduced(flown: Mapping[str, Any]) -> Iterator[Complaint]:
    for name, fidelity in flown.items():
        if fidelity.reduction in WHOLE:
            said = f'a solid has too many coordinates for reduction = "{fidelity.reduction}"'
            yield ("fidelity", name, "reduction"), f'{said}: write reduction = "modal", modes = 20'


def _patch(case: Any) -> Iterator[Complaint]:
    """Complaints about a patch that the beam is too short or too narrow for; one at the tip is half there."""
    patch, length, width = case.solid.contact, case.beam.length, getattr(case.beam, "width", None)
    at = case.stop.position or (case.mass and case.mass.position)
    if not isinstance(patch, tuple) or len(patch) != 2 or None in (at, length):
        return
    beyond = max(at + patch[0] / 2 - length, patch[0] / 2 - at)
    if at < length and beyond > SAME * length:
        cure = "take it shorter, or move stop.position, which is its middle"
        yield ("solid", "contact"), f"reaches {beyond:.4g} m beyond the beam's end: {cure}"
    if width is not None and not case.section and patch[1] > width * (1 + SAME):
        yield ("solid", "contact"), f"is {patch[1]:g} m wide on a beam {width:g} m wide: take it narrower"


def _has_mesh(case: Any) -> bool:
    return case.solid is not None and case.solid.mesh is not None


def _said(table: Any) -> Iterator[Complaint]:
    """Complaints about the keys of [solid], of which a mesh has others than a body that is meshed."""
    for name, count in {"contact": 2, "mass_size": 3}.items():
        given = getattr(table, name)
        if isinstance(given, tuple) and len(given) != count:
            yield (
                ("solid", name),
                f"takes {count} numbers, not {len(given)}: {keys_of(Solid)[name].meaning.partition(';')[0]}",
            )
    if table.mesh is None:
        yield from _said_of_body(table)
        return
    for name in OF_BODY:
        if getattr(table, name) is not None:
            yield ("solid", name), f"is of a body that is meshed, and {to_toml(table.mesh)} is a mesh: leave it out"
    if isinstance(table.contact, tuple):
        yield ("solid", "contact"), 'a mesh has the contact as a group of facets: write contact = "contact"'
    if table.mesh_unit is None:
        yield ("solid", "mesh_unit"), 'missing (unit of the mesh\'s coordinates): write mesh_unit = "mm"'
    if table.base is not None and table.force is not None:
        yield ("solid", "force"), "the drive is said twice: keep base, of a base that moves, or force"


def _said_of_body(table: Any) -> Iterator[Complaint]:
    for name in OF_MESH:
        if getattr(table, name):
            yield ("solid", name), 'goes with a mesh of your own alone: write mesh = "rig.msh", or leave it out'
    if isinstance(table.contact, Mapping):
        yield ("solid", "contact"), 'is a group of a mesh: write length and width, contact = ["6 mm", "20 mm"]'
    if table.clamp is not None and (len(table.clamp) > 1 or table.clamp[0] not in CLAMPS):
        yield ("solid", "clamp"), f'must be one of {", ".join(CLAMPS)}; a group of a mesh goes with mesh = "rig.msh"'


def _refused(case: Any) -> Iterator[Complaint]:
    """Complaints about what of the rig no solid can have."""
    if case.beam.massless:
        yield ("beam", "massless"), f"a solid has the mass of its material: {_cure('beam.massless')}"
    if case.leaf is not None:
        yield ("leaf",), f"a leaf spring is not meshed: {_cure('leaf')}, or give the solid a mesh of your own"
    for path, table in _sections(case):
        if table.shape == "general":
            yield (
                (*path, "shape"),
                'a "general" section has no form that can be meshed: give [solid] a mesh of your own',
            )
    for path, effect, _ in effects_in(case):
        if not effect.__module__.startswith(OURS):
            yield path, f"is an effect on a beam, which no solid knows: {_cure('.'.join(map(str, path)))}"


def _cure(key: str) -> str:
    return f'take it out, or write without = ["{key}"] in the fidelities that fly a solid'


def _sections(case: Any) -> Iterator[tuple[KeyPath, Any]]:
    yield ("beam",), case.beam
    if case.opposite is not None:
        yield ("opposite",), case.opposite
    yield from ((("section", index), each) for index, each in enumerate(case.section or ()))


def _of_mesh(case: Any, folder: File) -> Iterator[Complaint]:
    """Complaints about a mesh beside a beam, which has of the case the stop, the drive, and what the base stands on."""
    for name in ("gravity", "further_stop"):
        if getattr(case, name):
            yield (name,), f"a mesh of your own does not know it: {_cure(name)}"
    if case.drive.moment is not None:
        yield ("drive", "moment"), "acts on a beam: a mesh of your own takes a force, on the group solid.force"
    if (case.drive.force is not None and case.platform is None) != (case.solid.force is not None):
        yield ("solid", "force"), "is where drive.force acts on the mesh: say both, or none of the two"
    asked: dict[KeyPath, Any] = {("sweep", "output"): main_output(case)} if case.sweep is not None else {}
    asked |= {("show", name, "output"): show.output for name, show in case.show.items()}
    for path, output in asked.items():
        if quantity_named(case, output) is not DISPLACEMENT:
            yield path, f'"{output}" is no displacement, and a mesh of your own reads no other: write "sensor"'
        elif output not in (None, "sensor", "contact", "platform", *(case.solid.outputs or ())):
            yield path, f'the mesh has no "{output}": write outputs = {{ {output} = "GROUP" }} in [solid]'
    yield from _mesh_faults(case, folder)


def mesh_rules(case: SimpleNamespace, folder: File) -> Iterator[Complaint]:
    """Complaints about a case that is a mesh, without a beam."""
    yield from _said(case.solid)
    yield from damping_checks(_damped(case.solid), "solid")
    if not case.solid.material:
        cure = 'add [[solid.material]] with youngs_modulus = "210 GPa", density = "7850 kg/m^3"'
        yield ("solid", "material"), f"missing (what the mesh is made of): {cure}"
    yield from given_rules(case, "solid")
    yield from _reduced(case.fidelity)
    yield from _mesh_faults(case, folder)


def _damped(table: Any) -> SimpleNamespace:
    return SimpleNamespace(damping=table.damping or "constant", damping_ratio=table.damping_ratio)


def most_modes(case: Any, folder: File) -> tuple[int, str]:
    """Number of modes of a solid: not known before it is meshed."""
    return 0, ""


def sources(case: Any, folder: File) -> dict[str, str]:
    """The mesh of a case and what it holds; nothing where it has none."""
    return digests({"mesh": case.solid.mesh}, folder) if _has_mesh(case) else {}


def _mesh_faults(case: Any, folder: File) -> Iterator[Complaint]:
    """Complaints about the mesh itself, where what [solid] says of it can be read."""
    said = case.solid
    readable = said.mesh is not None and said.mesh_unit is not None and not isinstance(said.contact, tuple)
    whole = all(None not in (each.youngs_modulus, each.density) for each in said.material)
    whole = whole and all(None not in (each.group, each.mass) for each in said.mass)
    if readable and whole and (said.material or _beams_material(case)):
        yield from ((("solid", *key.split(".")), said) for key, said in _own(case, folder)[1])


def _own(case: Any, folder: File) -> tuple[GivenStructure | None, tuple[OwnFault, ...]]:
    """Structure of a case's mesh, and its faults; that it has none is kept on disk, and it is not read again."""
    from vibeam.extensions.solid.kept_structures import note, noted
    from vibeam.extensions.solid.meshes.own import own_structure

    return own_structure(own_mesh(case), folder, noted, note)


def own_mesh(case: Any) -> OwnMesh:
    """The mesh of a case as it says it; beside a beam with the beam's material and damping."""
    table = case.solid
    ratios = _damped(table) if getattr(case, "beam", None) is None else case.beam
    motions = {name: _motion(getattr(table, name)) for name in ("sensor", "opposite", "force")}
    return OwnMesh(
        file=table.mesh,
        unit=to_si(f"1 {table.mesh_unit}", LENGTH),
        materials=tuple(plan_of(GroupMaterial, each) for each in table.material) or _beams_material(case),
        clamp=table.clamp or ("clamp",),
        contact=_motion(table.contact) or SurfaceMotion("contact"),
        outputs={name: SurfaceMotion(**each) for name, each in (table.outputs or {}).items()},
        base=table.base,
        symmetry=table.symmetry,
        masses=tuple(plan_of(GroupMass, each) for each in table.mass),
        extent=table.extent,
        merge=table.merge,
        damping=damping_of(ratios),
        **motions,
    )


def _motion(said: Mapping[str, str] | None) -> SurfaceMotion | None:
    return None if said is None else SurfaceMotion(**said)


def _beams_material(case: Any) -> tuple[GroupMaterial, ...]:
    beam = getattr(case, "beam", None)
    if beam is None or None in (beam.youngs_modulus, beam.density):
        return ()
    return (plan_of(GroupMaterial, beam, group=None),)


def mesh_scene(case: Any, folder: File) -> Any:
    """The scene of a mesh of the user's own: a given structure at the case's stop."""
    given, faults = _own(case, folder)
    if given is None:
        raise ValueError("; ".join(f"solid.{key}: {message}" for key, message in faults))
    stop, base = stop_of(case.stop, 0.0, getattr(case, "beam", None)), base_of(case, **_place(case))
    carried = tuple(each for each in effects_of_scene(case) if each.name in ON_BASE)
    return GivenScene(replace(given, assumed=(*given.assumed, *_replaced(case))), stop, base, carried)


def _replaced(case: Any) -> Iterator[str]:
    """Sentence that names the tables of a beam's case which a mesh stands for."""
    if getattr(case, "beam", None) is not None:
        on = (each.name for each in effects_of_scene(case) if each.name not in ON_BASE)
        tables = dict.fromkeys(["beam", *(["mass"] if case.mass else []), *(name.partition(".")[0] for name in on)])
        named = ", ".join(f"[{name}]" for name in tables)
        yield f"the mesh {to_toml(case.solid.mesh)} stands for {named}: its groups say clamp, contact, sensor, masses"


def _place(case: Any) -> dict[str, float | None]:
    """The place of a force on the mesh, which has one alone."""
    return {"at": None if case.solid.force is None else 0.0}


def solid_scene(case: Any, folder: File, beam: Scene) -> Any:
    """The scene of a fidelity that flies a solid, from that of its beam: meshed, or a mesh of the user's own."""
    if _has_mesh(case):
        return mesh_scene(case, folder)
    own = {each.name: getattr(beam, each.name) for each in fields(Scene)}
    kept = tuple(each for each in beam.effects if each.name != "beam.theory")  # a solid needs no theory of shear
    return SolidScene(**own | {"effects": kept, "beam": _contracting(beam)}, solid=_plan(case.solid))


def _contracting(scene: Scene) -> Beam:
    """The beam with the Poisson's ratio of [torsion] where it says none itself."""
    ratios = [scene.beam.poissons_ratio, *(each.poissons_ratio for each in scene.named("torsion"))]
    return replace(scene.beam, poissons_ratio=next((each for each in ratios if each is not None), None))


def _plan(table: Any) -> Solid:
    if table is None:
        return Solid()
    said = {name: value for name in keys_of(Solid) if (value := getattr(table, name)) is not None}
    return Solid(**said | ({"clamp": table.clamp[0]} if table.clamp else {}))
