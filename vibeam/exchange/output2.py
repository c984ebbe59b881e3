"""Nastran's OUTPUT2 files (.op2): matrices, and modes as eigenvectors by grid point and component.

A file is keys, records of one word, and data: a key above 0 is the number of words in the record after it, one below 0
ends a logical record, 0 a data block. The first logical record of a block is its name, the second its trailer, the
third another name; each further one begins with 0 in a table, with 1 for a column of a matrix, whose strings follow:
first row, which is not counted, and numbers. A table OUGV1 (OPHIG; BOUGV1 in the basic coordinates) has for each mode a
record with its eigenvalue, and one of eight words a point: 10 × its number, type, six components; LAMA has the
generalised masses (MSC Nastran DMAP Programmer's Guide). Units and damping are nowhere. Read here and not by pyNastran,
which asks for numpy below 2 and cannot be imported with 2.4 (1.4.1)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.exchange.files import LARGEST_TEXT, FormatError, State, read_by, state_of
from vibeam.exchange.matrices.entries import FileMatrix
from vibeam.exchange.matrices.output4 import TYPES, NastranMatrix, content_of, one_of
from vibeam.exchange.nastran import records
from vibeam.exchange.uff import FileModes
from vibeam.exchange.uff import read_modes as read_universal

SHAPES = ("OUGV1", "OUGV1PAT", "OUG1", "OPHIG", "BOUGV1", "BOPHIG")
REAL_MODES = (2, 7, 1, 8)  # analysis, table, format of numbers, words a point
COMPONENTS = {1: 6, 2: 1}  # of grid points and scalar points
RIGID = 1e-6  # of the largest eigenvalue: so far below 0 may lie that of a rigid motion


@dataclass(frozen=True)
class DataBlock:
    """Data block: ``whole``, ``real``: words as numpy calls them; name, trailer, logical records from the fourth on."""

    whole: str
    real: str
    name: str
    trailer: list[int]
    content: list[list[bytes]]

    def table(self) -> list[tuple[NDArray[Any], NDArray[Any]]]:
        """Logical records of a table, as whole and as real numbers, without the word that begins them."""
        found = [b"".join(each[1:]) for each in self.content]
        return [(np.frombuffer(each, self.whole), np.frombuffer(each, self.real)) for each in found]

    def matrix(self) -> Iterator[NastranMatrix]:
        """The matrix that the block is, none of a table."""
        if not any(each and np.frombuffer(each[0], self.whole)[0] == 1 for each in self.content):
            return
        columns, rows, form, kind = self.trailer[1:5]
        real = self.real if self.real[2] == "8" else self.real[0] + TYPES.get(kind, "f4")
        size = int(self.real[2])
        strings = [
            (column, int(np.frombuffer(each[:size], self.whole)[0]), np.frombuffer(each[size:], real))
            for column, found in enumerate(self.content, 1)
            for each in found[1:]
        ]
        yield NastranMatrix(self.name, columns, rows, form, kind, strings)


def blocks(path: Path) -> Iterator[DataBlock]:
    """Data blocks of a file; FormatError where it is cut off."""
    content = content_of(path)
    order, size = "<" if content[1:4] == bytes(3) else ">", max(content[:4])
    if size not in (4, 8):
        raise FormatError("begins with no key of OUTPUT2")
    whole, found = f"{order}i{size}", records(content, order)
    logical, parts = list[list[bytes]](), list[bytes]()
    for record in found:
        [key] = np.frombuffer(record, whole).tolist()
        if key > 0:
            uncounted = parts[:1] == [np.array([1], whole).tobytes()]  # the first row of a string
            parts.append(next(found, b""))
            if len(parts[-1]) != (key + uncounted) * size:
                raise FormatError(f"has a record of {len(parts[-1])} bytes in place of {key} words: is it cut off?")
        elif key < 0:
            logical.append(parts)
            parts = []
        else:
            if len(logical) > 2:
                [[name], [trailer]] = logical[:2]
                letters = name[:8] if name[4:8].strip() else name[:4] + name[size : size + 4]
                called = letters.decode("ascii", "replace").strip().upper()
                yield DataBlock(whole, f"{order}f{size}", called, np.frombuffer(trailer, whole).tolist(), logical[3:])
            logical, parts = [], []
    if logical:
        raise FormatError("ends within a data block: is it cut off?")


def read_output2(path: Path, name: str, wanted: str) -> FileMatrix:
    """The matrix by that name; with none, the only one that begins with K, M or B (damping)."""
    return one_of((matrix for block in blocks(path) for matrix in block.matrix()), name, wanted)


def read_modes(path: Path, skip: Sequence[float] = ()) -> FileModes:
    """The modes of a file, this or a universal one, by ascending frequency but those at ``skip`` (Hz), taken as real.

    FormatError where there are none, or one is too far from being real.
    """
    if path.suffix.lower() != ".op2":
        return read_universal(path, skip)
    with read_by("is no OUTPUT2 file that can be read"):
        return _read(path, state_of(path, LARGEST_TEXT)).without(skip)


@lru_cache(maxsize=8)
def _read(path: Path, state: State) -> FileModes:
    tables = [(block.name, block.table()) for block in blocks(path)]
    name, table = next((each for each in tables if each[0] in SHAPES and _is_modal(each[1])), ("", []))
    if not name:
        raise FormatError(f"has no real modes (SOL 103): no eigenvectors in a table {', '.join(SHAPES)}")
    heads, parts = table[::2], table[1::2]
    order = np.argsort([real[5] for _, real in heads], kind="stable").tolist()
    squares = np.array([heads[mode][1][5] for mode in order], dtype=float)
    points = [parts[mode][0].reshape(-1, 8)[:, :2].tolist() for mode in order]
    if any(each != points[0] for each in points) or len({int(whole[3]) for whole, _ in heads}) > 1:
        raise FormatError(f"has a table {name} of different points or subcases: export those of one")
    values = np.array([parts[mode][1].reshape(-1, 8)[:, 2:] for mode in order], dtype=float)
    shapes = {
        (number // 10, direction + 1): values[:, index, direction]
        for index, (number, kind) in sorted(enumerate(points[0]), key=lambda each: each[1])
        for direction in range(COMPONENTS.get(kind, 0))
    }
    if not shapes or not np.isfinite(values).all() or not squares[0] >= -RIGID * max(squares[-1], 1):
        raise FormatError(f"has in its table {name} no points, numbers that are not finite, or an eigenvalue below 0")
    numbers, masses = (each.reshape(-1, 7) for each in dict(tables).get("LAMA", [(np.zeros(0),) * 2])[-1])
    known = dict(zip(numbers[:, 0].tolist(), masses[:, 5].tolist(), strict=True))
    mass = np.array([known.get(int(heads[mode][0][4]), 0.0) for mode in order])
    said = f"Nastran OUTPUT2, table {name}" + ", modal masses as kg" * bool(mass.all())
    return FileModes(np.sqrt(np.maximum(squares, 0)) / (2 * np.pi), None, mass, shapes, said)


def _is_modal(table: list[tuple[NDArray[Any], NDArray[Any]]]) -> bool:
    heads = [whole for whole, _ in table[::2]]
    kinds = {(whole[0] // 10, whole[1], *whole[8:10].tolist()) for whole in heads if len(whole) > 9}
    return kinds == {REAL_MODES} and len(table) % 2 == 0
