"""Modes of files: eigenvectors of Nastran's OUTPUT2 files by grid point and component, or a universal file's.

A table OUGV1 (OPHIG; BOUGV1 in the basic coordinates) has for each mode a record of its numbers, with the eigenvalue,
and one of eight words a point: 10 × its number, its type, six components; LAMA has the generalised masses (MSC Nastran
DMAP Programmer's Guide, OUG, LAMA). There is no unit in it, and no damping."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vibeam.exchange.files import LARGEST_TEXT, FormatError, State, state_of
from vibeam.exchange.output2 import Block, blocks
from vibeam.exchange.uff import FileModes
from vibeam.exchange.uff import read_modes as read_universal
from vibeam_models.arrays import Array

SHAPES = ("OUGV1", "OUGV1PAT", "OUG1", "OPHIG", "BOUGV1", "BOPHIG")
EIGENVALUES, EIGENVECTORS, REAL = 2, 7, 1  # analysis, table, format of numbers
POINT, SCALAR = 1, 2  # types of points: with six components, with one
RIGID = 1e-6  # of the largest eigenvalue: so far below 0 may lie that of a rigid motion


def read_modes(path: Path) -> FileModes:
    """The modes of a file by ascending frequency; FormatError where there are none."""
    if path.suffix.lower() != ".op2":
        return read_universal(path)
    return _read(path, state_of(path, LARGEST_TEXT))


@lru_cache(maxsize=8)
def _read(path: Path, state: State) -> FileModes:
    found = list(blocks(path))
    table = next((block for block in found if block.name in SHAPES and _is_modal(block)), None)
    if table is None:
        raise FormatError(f"has no real modes (SOL 103): no eigenvectors in a table {', '.join(SHAPES)}")
    modes = sorted(_modes(table), key=lambda mode: mode.eigenvalue)
    points = modes[0].points
    if any(not np.array_equal(mode.points, points) or mode.subcase != modes[0].subcase for mode in modes):
        raise FormatError(f"has a table {table.name} of different points or subcases: export those of one")
    squares = np.array([mode.eigenvalue for mode in modes])
    if not np.isfinite(squares).all() or squares[0] < -RIGID * max(squares[-1], 1):
        raise FormatError(f"has the eigenvalue {squares[0]:g}: a structure at rest has none below 0")
    masses = _masses(found)
    values = np.array([mode.shape for mode in modes], dtype=float).transpose(1, 2, 0)
    shapes = {
        (number // 10, direction + 1): values[index, direction]
        for index, (number, kind) in enumerate(points.tolist())
        for direction in range({POINT: 6, SCALAR: 1}.get(kind, 0))
    }
    if not shapes or not np.isfinite(values).all():
        raise FormatError(f"has a table {table.name} without points, or with numbers that are not finite")
    return FileModes(
        np.sqrt(np.maximum(squares, 0)) / (2 * np.pi),
        None,
        np.array([masses.get(mode.number, 0.0) for mode in modes]),
        dict(sorted(shapes.items())),
        f"Nastran OUTPUT2, table {table.name}" + ", its modal masses as kg" * bool(masses),
    )


@dataclass(frozen=True)
class _Mode:
    """Mode: ``points`` (n, 2) with 10 × their number and their type, ``shape`` (n, 6)."""

    number: int
    subcase: int
    eigenvalue: float
    points: NDArray[np.int64]
    shape: Array


def _is_modal(table: Block) -> bool:
    """Test whether a table has real eigenvectors, of eight words a point."""
    heads = [table.words.whole(head) for head in table.table()[::2]]
    kinds = {(head[0] // 10, head[1], *head[8:10].tolist()) for head in heads if len(head) > 9}
    return kinds == {(EIGENVALUES, EIGENVECTORS, REAL, 8)}


def _modes(table: Block) -> Iterator[_Mode]:
    parts = table.table()
    if len(parts) % 2 or any(len(data) % (8 * table.words.size) for data in parts[1::2]):
        raise FormatError(f"has a table {table.name} whose records are not of eight words a point: is it cut off?")
    for head, data in zip(parts[::2], parts[1::2], strict=True):
        words, each = table.words.whole(head), table.words.whole(data).reshape(-1, 8)
        shape = table.words.real(data).reshape(-1, 8)[:, 2:]
        eigenvalue = float(table.words.real(head)[5])
        yield _Mode(int(words[4]), int(words[3]), eigenvalue, each[:, :2].astype(np.int64), shape)


def _masses(found: list[Block]) -> dict[int, float]:
    """Generalised masses by the number of the mode, none without the table of them."""
    table = next((block for block in found if block.name in ("LAMA", "BLAMA")), None)
    if table is None or len(parts := table.table()) != 2 or len(parts[1]) % (7 * table.words.size):
        return {}
    numbers = table.words.whole(parts[1]).reshape(-1, 7)[:, 0].tolist()
    return dict(zip(numbers, table.words.real(parts[1]).reshape(-1, 7)[:, 5].tolist(), strict=True))
