"""Bodies with flat faces: rectangles, hollow ones and I sections, with plates and blocks, as straight hexahedra."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.solid.geometry.grid import CrossSection, SolidGrid
from vibeam_models.solid.geometry.lines import Line, continued_lines
from vibeam_models.solid.geometry.parts import Piece


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
        y = continued_lines([[*_lines(piece, "across"), *_edges(piece)] for piece in pieces], size)
        z = continued_lines([list(_lines(piece, "height")) for piece in pieces], size)
        half = max(float(np.max(block.across)) for block in blocks if block.beam)
        shares = np.max(np.diff(y, axis=1), axis=0) / half
        counts = np.maximum(1, np.round(shares * across)).astype(int)
        return cls(subdivided(y, counts.tolist()), subdivided(z, [through] * (z.shape[1] - 1)))

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


def _lines(piece: Piece, name: str) -> Iterator[Line]:
    for block in piece.blocks:
        yield from (tuple(line) for line in getattr(block, name).tolist())


def _edges(piece: Piece) -> Iterator[Line]:
    yield from ((edge, edge) for edge in piece.edges)


def subdivided(lines: Array, counts: Sequence[int]) -> Array:
    """Places (planes, …) of lines (planes, k) with so many cells between each two."""
    between = [
        lines[:, i, None] + np.arange(count) / count * (lines[:, i + 1] - lines[:, i])[:, None]
        for i, count in enumerate(counts)
    ]
    return np.hstack([*between, lines[:, -1:]])
