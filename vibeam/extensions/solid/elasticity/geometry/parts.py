"""Parts of a body: what fills each piece between two planes across it, as blocks whose edges are linear in x."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from vibeam.extensions.solid.elasticity.scene import assumed_poissons_ratio
from vibeam_models.arrays import Array
from vibeam_models.beams.stretch import Material, Plate, Stretch

EVERYWHERE = np.array([[-1.0, -1.0], [1.0, 1.0]])  # height of a ring, whose only extent is its radius


@dataclass(frozen=True, eq=False)
class SolidBlock:
    """Filled part of a piece: ``across`` (y ≥ 0, or radii) and ``height`` (z) m, each [from, to] × [start, end]."""

    across: Array
    height: Array
    material: Material
    beam: bool = True


@dataclass(frozen=True, eq=False)
class Piece:
    """The body from ``start`` to ``end`` m along x: its ``blocks``, the first that covers a place fills it.

    ``edges``: half-widths (m) of patches on its surface, which are mesh lines.
    """

    start: float
    end: float
    blocks: tuple[SolidBlock, ...]
    edges: tuple[float, ...] = ()


Box = tuple[Any, Any, Any, Any]  # across from, to; height from, to: each one number at the start and one at the end


def _rectangle(s: Mapping[str, Array]) -> list[Box]:
    return [(0, s["width"] / 2, -s["thickness"] / 2, s["thickness"] / 2)]


def _hollow(s: Mapping[str, Array]) -> list[Box]:
    b, t = s["width"] / 2, s["thickness"] / 2
    inner = t - s["wall"]
    return [(0, b, inner, t), (0, b, -t, -inner), (b - s["wall"], b, -inner, inner)]


def _i_section(s: Mapping[str, Array]) -> list[Box]:
    b, t = s["width"] / 2, s["thickness"] / 2
    inner = t - s["flange"]
    return [(0, b, inner, t), (0, b, -t, -inner), (0, s["web"] / 2, -inner, inner)]


#: of every shape with flat faces: its filled boxes
FLAT: dict[str, Callable[[Mapping[str, Array]], list[Box]]] = {
    "rectangle": _rectangle,
    "hollow rectangle": _hollow,
    "I": _i_section,
}

#: of every circular shape: inner and outer radius
CIRCULAR: dict[str, Callable[[Mapping[str, Array]], Box]] = {
    "round": lambda s: (0, s["diameter"] / 2, *EVERYWHERE),
    "tube": lambda s: (s["outer_diameter"] / 2 - s["wall"], s["outer_diameter"] / 2, *EVERYWHERE),
}


@dataclass(frozen=True)
class MassBlocks:
    """The mass as two blocks, above and below, ``width`` × ``height`` m across, from ``start`` to ``end`` m."""

    start: float
    end: float
    width: float
    height: float
    material: Material

    @property
    def extent(self) -> tuple[float, float]:
        """Middle and half-length in m."""
        return (self.start + self.end) / 2, (self.end - self.start) / 2


def filled(stretch: Stretch, upward: float, mass: MassBlocks | None = None) -> Iterator[SolidBlock]:
    """Blocks of a stretch of the beam, of the plates bonded to it, and of the mass where that is.

    Plates lie on one another; one-sided ones ``upward`` (1) or down (−1). What does not stiffen is added to the
    beam's density.
    """
    section, shape = _dimensions(stretch), stretch.shape.name
    weighs = stretch.added + sum(plate.mass_per_length for plate in stretch.plates if not plate.stiffens)
    area = float(stretch.section(np.array((stretch.start + stretch.end) / 2)).area_times(1.0))
    own = known(replace(stretch.material, density=stretch.material.density + weighs / area))
    boxes = [CIRCULAR[shape](section)] if shape in CIRCULAR else FLAT[shape](section)
    yield from (block(box, own) for box in boxes)
    bonded = [layer for plate in stretch.plates if plate.stiffens for layer in _layers(plate, stretch.material, upward)]
    if mass is not None and mass.start < (stretch.start + stretch.end) / 2 < mass.end:
        bonded += [(side, mass.width, mass.height, mass.material) for side in (1.0, -1.0)]
    yield from _stacked(bonded, section["thickness"] / 2) if bonded else ()


Layer = tuple[float, float, float, Material]  # side (1 above, −1 below), width, height


def _layers(plate: Plate, beam: Material, upward: float) -> Iterator[Layer]:
    ratio = beam.poissons_ratio if plate.youngs_modulus == beam.youngs_modulus else None
    material = known(Material(plate.youngs_modulus, plate.density, ratio))
    for side in (upward, -upward)[: plate.sides]:
        yield side, plate.width, plate.thickness, material


def _stacked(layers: Iterable[Layer], surface: Array) -> Iterator[SolidBlock]:
    """Blocks of layers, each on those before it, on the beam's ``surface`` at ± that height (start, end) m."""
    tops = {1.0: surface, -1.0: surface}
    for side, width, height, material in layers:
        low, high = tops[side], tops[side] + height
        heights = (low, high) if side > 0 else (-high, -low)
        tops[side] = high
        yield block((0, width / 2, *heights), material, beam=False)


def block(box: Box, material: Material, *, beam: bool = True) -> SolidBlock:
    """The block that fills a box."""
    low, high, bottom, top = (np.broadcast_to(np.asarray(each, float), 2) for each in box)
    return SolidBlock(np.array([low, high]), np.array([bottom, top]), material, beam)


def known(material: Material) -> Material:
    """The material with Poisson's ratio, by its modulus where it is not said."""
    if material.poissons_ratio is not None:
        return material
    return replace(material, poissons_ratio=assumed_poissons_ratio(material.youngs_modulus)[0])


def _dimensions(stretch: Stretch) -> dict[str, Array]:
    ends = [stretch.section(np.array(x)) for x in (stretch.start, stretch.end)]
    return {name: np.array([float(getattr(each, name)) for each in ends]) for name in vars(ends[0])}
