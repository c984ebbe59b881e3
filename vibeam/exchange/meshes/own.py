"""Structure of a mesh of the user's own: its groups as clamp, contact, sensor, masses, materials; all that is wrong."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from vibeam.exchange.faults import suggest
from vibeam.exchange.files import FormatError, digest_of
from vibeam.exchange.meshes.faults import (
    body_faults,
    cell_faults,
    group_of,
    merged,
    size_faults,
)
from vibeam.exchange.meshes.read import read_mesh
from vibeam_models.arrays import Array
from vibeam_models.beams.stretch import Material
from vibeam_models.given import GivenStructure
from vibeam_models.solid.body import BodyMass, SolidBody
from vibeam_models.solid.own_mesh import (
    IN_PLANE,
    BodyRow,
    FileMesh,
    Indices,
    MeshGroup,
    Numbering,
    OwnRig,
    facets_of,
    finite_element_mesh,
    half_turn,
    mean_normal,
    surface_within,
    turned,
)
from vibeam_models.solid.plan import GroupMaterial, OwnMesh, SurfaceMotion
from vibeam_models.solid.scene import assumed_poissons_ratio

OwnFault = tuple[str, str]  # key in [solid], dotted, and message
KEPT = 4  # structures
NONE = np.empty(0, dtype=np.int64)
LOOKS = 0.5  # share of a surface's area that its mean normal must have, to be one


def own_structure(plan: OwnMesh, folder: Path) -> tuple[GivenStructure | None, tuple[OwnFault, ...]]:
    """Structure of a mesh (None: it cannot be made), and every complaint about it; ``plan.file`` is in ``folder``."""
    try:
        said = f"{digest_of(folder / plan.file)} {replace(plan, file='')!r}"
    except FormatError as error:
        return None, (("mesh", f"{plan.file}: {error}"),)
    return _structure(_Asked(sha256(said.encode()).hexdigest(), plan, folder))


@dataclass(frozen=True)
class _Asked:
    digest: str
    plan: OwnMesh = field(compare=False)
    folder: Path = field(compare=False)


@lru_cache(maxsize=KEPT)
def _structure(asked: _Asked) -> tuple[GivenStructure | None, tuple[OwnFault, ...]]:
    from vibeam_models.solid.own_structure import body_structure

    body, rig, faults = own_body(asked.plan, asked.folder)
    if body is None or rig is None:
        return None, faults
    try:
        structure = body_structure(body, rig).with_(damping=asked.plan.damping)
    except ValueError as error:
        if not body.masses:
            raise
        return None, (("mass", str(error)),)
    carried = body.mass + sum(each.mass for each in body.masses)
    return GivenStructure(asked.digest, "solid", structure, None, carried), ()


def own_body(plan: OwnMesh, folder: Path) -> tuple[SolidBody | None, OwnRig | None, tuple[OwnFault, ...]]:
    """Body of a mesh with its drive and readings (None: there are faults), and every fault."""
    try:
        mesh = read_mesh(folder / plan.file)
    except FormatError as error:
        return None, None, (("mesh", f"{plan.file}: {error}"),)
    made = BodyReading(plan, replace(mesh, points=mesh.points * plan.unit))
    return (*made.body_and_rig(), tuple(dict.fromkeys(made.faults)))


@dataclass(frozen=True)
class GroupSurface:
    """A group as part of the surface: ``facets`` (k,) or, where it has none, ``vertices`` (k,) of the mesh."""

    facets: Indices
    vertices: Indices


@dataclass
class BodyReading:
    """Reading of a mesh in m by what a case says of its groups; faults are collected, none hides another."""

    plan: OwnMesh
    mesh: FileMesh
    faults: list[OwnFault] = field(default_factory=list)

    def body_and_rig(self) -> tuple[SolidBody | None, OwnRig | None]:
        """The body, its drive and readings; None where there are faults."""
        motions = self._motions()
        names = {f"clamp.{index}": name for index, name in enumerate(self.plan.clamp)}
        names |= {key: motion.group for key, motion in motions.items()}
        names |= {"symmetry": self.plan.symmetry} if self.plan.symmetry else {}
        groups = {key: group for key, name in names.items() if (group := self._surface_group(key, name))}
        self.faults.extend(size_faults(self.mesh, self.plan.unit, self.plan.extent))
        materials, material = self._materials()
        for index, each in enumerate(self.plan.masses):
            self._group(f"mass.{index}.group", each.group)
        wrong = [("mesh", fault) for fault in cell_faults(self.mesh)]
        self.faults.extend(wrong)
        if self.plan.merge is not None and not wrong:
            self._merge(groups)
            groups = {key: self.mesh.groups[names[key]] for key in groups}
        if not wrong and not any(key == "merge" for key, _ in self.faults):
            clamps = [group for key, group in groups.items() if key.startswith("clamp")]
            self.faults.extend(body_faults(self.mesh, _nodes(clamps), _touching(groups)))
        return (None, None) if self.faults else self._made(groups, motions, materials, material)

    def complain(self, key: str, message: str) -> None:
        """Complain about a key of [solid]."""
        self.faults.append((key, message))

    def _motions(self) -> dict[str, SurfaceMotion]:
        said = {name: getattr(self.plan, name) for name in ("contact", "opposite", "sensor", "force")}
        said |= {f"outputs.{name}": motion for name, motion in self.plan.outputs.items()}
        return {key: motion for key, motion in said.items() if motion is not None}

    def _group(self, key: str, name: str) -> MeshGroup | None:
        group = self.mesh.groups.get(name)
        if group is None:
            self.complain(key, f"the mesh has no group '{name}': {suggest(name, self.mesh.groups)}")
            return None
        strays = (self.mesh.strays or {}).get(name, 0)
        if strays:
            said = f"{strays} of the nodes of group '{name}' are of no cell of volume, and nothing moves them"
            self.complain(key, f"{said}: name nodes of the body")
        elif not len(group.cells) and not any(map(len, group.faces)) and not len(group.nodes):
            self.complain(key, f"the group '{name}' is empty")
        else:
            return group
        return None

    def _surface_group(self, key: str, name: str) -> MeshGroup | None:
        group = self._group(key, name)
        if group is not None and len(group.cells) and not any(map(len, group.faces)):
            said = f"the group '{name}' is {len(group.cells)} cells of volume, and a surface is wanted"
            self.complain(key, f"{said}: name a group of faces or nodes (Gmsh: a Physical Surface)")
            return None
        return group

    def _materials(self) -> tuple[tuple[Material, ...], Indices]:
        """The materials, and the index (cells,) of that of each cell."""
        index = np.full(len(self.mesh.cells), -1)
        for number, each in enumerate(self.plan.materials):
            if each.group is None:
                continue
            key = f"material.{number}.group"
            group = self._group(key, each.group)
            if group is None:
                continue
            if not len(group.cells):
                self.complain(key, f"the group '{each.group}' has no cells of volume, which alone have a material")
            taken = group.cells[index[group.cells] >= 0]
            if len(taken):
                other = self.plan.materials[int(index[taken[0]])].group
                self.complain(
                    key, f"{len(taken)} cells of '{each.group}' are of '{other}' too: a cell has one material"
                )
            index[group.cells] = number
        default = [number for number, each in enumerate(self.plan.materials) if each.group is None]
        for number in default[1:]:
            self.complain(f"material.{number}", "a second material without a group: only one is that of all the rest")
        index[index < 0] = default[0] if default else -1
        bare = np.flatnonzero(index < 0)
        if len(bare):
            said = f"missing for {len(bare)} of {len(index)} cells{group_of(self.mesh, bare)}"
            self.complain("material", f"{said}: add a material of their group, or one without group for all the rest")
        return tuple(map(_material, self.plan.materials)), index

    def _merge(self, groups: Mapping[str, MeshGroup]) -> None:
        """Make near nodes of the mesh one, but those of two bodies in contact."""
        try:
            self.mesh = merged(self.mesh, float(self.plan.merge or 0.0), _touching(groups))
        except ValueError as error:
            self.complain("merge", str(error))

    def _made(
        self,
        groups: dict[str, MeshGroup],
        motions: dict[str, SurfaceMotion],
        materials: tuple[Material, ...],
        material: Indices,
    ) -> tuple[SolidBody | None, OwnRig | None]:
        turn, origin = self._half(groups.get("symmetry"))
        surfaces = {key: self._surface(key, group, key in motions) for key, group in groups.items()}
        if self.faults:
            return None, None
        rows, base = self._rows(motions, surfaces, turn)
        clamps = [surface for key, surface in surfaces.items() if key.startswith("clamp")]
        carried = tuple(
            BodyMass(each.group, *self._carrying(each.group), each.mass, each.rotary_inertia or 0.0, each.rigid)
            for each in self.plan.masses
        )
        if self.faults:
            return None, None
        patches: dict[str, Any] = {"clamp": np.unique(np.concatenate([each.facets for each in clamps]))}
        points: dict[str, Any] = {"clamp": np.unique(np.concatenate([each.vertices for each in clamps]))}
        if self.plan.symmetry:
            patches["symmetry"] = surfaces["symmetry"].facets
        half = self.plan.symmetry is not None
        body = SolidBody(
            self.volume, material.astype(np.int64), materials, half, patches, points, None, carried, turn, origin
        )  # fmt: skip
        return body, OwnRig(rows, base)

    @cached_property
    def volume(self) -> Any:
        """The finite-element mesh."""
        return finite_element_mesh(self.mesh)

    @cached_property
    def numbering(self) -> Numbering:
        """Its vertices by the nodes of the file."""
        return Numbering(self.mesh)

    def _surface(self, key: str, group: MeshGroup, read: bool) -> GroupSurface:
        """A group as facets or vertices; of a surface that is ``read`` outside of the body."""
        if not any(map(len, group.faces)):
            vertices = self.numbering.of(group.nodes)
            facets = surface_within(self.volume, vertices)
            if not len(facets) and not len(vertices):
                self.complain(key, "the group holds middle nodes of edges alone: name corners, or faces")
            return GroupSurface(facets, NONE if len(facets) else vertices)
        found = np.concatenate([facets_of(self.volume, self.numbering.vertices[each]) for each in group.faces])
        lost = int(np.count_nonzero(found < 0))
        if lost:
            said = f"{lost} of the {len(found)} faces of its group are no faces of the volume's cells"
            self.complain(key, f"{said}: mesh surface and volume together")
        elif read and np.any(inside := self.volume.f2t[1, found] >= 0):
            said = f"{np.count_nonzero(inside)} of the {len(found)} faces of its group lie inside the body"
            self.complain(key, f"{said}: name faces of its surface")
        return GroupSurface(np.unique(found), NONE)

    def _rows(
        self, motions: dict[str, SurfaceMotion], surfaces: dict[str, GroupSurface], turn: Array
    ) -> tuple[dict[str, BodyRow], Array | None]:
        toward = self._direction("contact", motions["contact"], surfaces["contact"], None)
        rows = {}
        for key, motion in motions.items():
            along = toward if key == "contact" else self._direction(key, motion, surfaces[key], toward)
            part = (surfaces[key].facets, surfaces[key].vertices, turn @ along, 1.0)
            rows[key.removeprefix("outputs.")] = BodyRow((part,))
        if "opposite" in rows:
            facets, vertices, along, _ = rows.pop("opposite").parts[0]
            rows["contact"] = BodyRow((*rows["contact"].parts, (facets, vertices, along, -1.0)))
        rows.setdefault("sensor", rows["contact"])
        base = toward if self.plan.base is None else axis(self.plan.base)
        if self.plan.symmetry and abs((turn @ (toward if self.plan.force else base))[1]) > IN_PLANE:
            self.complain("symmetry", "the motion is across the plane of symmetry: mesh the whole body")
        return rows, None if self.plan.force is not None else turn @ base

    def _direction(self, key: str, motion: SurfaceMotion, surface: GroupSurface, usual: Array | None) -> Array:
        """Unit vector along which a surface is read, in the axes of the file."""
        if motion.direction is None and usual is not None:
            return usual
        if motion.direction not in (None, "normal"):
            return axis(str(motion.direction))
        if not len(surface.facets):
            self.complain(key, f"'{motion.group}' is of nodes alone, which have no normal: {_say(motion)}")
            return np.zeros(3)
        normal, share = mean_normal(self.volume, surface.facets)
        if share < LOOKS:
            self.complain(key, f"the faces of '{motion.group}' look in all directions: {_say(motion)}")
        return normal

    def _carrying(self, name: str) -> tuple[Any, Any]:
        """Facets and vertices of a group that carries a mass: those of its cells where it has some."""
        group = self.mesh.groups[name]
        if len(group.cells) and not any(map(len, group.faces)):
            return NONE, np.unique(self.numbering.corners[group.cells])
        surface = self._surface("mass", group, read=False)
        return surface.facets, surface.vertices

    def _half(self, group: MeshGroup | None) -> tuple[Array, Array]:
        """Turn and origin of a half body, in whose axes the mesh is from here; else none."""
        turn, origin = np.eye(3), np.zeros(3)
        if group is not None:
            try:
                turn, origin = half_turn(self.mesh.points, _nodes([group]))
            except ValueError as error:
                self.complain("symmetry", f"'{self.plan.symmetry}' {error}")
            else:
                self.mesh = replace(self.mesh, points=turned(self.mesh.points, turn, origin))
        return turn, origin


def _say(motion: SurfaceMotion) -> str:
    return f'write {{ group = "{motion.group}", direction = "z" }}'


def axis(name: str) -> Array:
    """Unit vector of ``"x"`` … ``"-z"``."""
    found = np.zeros(3)
    found["xyz".index(name[-1])] = -1.0 if name.startswith("-") else 1.0
    return found


def _material(said: GroupMaterial) -> Material:
    ratio = said.poissons_ratio
    usual = assumed_poissons_ratio(said.youngs_modulus)[0] if ratio is None else ratio
    return Material(said.youngs_modulus, said.density, usual)


def _touching(groups: Mapping[str, MeshGroup]) -> Indices:
    """Nodes that two bodies in contact may have in one place."""
    return _nodes([groups[key] for key in ("contact", "opposite") if "opposite" in groups and key in groups])


def _nodes(groups: Sequence[MeshGroup]) -> Indices:
    """All nodes of groups, those of their faces among them."""
    found = [part.ravel() for group in groups for part in (*group.faces, group.nodes)]
    return np.unique(np.concatenate([NONE, *found]))
