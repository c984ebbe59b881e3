"""SolidScene -> SparseStructure: the rig's body on its supports, with masses, stop, sensor and effects."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.beam import check_positions
from vibeam_models.effects.field_points import FieldPoints, output_names
from vibeam_models.effects.gravity import AxialGravity
from vibeam_models.outputs import Output, surface_distance
from vibeam_models.solid.constraints import RigidPart, SolidCoordinates, holding
from vibeam_models.solid.elasticity import SolidElements
from vibeam_models.solid.geometry.bodies import Which, body_of
from vibeam_models.solid.rows import NEAR, SectionRows, SolidRows, X, Z
from vibeam_models.solid.scene import SolidScene
from vibeam_models.sparse import SparseStructure
from vibeam_models.structure import side_by_side

if TYPE_CHECKING:
    from vibeam_models.beams.beam import Beam


def solid_structure(scene: SolidScene) -> SparseStructure:
    """The structure of a solid scene: as ``beam.assemble`` of the beam's, its coordinates y with u = Z y.

    The contact is the mean displacement toward the stop over its patch; sensor, tip and outputs read the surface on
    the line y = 0, a strain over a gauge as long as the section is high. ValueError as ``beam.assemble``.
    """
    check_positions(scene)
    space = solid_space(scene)
    structure = _loaded(_carrying(space, scene, "beam"), space, scene)
    for other in scene.named("opposite"):
        structure = _meeting(structure, other, scene)
    place = scene.base.on_beam
    if place is not None:
        structure = structure.with_(load=-_padded(space.section_row(*place), structure.size))
    return structure.with_(damping=scene.beam.damping)


@dataclass(frozen=True, eq=False)
class SolidSpace:
    """A body of a rig on its supports: its ``rows``, its ``coordinates``, the place (m) of each rigid zone."""

    beam: Beam
    rows: SolidRows
    coordinates: SolidCoordinates
    zones: tuple[tuple[float, float], ...]
    bed: float  # N/m³ under the face at x = 0, 0 without
    contraction: bool

    def reduced(self, row: Array) -> Array:
        """Row (n,) on the coordinates of a row (3 k,) on the displacements."""
        return np.asarray(row @ self.coordinates.basis)

    def section_row(self, x: float, derivative: int = 0) -> Array:
        """Row (n,) of mean deflection (0) or rotation (1) of the section at ``x`` m."""
        section = self.rows.section(x)
        return self.reduced(section.slope if derivative else section.deflection)

    def surface_row(self, x: float) -> Array:
        """Row (n,) of the deflection of the upper surface at ``x`` m on the line y = 0."""
        return self.reduced(self.rows.point((x, 0.0, self.height(x) / 2)))

    def height(self, x: float) -> float:
        """Height of the beam's own section at ``x`` m."""
        here = next(each for each in reversed(self.beam.stretches) if each.start <= x <= each.end)
        return float(here.section(np.array(x)).height)

    def output_row(self, output: Output) -> Array:
        """Row (n,) that an output reads; ValueError for a strain at no place of the body."""
        if output.quantity == "slope":
            return self.section_row(output.position, 1)
        if output.quantity != "strain":
            return self.surface_row(output.position)
        distance = surface_distance(self.beam, output.position) if output.distance is None else output.distance
        if distance is None:
            raise ValueError(f"output {output.name}: no distance from the neutral axis is given, nor known there")
        return self.reduced(self.rows.gauge(output.position, -distance, self.height(output.position)))

    def inertias(self, x: float, mass: float, rotary: float, polar: float) -> list[tuple[Array, float, float]]:
        """Row (n,), inertia, and what the row reads as the base moves by 1 m, of a body carried at ``x`` m.

        Its moments of inertia are ``rotary`` about y and about z, ``polar`` about x.
        """
        part = next((p for (at, _), p in zip(self.zones, self.coordinates.parts, strict=True) if at == x), None)
        if part is None:
            read = self.rows.section(x)
            every = (read.along, read.deflection, read.slope, read.lateral, read.yaw, read.twist)
            part = np.stack([self.reduced(each) for each in (every[:3] if self.rows.body.half else every)])
        inertia = (mass, mass, rotary, mass, rotary, polar)
        moved = (0.0, 1.0, 0.0, 0.0, 0.0, 0.0)
        return [each for each in zip(part, inertia, moved, strict=False) if each[1]]


def solid_space(scene: SolidScene, which: Which = "beam") -> SolidSpace:
    """The body of a scene, ``"beam"`` or ``"opposite"``, on its supports."""
    body = body_of(scene, which)
    rows = SolidRows(body, SolidElements(body.mesh))
    beam = scene.shaped_beam if which == "beam" else next(iter(scene.named("opposite"))).beam(scene)
    clamp = next(iter(scene.named("clamp")), None) if which == "beam" else None
    held, tied = holding(rows, beam, scene.solid.clamp == "sliding", bedded=clamp is not None)
    zones = tuple(dict.fromkeys(_zones(scene, which)))
    x = rows.elements.points[X]
    near = NEAR * float(np.ptp(x))
    parts = [RigidPart(np.abs(x - at) <= half + near, np.array([at, 0.0, 0.0])) for at, half in zones]
    coordinates = SolidCoordinates.of(rows.elements.points, body.half, held, parts).tied(tied)
    bed = 0.0 if clamp is None else clamp.stiffness / (rows.section(0.0).second_moment * (2 if body.half else 1))
    return SolidSpace(beam, rows, coordinates, zones, bed, scene.contraction)


def _zones(scene: SolidScene, which: Which) -> Iterable[tuple[float, float]]:
    """(position, half-width) m of the rigid zones of one body; a mass that is a block has none of its own."""
    if which == "beam":
        block = scene.solid.mass_size is not None
        return (scene.without("mass.rigid_half_width") if block else scene).rigid_zones
    return (zone for effect in scene.of(which) for zone in effect.rigid_zones)


def _carrying(space: SolidSpace, scene: SolidScene, which: Which) -> SparseStructure:
    """One body with the springs of its supports and the masses on it; its contact its patch, its output the tip."""
    structure = _bare(space)
    for support in space.beam.supports:
        for derivative, spring in enumerate(support.each):
            if 0 < spring < inf:
                row = space.section_row(support.position, derivative)
                structure = structure.with_(K=structure.K + spring * _outer(row))
    for x, mass, rotary, polar in _masses(scene, which):
        for row, inertia, moved in space.inertias(x, mass, rotary, polar):
            structure = structure.with_(
                M=structure.M + inertia * _outer(row),
                load=structure.load - inertia * moved * row,
                attached=(*structure.attached, row),
            )
    return structure


def _bare(space: SolidSpace) -> SparseStructure:
    """The body alone on its supports."""
    elements, body, basis = space.rows.elements, space.rows.body, space.coordinates.basis
    copies = 2.0 if body.half else 1.0
    stiffness = elements.stiffness(body.materials, body.material, space.contraction)
    if space.bed:
        stiffness = stiffness + _bedding(space)
    density = np.array([each.density for each in body.materials])[body.material]
    mass = elements.mass(density)
    moved = np.zeros(elements.size)
    moved[Z::3] = 1.0
    reduced = [copies * (basis.T @ (matrix @ basis)) for matrix in (mass, stiffness)]
    tip = space.surface_row(space.beam.length)
    contact = space.reduced(space.rows.patch("contact"))
    load, none = -copies * space.reduced(mass @ moved), np.zeros(basis.shape[1])
    return SparseStructure(reduced[0], 0 * reduced[0], reduced[1], load, none, contact, {"tip": tip}, {"tip": "m"})


def _bedding(space: SolidSpace) -> Any:
    """Stiffness (3 k, 3 k) of the springs along x under the face at x = 0."""
    from scipy.sparse import csc_array

    rows, columns, values = space.rows.bed(space.rows.body.section(0.0), X)
    return csc_array((space.bed * values, (rows, columns)), shape=(space.rows.elements.size,) * 2)


def _masses(scene: SolidScene, which: Which) -> Iterable[tuple[float, float, float, float]]:
    """Position (m), mass (kg), moments of inertia about y and about x (kg m²) of what one body carries."""
    if which == "beam" and scene.mass is not None and scene.solid.mass_size is None:
        rotary = sum((each.rotary_inertia for each in scene.named("mass.rotary_inertia")), 0.0)
        polar = sum((each.polar_inertia for each in scene.named("torsion")), 0.0)
        yield scene.mass.position, scene.mass.mass, rotary, polar
    for each in scene.named("added_mass"):
        if each.carried_by == which:
            yield each.position, each.mass, each.rotary_inertia or 0.0, 0.0


def _loaded(structure: SparseStructure, space: SolidSpace, scene: SolidScene) -> SparseStructure:
    """The first body with what reads it and with its weight."""
    outputs = {"sensor": space.surface_row(scene.sensor.position), **structure.outputs}
    units = dict.fromkeys(outputs, "m")
    for each in scene.outputs:
        outputs[each.name], units[each.name] = space.output_row(each), each.kind.unit
    for each in scene.named("further_stop"):
        sign = 1.0 if each.side == "above" else -1.0
        outputs[each.output], units[each.output] = sign * space.reduced(space.rows.patch(each.output)), "m"
    for each in scene.named(FieldPoints.name):
        found = field_rows(space, "beam", each.positions)
        outputs, units = outputs | found, units | dict.fromkeys(found, "m")
    structure = structure.with_(outputs=outputs, units=units)
    for each in scene.named("gravity"):
        structure = _weighed(structure, space, scene, each)
    return structure


def field_rows(space: SolidSpace, name: str, positions: Iterable[float]) -> dict[str, Array]:
    """Rows of deflection (m) and rotation (rad) of the sections at ``positions`` m, as ``FieldPoints`` names them."""
    sections = [space.rows.section(x) for x in positions]
    read: tuple[Callable[[SectionRows], Array], ...] = (lambda at: at.deflection, lambda at: at.slope)
    return {
        output: space.reduced(row(section))
        for derivative, row in enumerate(read)
        for output, section in zip(output_names(name, derivative, len(sections)), sections, strict=True)
    }


def _weighed(structure: SparseStructure, space: SolidSpace, scene: SolidScene, gravity: Any) -> SparseStructure:
    """The structure with its weight: across, static + g M r; along, the stiffness of the axial force N(x) of a beam.

    N is spread evenly over the section: K + ∫ N/A ∂u/∂x · ∂v/∂x dV. ValueError where a standing body buckles.
    """
    if gravity.direction == "transverse":
        return structure.with_(static=structure.static - gravity.acceleration * structure.load)
    downward = 1 if gravity.direction == "hanging" else -1
    axial = AxialGravity(downward * gravity.acceleration, scene.carrier, scene.weights)
    elements, body = space.rows.elements, space.rows.body
    x = elements.places(elements.quadrature[0])[X]
    force = axial.axial_force(x) / (2 if body.half else 1)
    basis = space.coordinates.basis
    stiffening = elements.initial_stress(force / space.rows.areas[:, None])
    added = (2.0 if body.half else 1.0) * (basis.T @ (stiffening @ basis))
    loaded = structure.with_(K=structure.K + added)
    if axial.acceleration < 0 and loaded.stiffness_factor.negative:
        raise ValueError(
            f"gravity: the standing solid buckles under {gravity.acceleration:.4g} m/s²: take a stiffer beam, a "
            "smaller mass, or hang it"
        )
    return loaded


def _meeting(structure: SparseStructure, other: Any, scene: SolidScene) -> SparseStructure:
    """Both bodies side by side: the contact reads w₁ − w₂ − a θ₂, with an arm a of the second's section."""
    space = solid_space(scene, "opposite")
    second = _carrying(space, scene, "opposite")
    meeting = second.contact
    if other.arm:
        meeting = space.section_row(other.position) + other.arm * space.section_row(other.position, 1)
    outputs = {"opposite": meeting, "opposite_tip": second.outputs["tip"]}
    for each in scene.named(FieldPoints.name):
        outputs |= field_rows(space, "opposite", each.opposite)
    second = second.with_(outputs=outputs, units=dict.fromkeys(outputs, "m"))
    for each in scene.named("gravity"):
        second = second.with_(static=second.static - each.acceleration * second.load)
    contact = np.concatenate([structure.contact, -meeting])
    return joined(structure, second, contact)


def joined(one: SparseStructure, two: SparseStructure, contact: Array) -> SparseStructure:
    """Both structures as one, as ``structure.side_by_side``."""
    from scipy.sparse import block_diag

    return side_by_side(one, two, contact, lambda a, b: block_diag((a, b), format="csc"))


def _outer(row: Array) -> Any:
    """rowᵀ row (n, n), sparse."""
    from scipy.sparse import csc_array

    one = csc_array(row[None])
    return (one.T @ one).tocsc()


def _padded(row: Array, size: int) -> Array:
    return np.concatenate([row, np.zeros(size - len(row))])
