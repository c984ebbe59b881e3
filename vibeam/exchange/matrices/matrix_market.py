"""Matrix Market files (Boisvert, Pozo & Remington, The Matrix Market Exchange Formats, NISTIR 5935, 1996).

Read here and not by scipy, whose reader ends the whole process at a file that is cut off within a number (1.17).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from vibeam.exchange.matrices.entries import FileMatrix, FormatError
from vibeam.exchange.matrices.text import text_of

HEAD = "%%matrixmarket"

LAYOUTS, FIELDS, SYMMETRIES = ("coordinate", "array"), ("real", "integer", "double"), ("general", "symmetric")


def read(path: Path, name: str, wanted: str) -> FileMatrix:
    """The matrix of a file, in either layout, symmetric or general; a pattern or complex numbers are none."""
    if name:
        raise FormatError(f"holds one matrix without a name: leave name = {name!r} away")
    lines = text_of(path).splitlines()
    layout, symmetric = _head(lines[0] if lines else "")
    data = [(n, line) for n, line in enumerate(lines[1:], start=2) if line.strip() and not line.startswith("%")]
    if not data:
        raise FormatError("has no line of sizes")
    number, sizes = data[0][0], _numbers(*data[0])
    if len(sizes) != (3 if layout == "coordinate" else 2) or min(sizes) < 0 or any(each % 1 for each in sizes):
        raise FormatError(f"line {number}: {data[0][1].strip()[:40]!r} are no sizes")
    shape = int(sizes[0]), int(sizes[1])
    if layout == "array":
        return FileMatrix(_array(data[1:], shape, symmetric))
    return FileMatrix(_coordinate(data[1:], shape, int(sizes[2]), symmetric))


def _head(line: str) -> tuple[str, bool]:
    """Layout, and whether one half stands for both."""
    words = line.lower().split()
    if len(words) != 5 or words[:2] != [HEAD, "matrix"]:
        raise FormatError("line 1: is no Matrix Market head, %%MatrixMarket matrix coordinate real general")
    for word, known in zip(words[2:], (LAYOUTS, FIELDS, SYMMETRIES), strict=True):
        if word not in known:
            raise FormatError(f"line 1: its matrix is {word}: {' or '.join(known)} is needed")
    return words[2], words[4] == "symmetric"


def _numbers(number: int, line: str) -> list[float]:
    try:
        return [float(word) for word in line.split()]
    except ValueError:
        raise FormatError(f"line {number}: {line.strip()[:40]!r} is no line of numbers") from None


def _table(data: list[tuple[int, str]], width: int) -> Any:
    """The numbers (lines, width)."""
    try:
        table = np.array([line.split() for _, line in data], dtype=float)
    except ValueError:
        table = np.zeros((0, 0))
    if data and table.shape != (len(data), width):
        for number, line in data:
            if len(_numbers(number, line)) != width:
                raise FormatError(f"line {number}: {line.strip()[:40]!r} has not {width} numbers")
    return table.reshape(len(data), width)


def _coordinate(data: list[tuple[int, str]], shape: tuple[int, int], count: int, symmetric: bool) -> Any:
    from scipy.sparse import coo_array

    if len(data) != count:
        raise FormatError(f"has {len(data)} entries, and its line of sizes says {count}: is it cut off?")
    table = _table(data, 3)
    places = table[:, :2]
    wrong = np.flatnonzero(((places < 1) | (places > shape) | (places % 1 != 0)).any(axis=1))
    if len(wrong):
        number, line = data[int(wrong[0])]
        raise FormatError(f"line {number}: {line.strip()[:40]!r} is outside the matrix, {shape[0]} × {shape[1]}")
    rows, columns = (places.astype(np.int64) - 1).T
    values = table[:, 2]
    if symmetric:
        aside = rows != columns
        rows, columns = np.append(rows, columns[aside]), np.append(columns, rows[aside])
        values = np.append(values, values[aside])
    return coo_array((values, (rows, columns)), shape=shape).tocsc()


def _array(data: list[tuple[int, str]], shape: tuple[int, int], symmetric: bool) -> Any:
    """A full matrix, column by column; of a symmetric one from the diagonal down."""
    rows, columns = shape
    wanted = sum(range(rows + 1)) if symmetric else rows * columns
    if len(data) != wanted:
        raise FormatError(f"has {len(data)} numbers, and its line of sizes says {wanted}: is it cut off?")
    values = _table(data, 1).ravel()
    if not symmetric:
        return values.reshape(columns, rows).T.copy()
    full = np.zeros((rows, rows))
    lower = np.triu_indices(rows)  # columns of the lower half are rows of the upper one
    full[lower] = values
    return full + np.triu(full, 1).T
