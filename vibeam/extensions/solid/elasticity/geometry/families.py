"""Families of sections: with flat faces, as straight hexahedra; circular ones, as curved ones.

Flat: rectangles, hollow ones and I sections, with plates and blocks. Circular: a square core and rings around it, or a
tube's rings alone. Their cells are straight in a plane of parameters (u, v), where every circle is a square: the core
is max(|u|, |v|) ≤ 1, the radii follow one another at 2, 3, …; a point of a square is carried to its circle at the angle
π/4 · u/v.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from vibeam.extensions.solid.elasticity.geometry.grid import CrossSection, SolidGrid
from vibeam.extensions.solid.elasticity.geometry.lines import Line, continued_lines
from vibeam.extensions.solid.elasticity.geometry.parts import Piece
from vibeam_models.arrays import Array

CORE = 0.45  # half the core's side, of the innermost radius
EIGHTH = np.pi / 4
SLIVER = 0.02  # of an eighth: the edge of a patch on a taper is at one angle


@dataclass(frozen=True, eq=False)
class FlatFamily:
    """Pieces with flat faces: lines ``y`` ≥ 0 and ``z`` (planes, lines) m of their cross-sections."""

    y: Array
    z: Array

    @classmethod
    def of(cls, pieces: Sequence[Piece], across: int, through: int) -> FlatFamily:
        """The family with ``across`` cells over the beam's half-width, ``through`` over each layer."""
        blocks = [block for piece in pieces for block in piece.blocks]
        size = max(float(np.max(np.abs([block.across, block.height]))) for block in blocks)
        edges = [[(edge, edge) for edge in piece.edges] for piece in pieces]
        y = continued_lines([[*_lines(piece, "across"), *own] for piece, own in zip(pieces, edges, strict=True)], size)
        z = continued_lines([list(_lines(piece, "height")) for piece in pieces], size)
        half = max(float(np.max(block.across)) for block in blocks if block.beam)
        shares = np.max(np.diff(y, axis=1), axis=0) / half
        counts = np.maximum(1, np.round(shares * across)).astype(int)
        return cls(_subdivided(y, counts.tolist()), _subdivided(z, [through] * (z.shape[1] - 1)))

    def section(self) -> CrossSection:
        """Cross-section of y ≥ 0."""
        rows, columns = self.y.shape[1], self.z.shape[1]
        places = np.stack([np.repeat(self.y, columns, axis=1), np.tile(self.z, (1, rows))], axis=1)
        number = np.arange(rows * columns).reshape(rows, columns)
        quads = np.stack([number[:-1, :-1], number[:-1, 1:], number[1:, :-1], number[1:, 1:]]).reshape(4, -1)
        return CrossSection(places, quads, places[:, :, quads].mean(axis=2))

    def mesh(self, grid: SolidGrid) -> Any:
        """MeshHex of a grid of such a cross-section."""
        from skfem import MeshHex

        return MeshHex(grid.points, grid.cells.astype(np.int32))


@dataclass(frozen=True, eq=False)
class CircularFamily:
    """Pieces of circular section, ``across`` cells around an eighth and ``through`` over each ring.

    ``planes`` (k,) m between the pieces; ``radii`` (k, rings) m there, ascending.
    """

    pieces: Sequence[Piece]
    across: int
    through: int
    planes: Array
    radii: Array

    @classmethod
    def of(cls, pieces: Sequence[Piece], across: int, through: int) -> CircularFamily:
        """The family with its radii continued through all pieces."""
        needed = [[(0.0, 0.0), *(tuple(each) for b in piece.blocks for each in b.across.tolist())] for piece in pieces]
        size = max(float(np.max(lines)) for lines in needed)
        planes = np.array([pieces[0].start, *(piece.end for piece in pieces)])
        return cls(pieces, across, through, planes, continued_lines(needed, size)[:, 1:])

    def section(self) -> CrossSection:
        """Cross-section of u ≥ 0 in the plane of parameters; its blocks are asked for by the radius."""
        across, height = self._lines()
        rings = _subdivided(np.arange(1.0, self.radii.shape[1] + 2)[None], [self.through] * self.radii.shape[1])[0]
        core = _quads(across, height)
        edge = np.array([*((u, 1.0) for u in across), *((1.0, v) for v in height[-2::-1])])
        edge = np.array([*edge, *((u, -1.0) for u in across[-2::-1])])
        around = [np.array([(m0 * a, m1 * a, m0 * b, m1 * b) for a, b in pairwise(edge)]) for m0, m1 in pairwise(rings)]
        corners = np.concatenate([core, *around])
        places, quads = np.unique(np.round(corners.reshape(-1, 2), 12), axis=0, return_inverse=True)
        square = np.maximum(1.1, np.max(np.abs(corners.mean(axis=1)), axis=1))  # of the core: inside the first ring
        middles = np.stack([self._radius(self.planes[:, None], square), np.zeros((len(self.planes), len(square)))], 1)
        return CrossSection(np.tile(places.T, (len(self.planes), 1, 1)), quads.reshape(-1, 4).T, middles)

    def mesh(self, grid: SolidGrid) -> Any:
        """MeshHex2 of a grid of such a cross-section, its nodes on the circles."""
        from skfem import MeshHex, MeshHex2

        straight = MeshHex2.from_mesh(MeshHex(grid.points, grid.cells.astype(np.int32)))
        return MeshHex2(self._carried(straight.doflocs), straight.t)

    def _carried(self, places: Array) -> Array:
        """Points (3, n) m at x and parameters (3, n)."""
        x, u, v = places
        square = np.maximum(np.abs(u), np.abs(v))
        flat = np.stack([u, v]) / np.where(square > 0, square, 1.0)
        upper = np.abs(v) >= np.abs(u)
        lying = np.where(v >= 0, EIGHTH * flat[0], np.pi - EIGHTH * flat[0])
        angle = np.where(upper, lying, np.sign(u) * (np.pi / 2 - EIGHTH * flat[1]))
        circle = np.stack([np.sin(angle), np.cos(angle)])
        share = np.clip(square - 1, 0.0, 1.0)
        inner = CORE * self._radius(x, np.full(x.shape, 2.0)) * np.minimum(square, 1.0)
        radius = self._radius(x, np.maximum(square, 2.0))
        return np.concatenate([x[None], (1 - share) * inner * flat + share * radius * circle])

    def _radius(self, x: Array, square: Array) -> Array:
        """Radius in m at ``x`` m of a square of the plane of parameters; within the first ring by its share."""
        at = np.stack([np.interp(x, self.planes, line) for line in (0 * self.radii[:, 0], *self.radii.T)])
        place = np.clip(square - 1, 0.0, self.radii.shape[1])
        low = np.minimum(place.astype(int), self.radii.shape[1] - 1)
        at, low, place = np.broadcast_arrays(at, low[None], place[None])
        below, above = (np.take_along_axis(at, low[:1] + step, axis=0)[0] for step in (0, 1))
        return np.asarray(below + (place[0] - low[0]) * (above - below))

    def _lines(self) -> tuple[Array, Array]:
        """Lines u in [0, 1] and v in [−1, 1] of the core, those at the edges of patches among them."""
        angles = {
            float(np.arcsin(min(1.0, edge / piece.blocks[0].across[1].mean())))
            for piece in self.pieces
            for edge in piece.edges
        }
        tops = sorted({angle / EIGHTH for angle in angles if angle < EIGHTH - 1e-9} | {0.0, 1.0})
        sides = {2 - angle / EIGHTH for angle in angles if angle > EIGHTH + 1e-9} | {0.0, 1.0}
        v = _filled(sorted(sides), self.across)
        return _filled(tops, self.across), np.concatenate([-v[:0:-1], v])


def _lines(piece: Piece, name: str) -> Iterator[Line]:
    for block in piece.blocks:
        yield from (tuple(line) for line in getattr(block, name).tolist())


def _subdivided(lines: Array, counts: Sequence[int]) -> Array:
    """Places (planes, …) of lines (planes, k) with so many cells between each two."""
    between = [
        lines[:, i, None] + np.arange(count) / count * (lines[:, i + 1] - lines[:, i])[:, None]
        for i, count in enumerate(counts)
    ]
    return np.hstack([*between, lines[:, -1:]])


def _filled(lines: Sequence[float], count: int) -> Array:
    """Lines of a side of unit length with about so many cells over all of it; very near ones are one."""
    kept = [*(low for low, high in pairwise(lines) if high - low > SLIVER), lines[-1]]
    kept[0] = lines[0]
    counts = np.maximum(1, np.round(np.diff(kept) * count)).astype(int)
    return np.ravel(_subdivided(np.array([kept]), counts.tolist()))


def _quads(u: Array, v: Array) -> Array:
    """Corners (k, 4, 2) of the cells between lines: at (0, 0), (0, 1), (1, 0), (1, 1)."""
    return np.array([[(a, c), (a, d), (b, c), (b, d)] for a, b in pairwise(u) for c, d in pairwise(v)])
