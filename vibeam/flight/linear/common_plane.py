"""The invariant plane of two eigenvalues that nearly coincide: where they do, there are no two eigenvectors."""

from __future__ import annotations

import numpy as np

from vibeam_models.arrays import Array, Complex

INSEPARABLE = (
    "damping: modes coincide so nearly, in rates and shapes, that contact has no closed form in which they are told "
    "apart: make their damping ratios differ by 0.1 % or more"
)

DISTINCT = 1e-4  # relative distance of two eigenvalues above which QR's eigenvectors span their plane


def common_plane(state: Array, pair: Complex, vectors: Complex) -> tuple[Array, Array]:
    """The invariant plane of two nearly equal eigenvalues, which needs no eigenvectors of its own."""
    from scipy.linalg import schur

    distance, size = float(abs(pair[1] - pair[0])), float(np.max(np.abs(pair)))
    if distance > DISTINCT * size:
        second = vectors[:, 0].imag if pair[0].imag != 0 else vectors[:, 1].real
        column = np.linalg.qr(np.stack([vectors[:, 0].real, second], axis=1))[0]
        return column, column.T @ state @ column
    middle, limit = pair.mean().real, _limit(schur(state, output="real")[0], pair.mean().real)
    _, every, count = schur(state, output="real", sort=lambda x, y=0.0: abs(complex(x, y) - middle) <= limit)
    if count != 2:
        raise ValueError(INSEPARABLE)
    column = np.asarray(every[:, :2])
    return column, column.T @ state @ column


def _limit(triangle: Array, middle: float) -> float:
    """The distance from ``middle`` between that of the two nearest eigenvalues of a real Schur form and the third's.

    Round-off parts a double eigenvalue by its root, in every algorithm in another way: how far the two are apart says
    little.
    """
    distance = np.sort(np.abs(np.linalg.eigvals(triangle) - middle))
    return float(np.sqrt(distance[1] * distance[2])) if len(distance) > 2 else np.inf
