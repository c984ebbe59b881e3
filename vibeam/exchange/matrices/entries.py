"""Matrices written entry by entry: with the node and direction of each row and column, or their numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.exchange.files import FormatError, require_coordinates

Label = tuple[int, int]  # node, degree of freedom: 1 to 3 along x, y, z, 4 to 6 about them
Whole = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class FileMatrix:
    """A matrix or row as a file has it: an array, or a scipy sparse array; ``labels``: of each coordinate, if it says.

    ``held``: coordinates, from 0, that a boundary condition of the other program holds.
    """

    matrix: Any
    labels: tuple[Label, ...] | None = None
    held: frozenset[int] = frozenset()


def numbers(array: Any) -> NDArray[np.float64]:
    """The array as floats; FormatError where it holds anything else."""
    if array.dtype.kind not in "fiu":
        raise FormatError(f"holds {array.dtype} in place of real numbers")
    return np.asarray(array, dtype=float)


def scattered(values: Any, rows: Any, columns: Any, shape: tuple[int, int]) -> Any:
    """The sparse matrix of values at ``rows``, ``columns`` (from 0); FormatError where these are not in it.

    They go into compiled code, which looks at none of them.
    """
    from scipy.sparse import coo_array

    require_coordinates(*shape)
    _require_alike(values, rows, columns)
    parts = numbers(values), (_indices(rows, shape[0], "row"), _indices(columns, shape[1], "column"))
    return coo_array(parts, shape=shape).tocsc()


def compressed(values: Any, indices: Any, starts: Any, shape: tuple[int, int], *, by_rows: bool = False) -> Any:
    """The sparse matrix of compressed columns, or rows; FormatError as ``scattered``."""
    from scipy.sparse import csc_array, csr_array

    require_coordinates(*shape)
    _require_alike(values, indices)
    major, minor = shape if by_rows else shape[::-1]
    if starts.ndim != 1 or starts.dtype.kind not in "iu" or len(starts) != major + 1:
        raise FormatError(f"has pointers that are not {major + 1} whole numbers, one more than its columns")
    if starts[0] != 0 or starts[-1] != len(indices) or (starts[1:] < starts[:-1]).any():
        raise FormatError(f"has pointers that do not rise from 0 to the number of its entries, {len(indices)}")
    made = csr_array if by_rows else csc_array
    parts = numbers(values), _indices(indices, minor, "index"), starts.astype(np.int64)
    return csc_array(made(parts, shape=shape))


def _require_alike(*parts: Any) -> None:
    if any(part.ndim != 1 for part in parts) or len({len(part) for part in parts}) != 1:
        told = ", ".join(str(part.shape) for part in parts)
        raise FormatError(f"has values and indices of different shapes, {told}")


def _indices(found: Any, size: int, what: str) -> Whole:
    if found.dtype.kind not in "iu":
        raise FormatError(f"holds {found.dtype} in place of whole numbers, as {what}")
    if len(found) and not 0 <= (least := found.min()) <= (most := found.max()) < size:
        raise FormatError(f"has the {what} {least if least < 0 else most}, and they are 0 to {size - 1}")
    return np.asarray(found, dtype=np.int64)


def assembled(rows: Whole, columns: Whole, values: NDArray[np.float64], size: int | None = None) -> Any:
    """The square sparse matrix of entries at ``rows``, ``columns`` (from 0).

    Where no entry stands opposite another the file has one half of a symmetric matrix, and the other is added.
    FormatError where an entry is there twice.
    """
    count = int(max(rows.max(initial=-1), columns.max(initial=-1))) + 1 if size is None else size
    if not count:
        raise FormatError("holds no entries")
    require_coordinates(count)
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
    return scattered(values, rows, columns, (count, count))


def labelled(rows: Whole, columns: Whole, values: NDArray[np.float64]) -> FileMatrix:
    """The matrix of entries at labels (entries, 2), its coordinates in the order of node and direction."""
    both = np.concatenate([rows, columns])
    nodes, node = np.unique(both[:, 0], return_inverse=True)
    directions, direction = np.unique(both[:, 1], return_inverse=True)
    places, place = np.unique(node * len(directions) + direction, return_inverse=True)
    require_coordinates(len(places))
    at = np.divmod(places, len(directions))
    labels = tuple(zip(nodes[at[0]].tolist(), directions[at[1]].tolist(), strict=True))
    return FileMatrix(assembled(place[: len(rows)], place[len(rows) :], values, len(labels)), labels)


def in_labels(found: FileMatrix, labels: tuple[Label, ...]) -> Any:
    """The matrix in the coordinates of ``labels``, which has all of its own and perhaps more."""
    place = {label: index for index, label in enumerate(labels)}
    own = np.array([place[label] for label in found.labels or ()], dtype=np.int64)
    entries = found.matrix.tocoo()
    return scattered(entries.data, own[entries.row], own[entries.col], (len(labels), len(labels)))
