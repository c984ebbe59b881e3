"""Faults of a matrix that should be a structure's: by how much, and where."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from vibeam.casefile.coordinates import Coordinates
from vibeam_models.structure import SYMMETRIC

NEGATIVE = 1e-9  # share of the largest eigenvalue, or diagonal ratio, by which another may be below 0


def entry_faults(matrix: Any, coordinates: Coordinates) -> Iterator[str]:
    """Complaints about entries: not finite, not symmetric."""
    entries = matrix.tocoo() if not isinstance(matrix, np.ndarray) else None
    values = matrix if entries is None else entries.data
    bad = np.flatnonzero(~np.isfinite(values.ravel()))
    if len(bad):
        place = (
            np.unravel_index(bad[0], matrix.shape) if entries is None else (entries.row[bad[0]], entries.col[bad[0]])
        )
        where = _pair(int(place[0]), int(place[1]), coordinates)
        yield f"{len(bad)} of its entries {'is' if len(bad) == 1 else 'are'} no finite number, the first at {where}"
    else:
        yield from _unsymmetric(matrix, coordinates)


def _place(entries: Any, index: int) -> tuple[int, int]:
    return int(entries.row[index]), int(entries.col[index])


def _unsymmetric(matrix: Any, coordinates: Coordinates) -> Iterator[str]:
    apart = abs(matrix - matrix.T)
    largest = float(apart.max())
    scale = float(abs(matrix).max())
    if largest <= SYMMETRIC * scale:
        return
    if isinstance(apart, np.ndarray):
        row, column = (int(each) for each in np.unravel_index(int(np.argmax(apart)), apart.shape))
        count = int(np.count_nonzero(np.triu(apart) > SYMMETRIC * scale))
    else:
        entries = apart.tocoo()
        first = int(np.argmax(entries.data))
        row, column = _place(entries, first)
        count = int(np.count_nonzero(entries.data > SYMMETRIC * scale)) // 2
    row, column = sorted((row, column))
    yield (
        f"is not symmetric: {matrix[row, column]:.6g} at {_pair(row, column, coordinates)}, but "
        f"{matrix[column, row]:.6g} opposite, {100 * largest / scale:.2g} % of the largest entry"
        + (f", the worst of {count} pairs" if count > 1 else "")
    )


def _pair(row: int, column: int, coordinates: Coordinates) -> str:
    if coordinates.labels is None:
        return f"row {row + 1}, column {column + 1}"
    return f"{coordinates.called(row)}, {coordinates.called(column)}"


def mass_faults(M: Any, coordinates: Coordinates) -> Iterator[str]:
    """Complaints about a mass matrix that is not positive definite."""
    diagonal = M.diagonal()
    empty = np.flatnonzero(diagonal == 0)
    if len(empty):
        more = f" and {len(empty) - 1} more" if len(empty) > 1 else ""
        yield (
            f"is singular: {coordinates.called(int(empty[0]))}{more} has no mass: condense it statically where the "
            "matrices are made, or give it a mass"
        )
    elif lowest := _below(M, least=0.0):
        yield f"is not positive definite: {lowest}: a motion without mass, or with a negative one"


def stiffness_faults(K: Any, M: Any) -> Iterator[str]:
    """Complaints about a stiffness with a negative direction; a free body is none."""
    if lowest := _below(K, least=-NEGATIVE, against=M):
        yield f"is not positive semidefinite: {lowest}: a direction in which it pushes on"


def damping_faults(C: Any, M: Any) -> Iterator[str]:
    """Complaints about a damping that feeds energy in."""
    if lowest := _below(C, least=-NEGATIVE, against=M):
        yield f"is not positive semidefinite: {lowest}: a motion that it feeds energy into"


def _below(matrix: Any, least: float, against: Any = None) -> str:
    """The eigenvalues that are too low, in words; empty where there is none. ``against``: the mass."""
    if isinstance(matrix, np.ndarray):
        from scipy.linalg import eigh

        values = eigh(matrix, against, eigvals_only=True)
        scale = float(np.max(np.abs(values)))
        floor = np.finfo(float).eps * len(values) if least == 0 else least
        count = int(np.count_nonzero(values <= floor * scale if least == 0 else values < least * scale))
        return (
            f"{count} of its {len(values)} eigenvalues {_are(count, least)}, the lowest {values[0]:.3g}"
            if count
            else ""
        )
    from vibeam_models.sparse_factor import factor

    scale = 0.0 if against is None else float(np.max(np.abs(matrix.diagonal()) / against.diagonal()))
    factors = factor(matrix if against is None else matrix - (least * scale) * against, keep=against is None)
    if against is None and not factors.regular:
        return "it has no inverse"
    count = factors.negative
    return f"{count} of its {matrix.shape[0]} eigenvalues {_are(count, least)}" if count else ""


def _are(count: int, least: float) -> str:
    return f"{'is' if count == 1 else 'are'} {'not above' if least == 0 else 'below'} 0"
