"""Matrices written entry by entry: with the node and direction of each row and column, or their numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Label = tuple[int, int]  # node, degree of freedom: 1 to 3 along x, y, z, 4 to 6 about them


class FormatError(ValueError):
    """A file that cannot be read as what it should be; the text says what is wrong and where."""


@dataclass(frozen=True, eq=False)
class FileMatrix:
    """A matrix or row as a file has it: an array, or a scipy sparse array; ``labels``: of each coordinate, if it says.

    ``held``: coordinates, from 0, that a boundary condition of the other program holds.
    """

    matrix: Any
    labels: tuple[Label, ...] | None = None
    held: frozenset[int] = frozenset()


def assembled(rows: NDArray[Any], columns: NDArray[Any], values: NDArray[np.float64], size: int | None = None) -> Any:
    """The square sparse matrix of entries at ``rows``, ``columns`` (from 0).

    Where no entry stands opposite another the file has one half of a symmetric matrix, and the other is added.
    FormatError where an entry is there twice.
    """
    from scipy.sparse import coo_array

    count = int(max(rows.max(initial=-1), columns.max(initial=-1))) + 1 if size is None else size
    if not count:
        raise FormatError("holds no entries")
    place = rows * count + columns
    order = np.argsort(place, kind="stable")
    again = order[1:][np.diff(place[order]) == 0]
    if len(again):
        first = int(again.min())
        raise FormatError(f"the entry of row {rows[first] + 1}, column {columns[first] + 1} is there twice")
    aside = rows != columns
    if not np.isin(columns[aside] * count + rows[aside], place, assume_unique=True).any():
        rows, columns = np.append(rows, columns[aside]), np.append(columns, rows[aside])
        values = np.append(values, values[aside])
    return coo_array((values, (rows, columns)), shape=(count, count)).tocsc()


def labelled(rows: Sequence[Label], columns: Sequence[Label], values: NDArray[np.float64]) -> FileMatrix:
    """The matrix of entries at labels, its coordinates in the order of node and direction."""
    labels = tuple(sorted({*rows, *columns}))
    place = {label: index for index, label in enumerate(labels)}
    number = [np.array([place[label] for label in each], dtype=np.int64) for each in (rows, columns)]
    return FileMatrix(assembled(number[0], number[1], values, len(labels)), labels)


def in_labels(found: FileMatrix, labels: tuple[Label, ...]) -> Any:
    """The matrix in the coordinates of ``labels``, which has all of its own and perhaps more."""
    from scipy.sparse import coo_array

    place = {label: index for index, label in enumerate(labels)}
    own = np.array([place[label] for label in found.labels or ()], dtype=np.int64)
    entries = found.matrix.tocoo()
    size = (len(labels), len(labels))
    return coo_array((entries.data, (own[entries.row], own[entries.col])), shape=size).tocsc()
