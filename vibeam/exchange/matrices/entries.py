"""Matrices written entry by entry: with the node and direction of each row and column, or their numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.exchange.files import FormatError, require_coordinates
from vibeam_models.structure import SYMMETRIC

Label = tuple[int, int]  # node, degree of freedom: 1 to 3 along x, y, z, 4 to 6 about them
Labels = tuple[Label, ...]
Shape = tuple[int, int]
Whole = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class FileMatrix:
    """A matrix or row as a file has it: an array, or a scipy sparse array; ``labels``: of each coordinate, if it says.

    ``held``: coordinates, from 0, that a boundary condition of the other program holds. ``notes``: the format, and what
    of the file is not the matrix as it stands: which half, a factor, names of nodes from a file beside it.
    """

    matrix: Any
    labels: Labels | None = None
    held: frozenset[int] = frozenset()
    notes: tuple[str, ...] = ()

    def taken(self, file: str) -> str:
        """The line that says what was taken of the ``file``."""
        return f"taken: {file}, {' × '.join(map(str, self.matrix.shape))}, {', '.join(self.notes)}"


def numbers(array: Any) -> NDArray[np.float64]:
    """The array as floats; FormatError where it holds anything else."""
    if array.dtype.kind not in "fiu":
        raise FormatError(f"holds {array.dtype} in place of real numbers")
    return np.asarray(array, dtype=float)


def scattered(values: Any, rows: Any, columns: Any, shape: Shape) -> Any:
    """The sparse matrix of values at ``rows``, ``columns`` (from 0); FormatError where these are not in it.

    They go into compiled code, which looks at none of them.
    """
    from scipy.sparse import coo_array

    require_coordinates(*shape)
    _require_alike(values, rows, columns)
    parts = numbers(values), (_indices(rows, shape[0], "row"), _indices(columns, shape[1], "column"))
    return coo_array(parts, shape=shape).tocsc()


def compressed(values: Any, indices: Any, starts: Any, shape: Shape, *, by_rows: bool = False) -> Any:
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


def assembled(
    rows: Whole, columns: Whole, values: Any, shape: Shape, symmetric: bool | None = None, labels: Labels | None = None
) -> FileMatrix:
    """The sparse matrix of entries at ``rows``, ``columns`` (from 0), with the half that the file has of it.

    ``symmetric``: an entry without one opposite stands for both; None (the file does not say): if that is so of all.
    FormatError where an entry is there twice, or opposite ones differ in a symmetric matrix.
    """
    require_coordinates(*shape)
    if symmetric and shape[0] != shape[1]:
        raise FormatError(f"is {shape[0]} × {shape[1]}, and symmetric by its head")
    if not np.isfinite(values).all():
        raise FormatError("has an entry that is no finite number")
    place = rows * shape[1] + columns
    order = np.argsort(place, kind="stable")
    again = order[1:][np.diff(place[order]) == 0]
    if len(again):
        where = _place(rows[again.min()], columns[again.min()], labels)
        raise FormatError(f"the entry of {where} is there twice: add them up")
    aside = np.flatnonzero(rows != columns)
    alone = aside[~np.isin(columns[aside] * shape[1] + rows[aside], place, assume_unique=True)]
    lower = rows[alone] > columns[alone]
    half = "lower" if lower.all() else "one" if lower.any() else "upper"
    note = "diagonal" if not len(aside) else "both halves" if len(alone) < len(aside) else f"{half} half, mirrored"
    if symmetric is False or (symmetric is None and note == "both halves") or shape[0] != shape[1]:
        alone, note = alone[:0], "every entry as it stands"
    both = np.append(rows, columns[alone]), np.append(columns, rows[alone])
    matrix = scattered(np.append(values, values[alone]), *both, shape)
    if symmetric and note == "both halves":
        _require_symmetric(matrix, labels)
    return FileMatrix(matrix, labels, notes=(note,))


def _require_symmetric(matrix: Any, labels: Labels | None) -> None:
    apart = abs(matrix - matrix.T).tocoo()
    if apart.data.max(initial=0.0) > SYMMETRIC * abs(matrix.data).max():
        row, column = sorted(int(each[apart.data.argmax()]) for each in (apart.row, apart.col))
        found = f"{matrix[row, column]:.6g} at {_place(row, column, labels)} and {matrix[column, row]:.6g} opposite"
        raise FormatError(f"is symmetric by its head, but has {found}")


def _place(row: int, column: int, labels: Labels | None) -> str:
    if labels is None:
        return f"row {row + 1}, column {column + 1}"
    return ", ".join("node {} direction {}".format(*labels[index]) for index in (row, column))


def labelled(rows: Whole, columns: Whole, values: Any, symmetric: bool | None = None) -> FileMatrix:
    """The matrix of entries at labels (entries, 2), its coordinates in the order of node and direction."""
    both = np.concatenate([rows, columns])
    nodes, node = np.unique(both[:, 0], return_inverse=True)
    directions, direction = np.unique(both[:, 1], return_inverse=True)
    places, place = np.unique(node * len(directions) + direction, return_inverse=True)
    at = np.divmod(places, len(directions))
    labels = tuple(zip(nodes[at[0]].tolist(), directions[at[1]].tolist(), strict=True))
    shape = len(labels), len(labels)
    return assembled(place[: len(rows)], place[len(rows) :], values, shape, symmetric, labels)


def in_labels(found: FileMatrix, labels: Labels) -> Any:
    """The matrix in the coordinates of ``labels``, which has all of its own and perhaps more."""
    place = {label: index for index, label in enumerate(labels)}
    own = np.array([place[label] for label in found.labels or ()], dtype=np.int64)
    entries = found.matrix.tocoo()
    return scattered(entries.data, own[entries.row], own[entries.col], (len(labels), len(labels)))
