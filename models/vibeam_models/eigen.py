"""Natural modes of K φ = ω² M φ, accurate at both ends of the spectrum."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def natural_modes(K: Array, M: Array) -> tuple[Array, Array]:
    """ω² (n,) ascending and shapes (n, n) with ΦᵀMΦ = I; ``M`` positive definite, ``K`` positive semidefinite.

    Solved as it stands, the problem is exact to 10⁻¹⁶ of the *highest* ω², which leaves little or nothing of the first
    mode on a fine or light beam; so the modes below the geometric middle come from M φ = ω⁻² K φ. Where ``K`` is
    singular, a free body, they stay as they are.
    """
    from scipy.linalg import LinAlgError, eigh

    squared, shapes = eigh(K, M)
    try:
        inverse, flexible = eigh(M, K)
    except LinAlgError:
        return squared, shapes
    inverse, flexible = inverse[::-1], flexible[:, ::-1]
    low = int(np.count_nonzero(inverse > 1 / np.sqrt(squared[-1] / inverse[0])))
    squared[:low] = 1 / inverse[:low]
    shapes[:, :low] = flexible[:, :low] / np.sqrt(inverse[:low])
    return squared, shapes
