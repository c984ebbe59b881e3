"""Multipliers of one-sided constraints: the least-squares problem with μ ≥ 0, and projections onto held rows."""

from __future__ import annotations

import numpy as np

from vibeam_models.arrays import Array


def one_sided(rows: Array, vector: Array) -> Array:
    """μ ≥ 0 (k,) that minimises |vector − rowsᵀ μ|: what is left is not positive along any row, 0 where μ > 0.

    Lawson & Hanson, Solving Least Squares Problems, 1974, ch. 23.
    """
    if len(rows) == 1:
        return np.maximum(rows @ vector, 0.0) / float(rows[0] @ rows[0])
    from scipy.optimize import nnls

    sizes, size = np.linalg.norm(rows, axis=1), float(np.linalg.norm(vector)) or 1.0
    found, _ = nnls((rows / sizes[:, None]).T, vector / size)
    return np.asarray(found * size / sizes)


def multipliers(rows: Array) -> Array:
    """(k, n): what takes a vector to the μ that minimise |vector − rowsᵀ μ|, whatever their sign."""
    if len(rows) == 1:
        return np.asarray(rows / float(rows[0] @ rows[0]))
    return np.asarray(np.linalg.pinv(rows @ rows.T, hermitian=True) @ rows)


def within(row: Array, rows: Array) -> bool:
    """Whether a row is a sum of others, to round-off."""
    if not len(rows):
        return False
    left = row - (multipliers(rows) @ row) @ rows
    return bool(np.linalg.norm(left) <= 1e-10 * np.linalg.norm(row))
