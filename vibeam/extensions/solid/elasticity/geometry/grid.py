"""SolidGrid: filled hexahedra between the cross-sections of a body, of one half or both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from vibeam.extensions.solid.elasticity.geometry.parts import Piece, SolidBlock
from vibeam_models.arrays import Array, Flags, Index
from vibeam_models.beams.stretch import Material

#: corners of a cell, by 0 and 1 along x, y, z, in the order of scikit-fem's hexahedra
CORNERS = ((0, 0, 0), (0, 0, 1), (0, 1, 0), (1, 0, 0), (0, 1, 1), (1, 0, 1), (1, 1, 0), (1, 1, 1))
MIRRORED = [CORNERS.index((a, 1 - b, c)) for a, b, c in CORNERS]


@dataclass(frozen=True, eq=False)
class CrossSection:
    """Quadrilaterals of all cross-sections: ``places`` (planes, 2, nodes) m in the planes between the pieces.

    ``quads`` (4, k): nodes at (0, 0), (0, 1), (1, 0), (1, 1) of its two directions; ``middles`` (planes, 2, k): what
    blocks are asked whether they cover.
    """

    places: Array
    quads: Index
    middles: Array


@dataclass(frozen=True, eq=False)
class SolidGrid:
    """Hexahedra ``cells`` (8, k) between ``points`` (3, n) m; of each its index in ``materials``, and whether it is of
    the beam itself."""

    points: Array
    cells: Index
    material: Index
    materials: tuple[Material, ...]
    beam: Flags

    def whole(self) -> SolidGrid:
        """Both halves of that of y ≥ 0, joined in the plane y = 0."""
        count = self.points.shape[1]
        off = self.points[1] > 0
        image = np.arange(count)
        image[off] = count + np.arange(np.count_nonzero(off))
        other = self.points[:, off] * np.array([[1.0], [-1.0], [1.0]])
        return replace(
            self,
            points=np.hstack([self.points, other]),
            cells=np.hstack([self.cells, image[self.cells][MIRRORED]]),
            material=np.tile(self.material, 2),
            beam=np.tile(self.beam, 2),
        )


def drawn(pieces: Sequence[Piece], counts: Sequence[int], section: CrossSection) -> SolidGrid:
    """SolidGrid of ``pieces`` in so many cells each along x; linear between the planes.

    ValueError where two that follow one another do not touch in an area.
    """
    blocks = [_covering(piece, section.middles[i : i + 2].mean(axis=0)) for i, piece in enumerate(pieces)]
    for piece, found, following in zip(pieces[1:], blocks, blocks[1:], strict=False):
        if not any(one and other for one, other in zip(found, following, strict=True)):
            at = f"{1e3 * piece.start:g} mm"
            raise ValueError(f"solid: the sections before and after {at} share no area: let one reach into the other")
    layers = [found for found, count in zip(blocks, counts, strict=True) for _ in range(count)]
    nodes = section.places.shape[2]
    cells, kinds = [], []
    for i, found in enumerate(layers):
        here = [q for q, each in enumerate(found) if each is not None]
        quads = section.quads[:, here] + nodes * i
        cells.append(np.stack([quads[2 * b + c] + nodes * a for a, b, c in CORNERS]))
        kinds += [(each.material, each.beam) for each in found if each is not None]
    return _compact(_points(pieces, counts, section.places), np.hstack(cells), kinds)


def _covering(piece: Piece, middles: Array) -> list[SolidBlock | None]:
    """The first block over each middle (2, k) of a piece's cross-section halfway along it; None: void."""
    found: list[SolidBlock | None] = [None] * middles.shape[1]
    for block in reversed(piece.blocks):
        (low, high), (bottom, top) = block.across.mean(axis=1), block.height.mean(axis=1)
        inside = (middles[0] > low) & (middles[0] < high) & (middles[1] > bottom) & (middles[1] < top)
        for q in np.flatnonzero(inside):
            found[q] = block
    return found


def _points(pieces: Sequence[Piece], counts: Sequence[int], places: Array) -> Array:
    x = [np.array([pieces[0].start])]
    rows = [places[:1]]
    for i, (piece, count) in enumerate(zip(pieces, counts, strict=True)):
        share = np.linspace(0, 1, count + 1)[1:]
        x.append(piece.start + share * (piece.end - piece.start))
        rows.append(places[i] + share[:, None, None] * (places[i + 1] - places[i]))
    there, across = np.concatenate(x), np.concatenate(rows)
    along = np.broadcast_to(there[:, None], (len(there), across.shape[2]))
    return np.stack([along.ravel(), across[:, 0].ravel(), across[:, 1].ravel()])


def _compact(points: Array, cells: Index, kinds: Sequence[tuple[Material, bool]]) -> SolidGrid:
    """The grid without the points that no cell has."""
    used, numbers = np.unique(cells, return_inverse=True)
    materials = tuple(dict.fromkeys(material for material, _ in kinds))
    material = np.array([materials.index(each) for each, _ in kinds])
    beam = np.array([of for _, of in kinds])
    return SolidGrid(np.ascontiguousarray(points[:, used]), numbers.reshape(cells.shape), material, materials, beam)
