"""SolidScene -> SparseStructure: the rig's body on its supports, with masses, stop, sensor and effects."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from math import inf
from typing import Any

import numpy as np

from vibeam.extensions.solid.elasticity.constraints import HALF, RigidPart, SolidCoordinates, holding
from vibeam.extensions.solid.elasticity.geometry.bodies import Which, body_of
from vibeam.extensions.solid.elasticity.rows import NEAR, SolidRows, X, Z
from vibeam.extensions.solid.elasticity.scene import SolidScene
from vibeam.extensions.solid.elasticity.slender import SlenderElements
from vibeam.extensions.solid.elasticity.space import BodySpace, RigidMass, SolidField, outer
from vibeam_models.arrays import Array
from vibeam_models.beam import check_positions
from vibeam_models.beams.beam import Beam
from vibeam_models.effects.field_points import FieldPoints, output_names
from vibeam_models.effects.gravity import AxialGravity
from vibeam_models.outputs import Output, surface_distance
from vibeam_models.scene import Effect, Sensor
from vibeam_models.sparse import SparseStructure
from vibeam_models.structure import side_by_side

KEPT = 2  # structures, without what reads them: two fidelities of a case
#: effects that are more than another beam
KNOWN = (
    *("added_mass", "mass.rotary_inertia", "mass.rigid_half_width", "torsion"),
    *("further_stop", "opposite", "gravity", FieldPoints.name),
)
UP = np.array([0.0, 0.0, 1.0])  # the base's motion


def solid_structure(scene: SolidScene) -> SparseStructure:
    """The structure of a solid scene: as ``beam.assemble`` of the beam's, its coordinates y with u = Z y.

    The contact is the mean displacement toward the stop over its patch; sensor, tip and outputs read the surface on
    the line y = 0, a strain over a gauge as long as the section is high. Scenes that differ in these alone share M, K
    and modes. ValueError as ``beam.assemble``.
    """
    check_positions(scene)
    for effect in scene.effects:
        if type(effect).apply is not Effect.apply and effect.name not in KNOWN:
            raise ValueError(f"{effect.name}: is not known of a solid: take it out, or leave the model a beam")
    plain = _without_readings(scene)
    structure, spaces = _unread(plain), _spaces(plain)
    space = spaces["beam"]
    own = {"sensor": space.surface_row(scene.sensor.position), "tip": space.surface_row(scene.beam.length)}
    own.update((each.name, space.output_row(each)) for each in scene.outputs)
    rows = {name: np.pad(row, (0, structure.size - len(row))) for name, row in own.items()}
    rows.update(structure.outputs)
    for points in scene.named(FieldPoints.name):
        for which, space in spaces.items():
            rest = structure.size - space.size
            around = (0, rest) if which == "beam" else (rest, 0)
            found = space.field_rows(which, points.positions if which == "beam" else points.opposite)
            rows.update((name, np.pad(row, around)) for name, row in found.items())
    units = dict.fromkeys(rows, "m") | {each.name: each.kind.unit for each in scene.outputs}
    return structure.with_(outputs=rows, units=units)


def _without_readings(scene: SolidScene) -> SolidScene:
    plain: SolidScene = scene.structural().without(FieldPoints.name)
    return replace(plain, sensor=Sensor(scene.beam.length), outputs=())


@lru_cache(maxsize=KEPT)
def _unread(scene: SolidScene) -> SparseStructure:
    space = _spaces(scene)["beam"]
    structure = _weighed(_carrying(space, scene, "beam"), space, scene)
    further = {
        each.output: (1.0 if each.side == "above" else -1.0) * space.reduced(space.rows.patch(each.output))
        for each in scene.named("further_stop")
    }
    structure = structure.with_(outputs=further)
    for other in scene.named("opposite"):
        structure = _meeting(structure, _spaces(scene)["opposite"], other, scene)
    place = scene.base.on_beam
    if place is not None:
        load = -space.section_row(*place)
        structure = structure.with_(load=np.pad(load, (0, structure.size - len(load))))
    return structure.with_(damping=scene.beam.damping)


@lru_cache(maxsize=KEPT)
def _spaces(scene: SolidScene) -> Mapping[Which, SolidSpace]:
    bodies: tuple[Which, ...] = ("beam", "opposite") if scene.named("opposite") else ("beam",)
    return {which: solid_space(scene, which) for which in bodies}


@dataclass(frozen=True, eq=False)
class SolidSpace(BodySpace):
    """The body of a ``beam`` on its supports; ``zones``: place (m) of each rigid zone, in the order of their parts."""

    beam: Beam
    zones: tuple[float, ...] = ()

    def section_row(self, x: float, derivative: int = 0) -> Array:
        """Row (n,) of mean deflection (0) or rotation (1) of the section at ``x`` m."""
        return self.reduced(self.rows.section(x)[1 + derivative])

    def surface_row(self, x: float) -> Array:
        """Row (n,) of the deflection of the upper surface at ``x`` m on the line y = 0."""
        return self.reduced(self.rows.point(np.array([x, 0.0, self.beam.height_at(x) / 2])))

    def output_row(self, output: Output) -> Array:
        """Row (n,) that an output reads; ValueError for a strain at no place of the body."""
        if output.quantity == "slope":
            return self.section_row(output.position, 1)
        if output.quantity != "strain":
            return self.surface_row(output.position)
        distance = surface_distance(self.beam, output.position) if output.distance is None else output.distance
        if distance is None:
            raise ValueError(f"output {output.name}: no distance from the neutral axis is given, nor known there")
        return self.strain_row(output.position, distance)

    def strain_row(self, x: float, distance: float) -> Array:
        """Row (n,) of the mean strain of a gauge as long as the section is high, at that ``distance`` below the axis.

        Along a taper the gauge stays in the same share of the height: (Δx Δu_x + Δz Δu_z)/(Δx² + Δz²).
        """
        height = self.beam.height_at(x)
        along = max(0.0, x - height / 2), min(self.beam.length, x + height / 2)
        ends = np.array([(end, 0.0, -distance * self.beam.height_at(end) / height) for end in along])
        span = ends[1] - ends[0]
        low, high = (span[X] * self.rows.point(end, X) + span[Z] * self.rows.point(end, Z) for end in ends)
        return self.reduced((high - low) / (span @ span))

    def field_rows(self, name: str, positions: Iterable[float]) -> dict[str, Array]:
        """Rows of deflection (m) and rotation (rad) of sections at ``positions`` m, as ``FieldPoints`` names them."""
        found = [[self.reduced(row) for row in self.rows.section(x)[1:3]] for x in positions]
        names = [output_names(name, derivative, len(found)) for derivative in (0, 1)]
        return {names[which][at]: row for which in (0, 1) for at, row in enumerate(each[which] for each in found)}

    def part(self, x: float) -> Array:
        """Rows (3 or 6, n) of the motions of the rigid zone at ``x`` m, or of the section there as a whole."""
        if x in self.zones:
            return self.coordinates.parts[self.zones.index(x)]
        motions = self.rows.section(x)
        return self.reduced(motions[: HALF if self.rows.body.half else None])


def solid_space(scene: SolidScene, which: Which = "beam") -> SolidSpace:
    """The body of a scene, ``"beam"`` or ``"opposite"``, on its supports; nothing is assembled yet."""
    body = body_of(scene, which)
    elements = SlenderElements(body.mesh)
    rows = SolidRows(body, elements)
    beam = scene.shaped_beam if which == "beam" else scene.named("opposite")[0].beam(scene)
    bedded = which == "beam" and bool(scene.named("clamp"))
    held, tied = holding(rows, beam, scene.solid.clamp == "sliding", bedded)
    zones = dict(_zones(scene, which))
    x = rows.elements.points[X]
    near = NEAR * float(np.ptp(x))
    parts = [
        RigidPart(f"rigid zone at {at:g} m", np.abs(x - at) <= half + near, np.array([at, 0.0, 0.0]))
        for at, half in zones.items()
    ]
    coordinates = SolidCoordinates.of(elements.points, body.half, held, parts, elements.relative).tied(tied)
    return SolidSpace(rows, coordinates, beam, tuple(zones))


def solid_fields(scene: SolidScene) -> dict[str, SolidField]:
    """Displacements of the body, ``"beam"``, and of the ``"opposite"`` one, by the coordinates of the structure."""
    spaces = _spaces(_without_readings(scene))
    sizes = [space.size for space in spaces.values()]
    return {
        which: space.field(sum(sizes[:index]), sum(sizes[index + 1 :]))
        for index, (which, space) in enumerate(spaces.items())
    }


def _zones(scene: SolidScene, which: Which) -> Iterable[tuple[float, float]]:
    """(position, half-width) m of the rigid zones of one body; a mass that is a block has none of its own."""
    if which == "beam":
        return (scene.without("mass.rigid_half_width") if scene.solid.mass_size else scene).rigid_zones
    return (zone for effect in scene.of(which) for zone in effect.rigid_zones)


def _carrying(space: SolidSpace, scene: SolidScene, which: Which) -> SparseStructure:
    """One body with the springs of its supports and the masses on it; its contact its patch."""
    rows = space.rows
    structure = space.structure(UP, space.reduced(rows.patch("contact")), scene.contraction)
    for clamp in scene.named("clamp") if which == "beam" else ():
        structure = structure.with_(K=structure.K + space.congruent(_bedding(rows, clamp.stiffness)))
    for support in space.beam.supports:
        for derivative, spring in enumerate(support.each):
            if 0 < spring < inf:
                row = space.section_row(support.position, derivative)
                structure = structure.with_(K=structure.K + spring * outer(row))
    for x, carried in _masses(scene, which):
        structure = carried.on(structure, space.part(x), UP)
    return structure


def _bedding(rows: SolidRows, stiffness: float) -> Any:
    """Stiffness (3 k, 3 k) of springs along x under the face at x = 0, ``stiffness`` N m/rad against its rotation."""
    bed = rows.bed(rows.body.patches["start"], X)
    heights = np.zeros(rows.elements.size)
    heights[X::3] = rows.elements.points[Z]
    return stiffness / (heights @ (bed @ heights) * (2 if rows.body.half else 1)) * bed


def _masses(scene: SolidScene, which: Which) -> Iterator[tuple[float, RigidMass]]:
    """Position (m) of what one body carries; of a mass that is a block nothing but the place where it is attached."""
    if which == "beam" and scene.mass is not None:
        rotary = sum((each.rotary_inertia for each in scene.named("mass.rotary_inertia")), 0.0)
        polar = sum((each.polar_inertia for each in scene.named("torsion")), 0.0)
        block = scene.solid.mass_size is not None
        yield scene.mass.position, RigidMass(0.0) if block else RigidMass(scene.mass.mass, rotary, rotary, polar)
    for each in scene.named("added_mass"):
        if each.carried_by == which:
            rotary = each.rotary_inertia or 0.0
            yield each.position, RigidMass(each.mass, rotary, rotary)


def _weighed(structure: SparseStructure, space: SolidSpace, scene: SolidScene) -> SparseStructure:
    """The first body with its weight: across, static + g M r; along, the stiffness of the axial force N(x) of a beam.

    N is spread evenly over the section: K + ∫ N/A ∂u/∂x · ∂v/∂x dV. ValueError where a standing body buckles.
    """
    for gravity in scene.named("gravity"):
        if gravity.direction == "transverse":
            structure = structure.with_(static=structure.static - gravity.acceleration * structure.load)
            continue
        downward = 1 if gravity.direction == "hanging" else -1
        axial = AxialGravity(downward * gravity.acceleration, scene.carrier, scene.weights)
        rows = space.rows
        force = axial.axial_force(rows.elements.places(rows.elements.quadrature[0])[X]) / (2 if rows.body.half else 1)
        stiffening = rows.elements.initial_stress(force / rows.areas[:, None])
        structure = structure.with_(K=structure.K + space.congruent(stiffening))
        if downward < 0 and structure.stiffness_factor.negative:
            raise ValueError(
                f"gravity: the standing solid buckles under {gravity.acceleration:.4g} m/s²: take a stiffer beam, a "
                "smaller mass, or hang it"
            )
    return structure


def _meeting(structure: SparseStructure, space: SolidSpace, other: Any, scene: SolidScene) -> SparseStructure:
    """Both bodies side by side: the contact reads w₁ − w₂ − a θ₂, with an arm a of the second's section."""
    from scipy.sparse import block_diag

    second = _carrying(space, scene, "opposite")
    meeting = second.contact
    if other.arm:
        meeting = space.section_row(other.position) + other.arm * space.section_row(other.position, 1)
    outputs = {"opposite": meeting, "opposite_tip": space.surface_row(space.beam.length)}
    second = second.with_(outputs=outputs)
    for each in scene.named("gravity"):
        second = second.with_(static=second.static - each.acceleration * second.load)
    contact = np.concatenate([structure.contact, -meeting])
    return side_by_side(structure, second, contact, lambda one, two: block_diag((one, two), format="csc"))
