"""Matrices in text: rows of numbers, Matrix Market.

Matrix Market (Boisvert, Pozo & Remington, The Matrix Market Exchange Formats, NISTIR 5935, 1996) is read here and not
by scipy, whose reader ends the whole process at a file that is cut off within a number, takes 4.0e+ for 4, and doubles
what stands in both halves of a symmetric matrix (1.17). Julia calls a real symmetric matrix hermitian."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from vibeam.exchange.files import FormatError, Line, lines_of, read_by, real, require_room, shown, text_of
from vibeam.exchange.matrices.entries import FileMatrix, assembled

EXACT = 2.0**53  # up to which a double is any whole number
Rows = Callable[[], Iterator[Line]]


def read_text(path: Path, name: str, wanted: str) -> FileMatrix:
    """The array of a file; ``#`` begins a comment."""
    require_no_name(name)
    text = text_of(path)

    def rows() -> Iterator[Line]:
        for number, line in lines_of(text):
            if cells := line.partition("#")[0].replace(",", " ").strip():
                yield number, cells

    width = len(next(rows(), (0, ""))[1].split())
    if not width:
        raise FormatError("holds no numbers")
    return FileMatrix(table(rows, width))


def require_no_name(name: str) -> None:
    """FormatError for a ``name`` of what has none."""
    if name:
        raise FormatError(f"holds one matrix without a name: leave name = {name!r} away")


def table(rows: Rows, width: int) -> NDArray[np.float64]:
    """The numbers (lines, width) of rows, between blanks; FormatError with the first line that has others.

    ``rows`` is called again to find that line. Only digits of ASCII are numbers, and only finite ones.
    """
    try:
        found = np.loadtxt((line for _, line in rows()), comments=None, ndmin=2)
    except ValueError:
        found = np.zeros(0)
    if found.shape[1:] != (width,) or not np.isfinite(found).all():
        _refuse(rows(), width)
    require_room(found.shape)
    return found


def entries_of(
    rows: Rows, width: int, least: float, most: Any = EXACT
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Places, from ``least`` to ``most``, and values of rows; FormatError with the first row that has others."""
    found = table(rows, width)
    places = found[:, :-1]
    wrong = ((places < least) | (places > most) | (places % 1 != 0)).any(axis=1)
    if wrong.any():
        number, line = next(islice(rows(), int(wrong.argmax()), None))
        raise FormatError(f"{shown(line)} is outside the matrix, or its place is no whole number", number)
    return places.astype(np.int64), found[:, -1]


def _refuse(rows: Iterable[Line], width: int) -> NoReturn:
    """FormatError for the first row that is none."""
    for number, line in rows:
        words = line.split(maxsplit=width)
        if len(words) != width:
            counted = "more" if len(words) > width else len(words)
            raise FormatError(f"{shown(line)} has {counted} numbers in place of {width}", number)
        with read_by("", line=number):
            [real(word) for word in words]
    raise FormatError("cannot be read as rows of numbers")


BANNER = "%%matrixmarket"
LAYOUTS, FIELDS = ("coordinate", "array"), ("real", "integer", "double")
SYMMETRIES = ("general", "symmetric", "hermitian")


def read_matrix_market(path: Path, name: str, wanted: str) -> FileMatrix:
    """The matrix of a file, in either layout, symmetric or general; a pattern or complex numbers are none."""
    require_no_name(name)
    text = text_of(path)
    layout, symmetric = _head(next(lines_of(text), (1, ""))[1])

    def data() -> Iterator[Line]:
        return ((number, line) for number, line in lines_of(text) if not line.startswith("%"))

    sizes = _sizes(next(data(), None), 3 if layout == "coordinate" else 2)
    shape, made = (sizes[0], sizes[1]), _coordinate if layout == "coordinate" else _array
    if symmetric and shape[0] != shape[1]:
        raise FormatError(f"is {shape[0]} × {shape[1]}, and symmetric by its head", 1)
    return made(lambda: islice(data(), 1, None), shape, sizes[-1], symmetric)


def _head(line: str) -> tuple[str, bool]:
    """Layout, and whether one half stands for both."""
    words = line[:200].lower().split()
    if len(words) != 5 or words[:2] != [BANNER, "matrix"]:
        raise FormatError("is no Matrix Market head, %%MatrixMarket matrix coordinate real general", 1)
    for word, known in zip(words[2:], (LAYOUTS, FIELDS, SYMMETRIES), strict=True):
        if word not in known:
            raise FormatError(f"its matrix is {shown(word)}: {' or '.join(known)} is needed", 1)
    return words[2], words[4] != "general"


def _sizes(line: Line | None, count: int) -> list[int]:
    if line is None:
        raise FormatError("has no line of sizes")
    words = line[1].split(maxsplit=count)
    if len(words) != count or not all(word.isascii() and word.isdigit() and len(word) < 16 for word in words):
        raise FormatError(f"{shown(line[1])} are no sizes", line[0])
    return [int(word) for word in words]


def _coordinate(rows: Rows, shape: tuple[int, int], count: int, symmetric: bool) -> FileMatrix:
    places, values = entries_of(rows, 3, 1, shape)
    if len(values) != count:
        raise FormatError(f"has {len(values)} entries, and its line of sizes says {count}: is it cut off?")
    return assembled(places[:, 0] - 1, places[:, 1] - 1, values, shape, symmetric)


def _array(rows: Rows, shape: tuple[int, int], _: int, symmetric: bool) -> FileMatrix:
    """A full matrix, column by column; of a symmetric one from the diagonal down."""
    require_room(shape)
    count, columns = shape
    wanted = count * (count + 1) // 2 if symmetric else count * columns
    values = table(rows, 1).ravel()
    if len(values) != wanted:
        raise FormatError(f"has {len(values)} numbers, and its line of sizes says {wanted}: is it cut off?")
    if not symmetric:
        return FileMatrix(values.reshape(columns, count).T.copy())
    full = np.zeros((count, count))
    lower = np.triu_indices(count)  # columns of the lower half are rows of the upper one
    full[lower] = values
    return FileMatrix(full + np.triu(full, 1).T, notes=("lower half, mirrored",))
