"""Abaqus' text files of matrices, from *MATRIX GENERATE and *MATRIX OUTPUT.

A line is "row node, its degree of freedom, column node, its degree of freedom, value" (FORMAT=MATRIX INPUT, LABELS) or
"row, column, value" (FORMAT=COORDINATE); of a symmetric matrix one half may stand for both (Abaqus Keywords Reference
Guide, *MATRIX INPUT). Internal nodes have negative numbers. A degree of freedom that a boundary condition holds has
1e36 on the diagonal of the stiffness.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from vibeam.exchange.matrices.entries import FileMatrix, FormatError, assembled, labelled
from vibeam.exchange.matrices.text import text_of

HELD = 1e35  # on the diagonal


def read(path: Path, name: str, wanted: str) -> FileMatrix:
    """The matrix of a file; lines that begin with * are keywords and comments."""
    if name:
        raise FormatError(f"holds one matrix without a name: leave name = {name!r} away")
    table = _table(path)
    if table.shape[1] == 3:
        if table[:, :2].min(initial=1) < 1:
            raise FormatError("rows and columns are counted from 1")
        places = table[:, :2].astype(np.int64) - 1
        found = FileMatrix(assembled(places[:, 0], places[:, 1], table[:, 2]))
    else:
        labels = table[:, :4].astype(np.int64).tolist()
        found = labelled([(a, b) for a, b, _, _ in labels], [(c, d) for _, _, c, d in labels], table[:, 4])
    held = np.flatnonzero(found.matrix.diagonal() >= HELD)
    return FileMatrix(found.matrix, found.labels, frozenset(held.tolist()))


def _table(path: Path) -> np.ndarray:
    """The numbers (entries, 3 or 5)."""
    lines = [
        (n, line) for n, line in enumerate(text_of(path).splitlines(), 1) if line.strip() and line.strip()[0] != "*"
    ]
    if not lines:
        raise FormatError("holds no entries")
    rows = [line.replace(",", " ").split() for _, line in lines]
    width = len(rows[0])
    if width not in (3, 5):
        raise FormatError(
            f'line {lines[0][0]}: {width} numbers: an entry is "row node, dof, column node, dof, value", '
            'or "row, column, value"'
        )
    for (number, line), row in zip(lines, rows, strict=True):
        if len(row) != width:
            raise FormatError(f"line {number}: {line[:40]!r} has {len(row)} numbers, the entries before {width}")
    try:
        table = np.array(rows, dtype=float)
    except ValueError:
        number = next(n for (n, _), row in zip(lines, rows, strict=True) if not all(map(_is_number, row)))
        raise FormatError(f"line {number}: is no entry of numbers") from None
    whole = table[:, :-1]
    if not np.array_equal(whole, np.floor(whole)):
        number = lines[int(np.flatnonzero((whole != np.floor(whole)).any(axis=1))[0])][0]
        raise FormatError(f"line {number}: nodes, degrees of freedom, rows and columns are whole numbers")
    return table


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True
