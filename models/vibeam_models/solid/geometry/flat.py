"""Bodies with flat faces: rectangles, hollow ones and I sections, with plates and blocks, as straight hexahedra."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.solid.geometry.grid import CrossSection
from vibeam_models.solid.geometry.lines import Line, continued_lines
from vibeam_models.solid.geometry.parts import Piece


def flat_section(pieces: Sequence[Piece], across: int, through: int) -> CrossSection:
    """Cross-section of y ≥ 0: ``across`` cells over the beam's half-width, ``through`` over each layer."""
    blocks = [block for piece in pieces for block in piece.blocks]
    size = max(float(np.max(np.abs([block.across, block.height]))) for block in blocks)
    y = continued_lines([[*_lines(piece, "across"), *_edges(piece)] for piece in pieces], size)
    z = continued_lines([list(_lines(piece, "height")) for piece in pieces], size)
    half = max(float(np.max(block.across)) for block in blocks if block.beam)
    shares = np.max(np.diff(y, axis=1), axis=0) / half
    counts = np.maximum(1, np.round(shares * across)).astype(int)
    return _tensor(subdivided(y, counts.tolist()), subdivided(z, [through] * (z.shape[1] - 1)))


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


def _tensor(y: Array, z: Array) -> CrossSection:
    planes, rows, columns = len(y), y.shape[1], z.shape[1]
    places = np.stack([np.repeat(y, columns, axis=1), np.tile(z, (1, rows))], axis=1)
    number = np.arange(rows * columns).reshape(rows, columns)
    quads = np.stack([number[:-1, :-1], number[:-1, 1:], number[1:, :-1], number[1:, 1:]]).reshape(4, -1)
    middles = places[:, :, quads].mean(axis=2)
    assert middles.shape == (planes, 2, quads.shape[1])
    return CrossSection(places, quads, middles)
