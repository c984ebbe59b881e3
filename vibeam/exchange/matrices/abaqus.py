"""Abaqus' text files of matrices, from *MATRIX GENERATE and *MATRIX OUTPUT.

A line is "row node, its degree of freedom, column node, its degree of freedom, value" (FORMAT=MATRIX INPUT, LABELS) or
"row, column, value" (FORMAT=COORDINATE); of a symmetric matrix one half may stand for both (Abaqus Keywords Reference
Guide, *MATRIX INPUT). Internal nodes have negative numbers. A degree of freedom that a boundary condition holds has
1e36 on the diagonal of the stiffness.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import numpy as np

from vibeam.exchange.files import FormatError
from vibeam.exchange.matrices.entries import FileMatrix, assembled, labelled
from vibeam.exchange.matrices.text import require_no_name, table
from vibeam.exchange.text import Line, lines_of, text_of

HELD = 1e35  # on the diagonal
EXACT = 2.0**53  # up to which a double is any whole number


def read(path: Path, name: str, wanted: str) -> FileMatrix:
    """The matrix of a file; lines that begin with * are keywords and comments."""
    require_no_name(name)
    entries = _entries(text_of(path))
    places, values = entries[:, :-1].astype(np.int64), entries[:, -1]
    if places.shape[1] == 2:
        if places.min(initial=1) < 1:
            raise FormatError("rows and columns are counted from 1")
        found = FileMatrix(assembled(places[:, 0] - 1, places[:, 1] - 1, values))
    else:
        found = labelled(places[:, :2], places[:, 2:], values)
    held = np.flatnonzero(found.matrix.diagonal() >= HELD)
    return FileMatrix(found.matrix, found.labels, frozenset(held.tolist()))


def _entries(text: str) -> np.ndarray:
    """The numbers (entries, 3 or 5)."""

    def rows() -> Iterator[Line]:
        for number, line in lines_of(text):
            if line.lstrip()[0] != "*":
                yield number, line.replace(",", " ")

    number, first = next(rows(), (0, ""))
    if not first:
        raise FormatError("holds no entries")
    width = len(first.split(maxsplit=5))
    if width not in (3, 5):
        raise FormatError(
            f'{width} numbers: an entry is "row node, dof, column node, dof, value", or "row, column, value"', number
        )
    found = table(rows, width)
    wrong = ((found[:, :-1] % 1 != 0) | (np.abs(found[:, :-1]) > EXACT)).any(axis=1)
    if wrong.any():
        number = next(islice(rows(), int(wrong.argmax()), None))[0]
        raise FormatError("nodes, degrees of freedom, rows and columns are whole numbers", number)
    return found
