"""Bodies of a scene: its beam, or the opposite one, as a mesh with what is bonded to it, and the patches on it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Literal

import numpy as np

from vibeam_models.beams.beam import Beam
from vibeam_models.beams.stretch import Material
from vibeam_models.solid.body import SolidBody
from vibeam_models.solid.geometry.flat import flat_section
from vibeam_models.solid.geometry.grid import SolidGrid, drawn
from vibeam_models.solid.geometry.parts import FLAT, MassBlocks, Piece, filled, known
from vibeam_models.solid.geometry.patches import Patch, plane
from vibeam_models.solid.scene import SolidScene

SAME = 1e-9  # of the length: places along x that are one

Which = Literal["beam", "opposite"]


def body_of(scene: SolidScene, which: Which = "beam") -> SolidBody:
    """The body of a scene's beam or of its opposite one, by ``scene.solid``; a half one where that is enough.

    Patches: "contact", those of further stops by the name of their output, both ends "start" and "end", and "clamp",
    of them what is clamped. Planes of the mesh: breaks, masses, supports, ends of rigid zones, edges of patches and of
    blocks, the drive's force. ValueError for what has no structured mesh.
    """
    from skfem import MeshHex

    beam = scene.carrier if which == "beam" else scene.named("opposite")[0].beam(scene)
    patches = list(_patches(scene, beam, which))
    grid = _grid(scene, beam, patches, which)
    half = not (scene.solid.whole or scene.named("torsion"))
    grid = grid if half else grid.whole()
    mesh = MeshHex(grid.points, grid.cells.astype(np.int32))
    ends = {"start": plane(mesh, 0.0), "end": plane(mesh, beam.length)}
    held = [ends[end] for end, how in zip(ends, beam.ends.split("-"), strict=True) if how == "clamped"]
    found = {patch.name: patch.facets(mesh) for patch in patches}
    named = {**ends, "clamp": np.concatenate([np.empty(0, int), *held]), **found}
    return SolidBody(mesh, grid.material, grid.materials, half, named, beam=grid.beam)


def _grid(scene: SolidScene, beam: Beam, patches: Sequence[Patch], which: Which) -> SolidGrid:
    solid = scene.solid
    mass = _mass_blocks(scene, beam) if which == "beam" else None
    along = solid.along or beam.elements
    planes = _planes(scene, beam, patches, mass, which)
    counts = [max(1, round(along * (end - start) / beam.length)) for start, end in pairwise(planes)]
    pieces = [_piece(beam, start, end, patches, mass, which) for start, end in pairwise(planes)]
    return drawn(pieces, counts, flat_section(pieces, -(-solid.across // 2), solid.through))


def _piece(
    beam: Beam, start: float, end: float, patches: Sequence[Patch], mass: MassBlocks | None, which: Which
) -> Piece:
    middle = (start + end) / 2
    stretch = next(each for each in beam.stretches if each.start < middle < each.end).between(start, end)
    if stretch.shape.name not in FLAT:
        raise ValueError(f'solid: a section of shape = "{stretch.shape.name}" has no mesh: give one of your own')
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
    found: list[float] = []
    for x in sorted(x for x in places if 0 <= x <= beam.length):
        if not found or x - found[-1] > SAME * beam.length:
            found.append(x)
    return found


def _taper_planes(beam: Beam, along: int) -> Iterator[float]:
    """Planes in tapers with mass that does not stiffen, whose density there varies from element to element."""
    for each in beam.stretches:
        if each.far is not None and (each.added or any(not plate.stiffens for plate in each.plates)):
            share = (each.end - each.start) / beam.length
            yield from np.linspace(each.start, each.end, 1 + max(1, round(along * share)))


def _patches(scene: SolidScene, beam: Beam, which: Which) -> Iterator[Patch]:
    """Patches that the stops meet."""
    if which == "opposite":
        yield _patch("contact", scene.named("opposite")[0].position, beam, scene, -1.0)
        return
    yield _patch("contact", scene.stop.position, beam, scene, 1.0)
    for stop in scene.named("further_stop"):
        yield _patch(stop.output, stop.position, beam, scene, 1.0 if stop.side == "above" else -1.0)


def _patch(name: str, x: float, beam: Beam, scene: SolidScene, side: float) -> Patch:
    """Patch about ``x`` m as the case says; what of it is beyond an end of the beam is cut off."""
    height, width = _extent(beam, x)
    twisted = scene.named("torsion")
    length, across = scene.solid.contact or (height, min(height, width) if twisted else width)
    middle = twisted[0].eccentricity if twisted else 0.0
    reach = abs(middle) + across / 2
    if reach > width / 2 * (1 + SAME):
        raise ValueError(f"solid.contact: reaches {1e3 * reach:g} mm off the axis of a beam {1e3 * width:g} mm wide")
    start, end = max(0.0, x - length / 2), min(beam.length, x + length / 2)
    inside = reach < width / 2 * (1 - SAME)
    if not inside:
        across = max(_extent(beam, each)[1] for each in (start, end))
    return Patch(name, start, end, middle - across / 2, middle + across / 2, side, inside)


def _extent(beam: Beam, x: float) -> tuple[float, float]:
    """Height and width in m of the section at ``x`` m, where two stretches meet of the later one."""
    section = next(each for each in reversed(beam.stretches) if each.start <= x <= each.end).section(np.array(x))
    height = float(section.height or np.nan)
    return height, float(getattr(section, "width", height))


def _mass_blocks(scene: SolidScene, beam: Beam) -> MassBlocks | None:
    """The attached mass as blocks, where the case gives their size; their density from their volume."""
    if scene.solid.mass_size is None or scene.mass is None:
        return None
    length, width, height = scene.solid.mass_size
    start, end = max(0.0, scene.mass.position - length / 2), min(beam.length, scene.mass.position + length / 2)
    density = scene.mass.mass / (2 * (end - start) * width * height)
    modulus = scene.solid.mass_youngs_modulus or beam.youngs_modulus
    ratio = beam.poissons_ratio if modulus == beam.youngs_modulus else None
    return MassBlocks(start, end, width, height, known(Material(modulus, density, ratio)))
