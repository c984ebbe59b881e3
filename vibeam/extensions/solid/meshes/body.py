"""BodyReading: a mesh by what a case says of its groups, as clamp, contact, sensor, masses and materials."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from vibeam.exchange.faults import suggest, suggestion
from vibeam.exchange.files import COORDINATES
from vibeam.extensions.solid.elasticity.body import BodyMass, SolidBody
from vibeam.extensions.solid.elasticity.own_mesh import (
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
from vibeam.extensions.solid.elasticity.plan import GroupMaterial, OwnMesh, SurfaceMotion
from vibeam.extensions.solid.elasticity.scene import assumed_poissons_ratio, assumption
from vibeam.extensions.solid.meshes.faults import body_faults, cell_faults, group_of, merged, on_line, size_faults
from vibeam_models.arrays import Array, Index
from vibeam_models.beams.stretch import Material

OwnFault = tuple[str, str]  # key in [solid], dotted, and message
SHOWN = 12  # groups in a message
NONE = np.empty(0, dtype=np.int64)
OF_RIG = {"contact", "opposite", "sensor", "force"}  # what no further output is called
LOOKS = 0.5  # share of a surface's area that its mean normal must have, to be one
Surface = tuple[Indices, Indices]  # facets or, where there are none, vertices of the finite-element mesh


@dataclass
class BodyReading:
    """Reading of a mesh in m by what a case says of its groups; faults are collected, none hides another.

    ``turn`` and ``origin``: to the axes of a half body, in which the mesh is then.
    """

    plan: OwnMesh
    mesh: FileMesh
    faults: list[OwnFault] = field(default_factory=list)
    assumed: list[str] = field(default_factory=list)
    turn: Array = field(default_factory=lambda: np.eye(3))
    origin: Array = field(default_factory=lambda: np.zeros(3))

    def body_and_rig(self) -> tuple[SolidBody | None, OwnRig | None]:
        """The body, its drive and readings; None where there are faults."""
        names = {f"clamp.{index}": name for index, name in enumerate(self.plan.clamp)}
        names |= {key: motion.group for key, motion in self.motions.items()}
        names |= {"symmetry": self.plan.symmetry} if self.plan.symmetry else {}
        self._check(names)
        if self.mesh.unused:
            said = f"{len(self.mesh.cells)} cells of {len(self.mesh.points)} nodes; {self.mesh.unused} further nodes"
            self.assumed.append(f"{self.plan.file} has {said} of no cell of volume are left out")
        materials, material = tuple(map(self._made, self.plan.materials)), self._material()
        if self.plan.symmetry and not self.faults:
            self._halve(self.plan.symmetry)
        if not self.faults:
            self._check_size()
        if self.faults:
            return None, None
        surfaces = {key: self._surface(key, name) for key, name in names.items()}
        clamps = [surface for key, surface in surfaces.items() if key.startswith("clamp")]
        masses = self._masses(clamps)
        rig = None if self.faults else self._rig(surfaces)
        if self.faults:
            return None, None
        patches, points = (
            {"clamp": np.unique(np.concatenate(each)).astype(np.int64)} for each in zip(*clamps, strict=True)
        )
        half = self.plan.symmetry is not None
        made = (self.volume, material, materials, half, patches, points, None, masses, self.turn, self.origin)
        return SolidBody(*made), rig

    @cached_property
    def motions(self) -> dict[str, SurfaceMotion]:
        """Motions of groups that are read or driven, by their keys."""
        said = {name: getattr(self.plan, name) for name in ("contact", "opposite", "sensor", "force")}
        said |= {f"outputs.{name}": motion for name, motion in self.plan.outputs.items()}
        return {key: motion for key, motion in said.items() if motion is not None}

    def _check(self, names: Mapping[str, str]) -> None:
        """Complain about groups, size, cells and bodies."""
        known = [key for key, name in names.items() if self._group(key, name, surface=True)]
        for name in OF_RIG & self.plan.outputs.keys():
            self.complain(f"outputs.{name}", f"'{name}' is a name of its own in [solid]: call the output otherwise")
        for index, each in enumerate(self.plan.masses):
            self._group(f"mass.{index}.group", each.group)
        self.faults.extend(size_faults(self.mesh, self.plan.unit, self.plan.extent))
        wrong = [("mesh", fault) for fault in cell_faults(self.mesh)]
        self.faults.extend(wrong or self._of_bodies([names[key] for key in known if key.startswith("clamp")]))

    def complain(self, key: str, message: str) -> None:
        """Complain about a key of [solid]."""
        self.faults.append((key, message))

    def _group(self, key: str, name: str, surface: bool = False) -> MeshGroup | None:
        """A group of the mesh, or a complaint; cells of volume are no ``surface``."""
        group = self.mesh.groups.get(name)
        if group is None:
            known = list(self.mesh.groups)
            some = known if suggestion(name, known) or len(known) <= SHOWN else [*known[:SHOWN], "…"]
            self.complain(key, f"the mesh has no group '{name}': {suggest(name, some)}")
        elif strays := (self.mesh.strays or {}).get(name, 0):
            said = f"{strays} of the nodes of group '{name}' are of no cell of volume, and nothing moves them"
            self.complain(key, f"{said}: name nodes of the body")
        elif not len(group.cells) and not group.on_surface and not len(group.nodes):
            self.complain(key, f"the group '{name}' is empty")
        elif surface and len(group.cells) and not group.on_surface:
            said = f"the group '{name}' is {len(group.cells)} cells of volume, and a surface is wanted"
            self.complain(key, f"{said}: name a group of faces or nodes (Gmsh: a Physical Surface)")
        else:
            return group
        return None

    def _material(self) -> Index:
        """Index (cells,) of the material of each cell."""
        index = np.full(len(self.mesh.cells), -1)
        rest = [number for number, each in enumerate(self.plan.materials) if each.group is None]
        for number, each in enumerate(self.plan.materials):
            key = f"material.{number}.group"
            group = None if each.group is None else self._group(key, each.group)
            if group is None:
                continue
            if not len(group.cells):
                self.complain(key, f"the group '{each.group}' has no cells of volume, which alone have a material")
            taken = group.cells[index[group.cells] >= 0]
            if len(taken):
                other = self.plan.materials[int(index[taken[0]])].group
                said = f"{len(taken)} cells of '{each.group}' are of '{other}' too"
                self.complain(key, f"{said}: a cell has one material")
            index[group.cells] = number
        for number in rest[1:]:
            self.complain(f"material.{number}", "a second material without a group: only one is that of all the rest")
        bare = np.flatnonzero(index < 0)
        if len(bare) and not rest:
            said = f"missing for {len(bare)} of {len(index)} cells{group_of(self.mesh, bare)}"
            self.complain("material", f"{said}: add a material of their group, or one without group for all the rest")
        index[bare] = rest[0] if rest else -1
        return index

    def _made(self, said: GroupMaterial) -> Material:
        """A material, with the usual Poisson's ratio where it says none."""
        ratio = said.poissons_ratio
        if ratio is None:
            ratio = assumed_poissons_ratio(said.youngs_modulus)[0]
            self.assumed.append(assumption(said.youngs_modulus, "poissons_ratio"))
        return Material(said.youngs_modulus, said.density, ratio)

    def _of_bodies(self, clamps: Sequence[str]) -> list[OwnFault]:
        """Complaints about bodies that do not hang together, near nodes being one where the case says so."""
        touching = [] if self.plan.opposite is None else [self.plan.contact.group, self.plan.opposite.group]
        if self.plan.merge is not None:
            try:
                self.mesh = merged(self.mesh, self.plan.merge, self._nodes(touching))
            except ValueError as error:
                return [("merge", str(error))]
        half = self.plan.symmetry is not None
        return list(body_faults(self.mesh, self._nodes(clamps), self._nodes(touching), half))

    def _nodes(self, names: Sequence[str]) -> Indices:
        """All nodes of groups, those of their faces among them; of no group where it is not there."""
        groups = (self.mesh.groups[name] for name in names if name in self.mesh.groups)
        found = [part.ravel() for group in groups for part in (*group.faces, group.nodes)]
        return np.unique(np.concatenate([NONE, *found]))

    def _halve(self, name: str) -> None:
        try:
            self.turn, self.origin = half_turn(self.mesh.points, self._nodes([name]))
        except ValueError as error:
            self.complain("symmetry", f"'{name}' {error}")
        else:
            self.mesh = replace(self.mesh, points=turned(self.mesh.points, self.turn, self.origin))

    def _check_size(self) -> None:
        parts = self.volume.nvertices + self.volume.nedges
        parts += self.volume.nfacets + self.volume.nelements if self.mesh.corners.shape[1] == 8 else 0
        if 3 * parts > COORDINATES:
            said = f"makes {3 * parts} coordinates by quadratic elements, and {COORDINATES} are the most that are taken"
            self.complain("mesh", f"{said}: mesh coarser")

    @cached_property
    def volume(self) -> Any:
        """The finite-element mesh."""
        return finite_element_mesh(self.mesh)

    @cached_property
    def numbering(self) -> Numbering:
        """Its vertices by the nodes of the file."""
        return Numbering(self.mesh)

    def _surface(self, key: str, name: str) -> Surface:
        """A group as facets or vertices; of a surface that is read none inside of the body."""
        group = self.mesh.groups[name]
        if not group.on_surface:
            vertices = self.numbering.of(group.nodes)
            facets = surface_within(self.volume, vertices)
            if not len(facets) and not len(vertices):
                self.complain(key, f"the group '{name}' holds middle nodes of edges alone: name corners, or faces")
            return facets, NONE if len(facets) else vertices
        found = np.concatenate([facets_of(self.volume, self.numbering.vertices[each]) for each in group.faces])
        lost, inside = int(np.sum(found < 0)), int(np.sum(self.volume.f2t[1, found] >= 0))
        said = f"of the {len(found)} faces of group '{name}'"
        if lost:
            self.complain(key, f"{lost} {said} are no faces of the volume's cells: mesh surface and volume together")
        elif inside and key in self.motions:
            self.complain(key, f"{inside} {said} lie inside the body: name faces of its surface")
        return np.unique(found), NONE

    def _carrying(self, name: str) -> tuple[Any, Any]:
        """Facets and vertices of a group that carries a mass: those of its cells where it has some."""
        group = self.mesh.groups[name]
        if len(group.cells) and not group.on_surface:
            return NONE, np.unique(self.numbering.corners[group.cells])
        return self._surface("mass", name)

    def _masses(self, clamps: Sequence[Surface]) -> tuple[BodyMass, ...]:
        """The masses on groups, of which rigid ones share no vertex with another or the clamp."""
        taken = {"the clamp": np.concatenate([self._vertices(*each) for each in clamps])}
        made = []
        for number, each in enumerate(self.plan.masses):
            on = self._carrying(each.group)
            made.append(BodyMass(each.group, *on, each.mass, each.rotary_inertia or 0.0, each.rigid))
            own = self._vertices(*on)
            if each.rigid and on_line(self.volume.p[:, own].T):
                said = f"the group '{each.group}' is a line or a point, which cannot turn as a body does"
                self.complain(f"mass.{number}.group", f"{said}: write rigid = false, or name a face")
            for name, others in taken.items() if each.rigid else ():
                if shared := int(np.isin(own, others).sum()):
                    said = f"{shared} nodes of the rigid group '{each.group}' are of {name} too"
                    self.complain(f"mass.{number}.group", f"{said}: write rigid = false, or make the group smaller")
            taken |= {f"'{each.group}'": own} if each.rigid else {}
        return tuple(made)

    def _vertices(self, facets: Any, vertices: Any) -> Indices:
        return np.union1d(self.volume.facets[:, facets].ravel() if len(facets) else NONE, vertices)

    def _rig(self, surfaces: Mapping[str, Surface]) -> OwnRig:
        """Rows of what is read, and the direction of the base, in the axes of the body."""
        toward = self._direction("contact", self.plan.contact, surfaces["contact"])
        rows = {}
        for key, motion in self.motions.items():
            along = toward if motion.direction is None else self._direction(key, motion, surfaces[key])
            rows[key.removeprefix("outputs.")] = BodyRow(((*surfaces[key], along, 1.0),))
        rows.setdefault("sensor", rows["contact"])
        if "opposite" in rows:
            meeting = BodyRow((*rows["contact"].parts, (*surfaces["opposite"], toward, -1.0)))
            rows = {name: row for name, row in rows.items() if name != "opposite"} | {"contact": meeting}
        base = toward if self.plan.base is None else self.turn @ axis(self.plan.base)
        if self.plan.symmetry and any(abs(each[1]) > IN_PLANE for each in (toward, base)):
            self.complain("symmetry", "the motion is across the plane of symmetry: mesh the whole body")
        return OwnRig(rows, None if self.plan.force is not None else base)

    def _direction(self, key: str, motion: SurfaceMotion, surface: Surface) -> Array:
        """Unit vector along which a surface is read, in the axes of the body."""
        if motion.direction not in (None, "normal"):
            return self.turn @ axis(str(motion.direction))
        cure = f'write {{ group = "{motion.group}", direction = "z" }}'
        if not len(surface[0]):
            self.complain(key, f"'{motion.group}' is of nodes alone, which have no normal: {cure}")
            return np.zeros(3)
        normal, share = mean_normal(self.volume, surface[0])
        if share < LOOKS:
            self.complain(key, f"the faces of '{motion.group}' look in all directions: {cure}")
        shown = ", ".join(f"{each:.3g}" for each in self.turn.T @ normal)
        self.assumed.append(f"solid.{key} is read along ({shown}), the outward normal of '{motion.group}'")
        return normal


def axis(name: str) -> Array:
    """Unit vector of ``"x"`` … ``"-z"``."""
    found = np.zeros(3)
    found["xyz".index(name[-1])] = -1.0 if name.startswith("-") else 1.0
    return found
