"""Kinematic elimination: the coordinates that are left where some rows are held."""

from __future__ import annotations

from typing import Any

import numpy as np

from vibeam_models.arrays import Array


def elimination(rows: Array) -> Any:
    """Z (n, n − k), sparse, with rows @ Z = 0 for independent ``rows`` (k, n): x = Z y holds them.

    Of each row one coordinate goes, chosen by QR with column pivoting; all others stay as they are.
    """
    from scipy.linalg import qr
    from scipy.sparse import csc_array, lil_array

    count, size = rows.shape
    order = qr(rows, mode="r", pivoting=True)[1]
    gone, left = np.sort(order[:count]), np.sort(order[count:])
    made = lil_array((size, len(left)))
    made[left, np.arange(len(left))] = 1.0
    ties = -np.linalg.solve(rows[:, gone], rows[:, left])
    for coordinate, tie in zip(gone, ties, strict=True):
        used = np.flatnonzero(tie)
        made[[coordinate], used] = tie[used]
    return csc_array(made)
