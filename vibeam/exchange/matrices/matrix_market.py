"""Matrix Market files (Boisvert, Pozo & Remington, The Matrix Market Exchange Formats, NISTIR 5935, 1996).

Read here and not by scipy, whose reader ends the whole process at a file that is cut off within a number (1.17).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from vibeam.exchange.files import FormatError, require_coordinates, require_room
from vibeam.exchange.matrices.entries import FileMatrix, scattered
from vibeam.exchange.matrices.text import SHOWN, require_no_name, shown, table
from vibeam.exchange.text import Line, lines_of, text_of

HEAD = "%%matrixmarket"
LAYOUTS, FIELDS, SYMMETRIES = ("coordinate", "array"), ("real", "integer", "double"), ("general", "symmetric")
Rows = Callable[[], Iterator[Line]]


def read(path: Path, name: str, wanted: str) -> FileMatrix:
    """The matrix of a file, in either layout, symmetric or general; a pattern or complex numbers are none."""
    require_no_name(name)
    text = text_of(path)
    layout, symmetric = _head(next(lines_of(text), (1, ""))[1])

    def data() -> Iterator[Line]:
        return ((number, line) for number, line in lines_of(text) if not line.startswith("%"))

    sizes = _sizes(next(data(), None), 3 if layout == "coordinate" else 2)
    shape, made = (sizes[0], sizes[1]), _coordinate if layout == "coordinate" else _array
    return FileMatrix(made(lambda: islice(data(), 1, None), shape, sizes[-1], symmetric))


def _head(line: str) -> tuple[str, bool]:
    """Layout, and whether one half stands for both."""
    words = line[:200].lower().split()
    if len(words) != 5 or words[:2] != [HEAD, "matrix"]:
        raise FormatError("is no Matrix Market head, %%MatrixMarket matrix coordinate real general", 1)
    for word, known in zip(words[2:], (LAYOUTS, FIELDS, SYMMETRIES), strict=True):
        if word not in known:
            raise FormatError(f"its matrix is {word[:SHOWN]}: {' or '.join(known)} is needed", 1)
    return words[2], words[4] == "symmetric"


def _sizes(line: Line | None, count: int) -> list[int]:
    if line is None:
        raise FormatError("has no line of sizes")
    words = line[1].split(maxsplit=count)
    if len(words) != count or not all(word.isascii() and word.isdigit() and len(word) < 16 for word in words):
        raise FormatError(f"{shown(line[1])} are no sizes", line[0])
    return [int(word) for word in words]


def _coordinate(rows: Rows, shape: tuple[int, int], count: int, symmetric: bool) -> Any:
    require_coordinates(*shape)
    entries = table(rows, 3)
    if len(entries) != count:
        raise FormatError(f"has {len(entries)} entries, and its line of sizes says {count}: is it cut off?")
    places = entries[:, :2]
    wrong = ((places < 1) | (places > shape) | (places % 1 != 0)).any(axis=1)
    if wrong.any():
        number, line = next(islice(rows(), int(wrong.argmax()), None))
        raise FormatError(f"{shown(line)} is outside the matrix, {shape[0]} × {shape[1]}", number)
    row, column = (places.astype(np.int64) - 1).T
    values = entries[:, 2]
    if symmetric:
        aside = row != column
        row, column = np.append(row, column[aside]), np.append(column, row[aside])
        values = np.append(values, values[aside])
    return scattered(values, row, column, shape)


def _array(rows: Rows, shape: tuple[int, int], _: int, symmetric: bool) -> Any:
    """A full matrix, column by column; of a symmetric one from the diagonal down."""
    require_room(shape)
    count, columns = shape
    wanted = count * (count + 1) // 2 if symmetric else count * columns
    values = table(rows, 1).ravel()
    if len(values) != wanted:
        raise FormatError(f"has {len(values)} numbers, and its line of sizes says {wanted}: is it cut off?")
    if not symmetric:
        return values.reshape(columns, count).T.copy()
    full = np.zeros((count, count))
    lower = np.triu_indices(count)  # columns of the lower half are rows of the upper one
    full[lower] = values
    return full + np.triu(full, 1).T
