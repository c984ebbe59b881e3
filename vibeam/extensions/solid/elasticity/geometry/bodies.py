"""Bodies of a scene: its beam, or the opposite one, as a mesh with what is bonded to it, and the patches on it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal

import numpy as np

from vibeam.extensions.solid.elasticity.body import SolidBody
from vibeam.extensions.solid.elasticity.geometry.families import CircularFamily, FlatFamily
from vibeam.extensions.solid.elasticity.geometry.grid import SolidGrid, drawn
from vibeam.extensions.solid.elasticity.geometry.parts import CIRCULAR, FLAT, MassBlocks, Piece, filled, known
from vibeam.extensions.solid.elasticity.plan import STUBBY, Solid
from vibeam.extensions.solid.elasticity.scene import SolidScene, heights
from vibeam_models.arrays import Index
from vibeam_models.beams.beam import Beam
from vibeam_models.beams.stretch import Material

SAME = 1e-9  # of the length: places along x that are one, and how far a facet may stand out of its patch
LAYER = (0.25, 0.75, 1.7, 3.5)  # of the section's height, from what holds its contraction
QUARTER = 0.5**0.5  # of the diameter: width of the quarter of a circular section that faces the stop

Which = Literal["beam", "opposite"]


@dataclass(frozen=True)
class Patch:
    """From ``start`` to ``end`` m along x, from ``left`` to ``right`` m in y, on the ``side`` above (1) or below (−1).

    ``edges``: half-widths (m) that need mesh lines of their own, inside the section.
    """

    name: str
    start: float
    end: float
    left: float
    right: float
    side: float
    edges: tuple[float, ...] = ()

    def facets(self, mesh: Any) -> Index:
        """Facets (k,) of the outer surface on its side that lie in it, of a half body those of y ≥ 0."""
        outer = mesh.boundary_facets()
        corners = mesh.p[:, mesh.facets[:, outer]]
        middle = corners.mean(axis=1)
        inside = mesh.p[:, mesh.t[:, mesh.f2t[0, outer]]].mean(axis=1)
        near = SAME * float(np.ptp(mesh.p[0]))
        level = np.ptp(corners[0], axis=0) > near
        level &= np.ptp(corners[1], axis=0) > near
        outward = self.side * (middle[2] - inside[2])
        facing = level & (outward > 0) & (self.side * middle[2] > 0)
        here = (middle[0] > self.start) & (middle[0] < self.end) & (middle[1] > self.left) & (middle[1] < self.right)
        return np.asarray(outer[facing & here])


def body_of(scene: SolidScene, which: Which = "beam") -> SolidBody:
    """The body of a scene's beam or of its opposite one, by ``scene.solid``; a half one where that is enough.

    Patches: "contact", those of further stops by the name of their output, both ends "start" and "end", and "clamp",
    of them what is clamped. Planes of the mesh: breaks, masses, supports, ends of rigid zones, edges of patches and of
    blocks, the drive's force. ValueError for what has no structured mesh.
    """
    beam = scene.carrier if which == "beam" else scene.named("opposite")[0].beam(scene)
    patches = list(_patches(scene, beam, which))
    half = not (scene.solid.whole or scene.named("torsion"))
    mesh, grid = _meshed(scene, beam, patches, which, half)
    ends = {"start": _plane(mesh, 0.0), "end": _plane(mesh, beam.length)}
    held = [ends[end] for end, how in zip(ends, beam.ends.split("-"), strict=True) if how == "clamped"]
    found = {patch.name: patch.facets(mesh) for patch in patches}
    named = {**ends, "clamp": np.concatenate([np.empty(0, int), *held]), **found}
    return SolidBody(mesh, grid.material, grid.materials, half, named, beam=grid.beam)


def _meshed(scene: SolidScene, beam: Beam, patches: Sequence[Patch], which: Which, half: bool) -> tuple[Any, SolidGrid]:
    solid, length = scene.solid, beam.length
    mass = _mass_blocks(scene, beam) if which == "beam" else None
    made = FlatFamily if _flat(beam, mass) else CircularFamily
    pairs = list(pairwise(_planes(scene, beam, patches, mass, which)))
    counts = [max(1, round((solid.along or beam.elements) * (end - start) / length)) for start, end in pairs]
    pieces = [_piece(beam, start, end, patches, mass, which) for start, end in pairs]
    sheared = made is FlatFamily and length < STUBBY * max(heights(beam))  # a core and rings are several through it
    family = made.of(pieces, -(-solid.across // 2), solid.through or (2 if sheared else 1))
    grid = drawn(pieces, counts, family.section())
    grid = grid if half else grid.whole()
    return family.mesh(grid), grid


def _flat(beam: Beam, mass: MassBlocks | None) -> bool:
    """Test whether all sections have flat faces, or all are circular; ValueError where they are neither."""
    shapes = {each.shape.name for each in beam.stretches}
    for name in shapes - {*FLAT, *CIRCULAR}:
        raise ValueError(f'solid: shape = "{name}" is no geometry: give a mesh of your own')
    if shapes & set(CIRCULAR) and (shapes & set(FLAT) or mass or any(plate.stiffens for plate in beam.plates)):
        raise ValueError("solid: circular sections with flat ones, plates or solid.mass_size: give a mesh of your own")
    return shapes <= set(FLAT)


def _piece(
    beam: Beam, start: float, end: float, patches: Sequence[Patch], mass: MassBlocks | None, which: Which
) -> Piece:
    middle = (start + end) / 2
    stretch = next(each for each in beam.stretches if each.start < middle < each.end).between(start, end)
    edges = (edge for patch in patches if patch.start < middle < patch.end for edge in patch.edges)
    blocks = tuple(filled(stretch, -1.0 if which == "beam" else 1.0, mass))
    return Piece(start, end, blocks, tuple(edges))


def _planes(
    scene: SolidScene, beam: Beam, patches: Sequence[Patch], mass: MassBlocks | None, which: Which
) -> list[float]:
    """Places (m) along x that are planes of the mesh, ascending."""
    effects = scene.of(which)
    zones = [zone for effect in effects for zone in effect.rigid_zones]
    weights = [x for effect in effects for _, x in effect.weights]
    places = [*beam.breaks, *weights, *_taper_planes(beam, scene.solid.along or beam.elements)]
    if which == "beam":
        zones += scene.rigid_zones
        places += [x for _, x in scene.weights] + ([] if scene.base.at is None else [scene.base.at])
    else:
        places += [each.position for each in scene.named("opposite")]
    places += [x for middle, half in zones for x in (middle - half, middle, middle + half)]
    places += [x for patch in patches for x in (patch.start, patch.end)] + ([mass.start, mass.end] if mass else [])
    places += _layer_planes(beam, scene.solid, [*zones, *([mass.extent] if mass else [])])
    found: list[float] = []
    for x in sorted(x for x in places if 0 <= x <= beam.length):
        if not found or x - found[-1] > SAME * beam.length:
            found.append(x)
    return found


def _layer_planes(beam: Beam, solid: Solid, stiff: Iterable[tuple[float, float]]) -> Iterator[float]:
    """Planes of the boundary layer, as deep as the section is high, beside what holds the section's contraction.

    That are clamped ends that hold it, and both sides of what is stiff, each by its middle and half-width in m.
    """
    ends = zip((0.0, beam.length), (1, -1), beam.ends.split("-"), strict=True)
    held = [(x, way) for x, way, how in ends if how == "clamped" and solid.clamp == "held"]
    held += [(middle + way * half, way) for middle, half in stiff if half for way in (1, -1)]
    for x, way in held:
        depth = beam.height_at(min(max(x, 0.0), beam.length))
        away = (share * depth for share in LAYER)
        yield from (x + way * each for each in away if each < beam.length / (solid.along or beam.elements))


def _taper_planes(beam: Beam, along: int) -> Iterator[float]:
    """Planes in tapers with mass that does not stiffen, whose density there varies from element to element."""
    for each in beam.stretches:
        if each.far is not None and (each.added or any(not plate.stiffens for plate in each.plates)):
            share = (each.end - each.start) / beam.length
            yield from np.linspace(each.start, each.end, 1 + max(1, round(along * share)))


def _patches(scene: SolidScene, beam: Beam, which: Which) -> Iterator[Patch]:
    if which == "opposite":
        yield _patch("contact", scene.named("opposite")[0].position, beam, scene, -1.0)
        return
    yield _patch("contact", scene.stop.position, beam, scene, 1.0)
    for stop in scene.named("further_stop"):
        yield _patch(stop.output, stop.position, beam, scene, 1.0 if stop.side == "above" else -1.0)


def _patch(name: str, x: float, beam: Beam, scene: SolidScene, side: float) -> Patch:
    """Patch about ``x`` m as the case says, or as ``Solid.contact``; what of it is beyond the beam is cut off."""
    height, half, circular = beam.height_at(x), _half_width(beam, x), beam.stretch_at(x).shape.name in CIRCULAR
    twisted = scene.named("torsion")
    usual = min(height, 2 * half) if twisted else 2 * half * (QUARTER if circular else 1)
    length, width = scene.solid.contact or (height, usual)
    middle = twisted[0].eccentricity if twisted else 0.0
    if scene.solid.contact and (reach := abs(middle) + width / 2) > half * (1 + SAME):
        raise ValueError(f"solid.contact: reaches {1e3 * reach:g} mm off the axis of a beam {2e3 * half:g} mm wide")
    start, end = max(0.0, x - length / 2), min(beam.length, x + length / 2)
    widest = max(_half_width(beam, each) for each in (start, end)) * (QUARTER if circular else 1)
    sides = [middle - width / 2, middle + width / 2]
    edges = tuple(abs(y) for y in sides if abs(y) < half * (1 - SAME) and y and not (circular and width == usual))
    left, right = (y if abs(y) in edges or not y else y / abs(y) * widest for y in sides)
    return Patch(name, start, end, left, right, side, edges)


def _half_width(beam: Beam, x: float) -> float:
    section = beam.stretch_at(x).section(np.array(x))
    return float(getattr(section, "width", section.height) or np.nan) / 2


def _mass_blocks(scene: SolidScene, beam: Beam) -> MassBlocks | None:
    """The attached mass as blocks, where the case gives their size; their density from their volume."""
    if scene.solid.mass_size is None or scene.mass is None:
        return None
    length, width, height = scene.solid.mass_size
    start, end = scene.mass.position - length / 2, scene.mass.position + length / 2
    if start < 0 or end > beam.length * (1 + SAME):
        raise ValueError(f"solid.mass_size: {1e3 * length:g} mm about mass.position reach beyond an end of the beam")
    density = scene.mass.mass / (2 * (end - start) * width * height)
    modulus = scene.solid.mass_youngs_modulus or beam.youngs_modulus
    ratio = beam.poissons_ratio if modulus == beam.youngs_modulus else None
    return MassBlocks(start, end, width, height, known(Material(modulus, density, ratio)))


def _plane(mesh: Any, x: float) -> Index:
    outer = mesh.boundary_facets()
    near = SAME * float(np.ptp(mesh.p[0]))
    return np.asarray(outer[np.all(np.abs(mesh.p[0][mesh.facets[:, outer]] - x) <= near, axis=0)])
