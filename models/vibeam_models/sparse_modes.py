"""The lowest natural modes of sparse matrices: shift-invert Lanczos with one sparse factor, and a count of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.structure import STIFF

SINGULAR = 1e-14  # share of the largest pivot below which the smallest is round-off
ROUGH = 1e-9  # first shift of a free body, as a share of a bound from below of its highest ω²
RIGID = 1e-6  # share of the first shift below which ω² is that of a rigid motion
TRIES = 6  # of modes that were left out
SPARE = 5  # modes beyond those asked for, so that a close one is not left out


@dataclass(frozen=True, eq=False)
class SymmetricFactor:
    """The sparse factors of a symmetric matrix; ``pivots`` (n,): as many are negative as it has eigenvalues below 0.

    ``regular``: no pivot is round-off. The pivots are the matrix's only where ``symmetric`` (rows taken as columns).
    """

    factors: Any
    pivots: Array
    symmetric: bool

    @property
    def regular(self) -> bool:
        """Test whether the matrix has an inverse."""
        sizes = np.abs(self.pivots)
        return bool(sizes.min() > SINGULAR * sizes.max())

    @property
    def negative(self) -> int:
        """Number of eigenvalues below 0 (Sylvester's law of inertia)."""
        return int(np.count_nonzero(self.pivots < 0))

    def solve(self, right: Array) -> Array:
        """The solution (n,) or (n, k) for a right side."""
        return np.asarray(self.factors.solve(np.asarray(right, dtype=float)))


def factor(matrix: Any) -> SymmetricFactor:
    """Factor a sparse symmetric matrix (n, n), rows and columns in the same order."""
    from scipy.sparse.linalg import splu

    try:
        found = splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError:  # exactly singular
        return SymmetricFactor(None, np.zeros(matrix.shape[0]), True)
    return SymmetricFactor(found, found.U.diagonal(), bool(np.array_equal(found.perm_r, found.perm_c)))


def lowest_modes(K: Any, M: Any, count: int, inverse: SymmetricFactor) -> tuple[Array, Array]:
    """ω² (count,) ascending and shapes (n, count) with ΦᵀMΦ = I, of sparse ``K`` ≥ 0 and ``M`` > 0.

    ``inverse``: the factors of K.

    The eigenvalues 1/(ω² + s) of (K + s M)⁻¹ M are found by Lanczos' method (ARPACK), with s = 0, or, for a free body,
    the first ω² above 0. Sylvester's law then counts the eigenvalues below the last one: where a multiple frequency has
    more modes than were found, they are looked for beside these. ValueError for a negative stiffness.
    """
    shift = 0.0
    highest = float(np.max(K.diagonal() / M.diagonal()))
    if not inverse.regular:
        rough = ROUGH * highest
        squared, _ = _lanczos(K, M, rough, factor(K + rough * M), min(count + SPARE, K.shape[0] - 1))
        flexible = squared[squared > RIGID * rough]
        shift = float(flexible[0]) if len(flexible) else rough
        inverse = factor(K + shift * M)
    squared, shapes = _lanczos(K, M, shift, inverse, min(count + SPARE, K.shape[0] - 1))
    if squared[0] < -STIFF * highest:
        raise ValueError("structure: K: must be positive semidefinite: a direction has negative stiffness")
    for _ in range(TRIES):
        missing = _missing(K, M, squared, count)
        if not missing:
            return squared[:count], shapes[:, :count]
        more = _lanczos(K, M, shift, inverse, min(missing + SPARE, K.shape[0] - 1 - len(squared)), shapes)
        order = np.argsort(together := np.append(squared, more[0]))
        squared, shapes = together[order], np.column_stack((shapes, more[1]))[:, order]
    raise ValueError(f"structure: {missing} of the lowest modes were not found: ask for a few more or fewer")


def _lanczos(
    K: Any, M: Any, shift: float, inverse: SymmetricFactor, count: int, known: Array | None = None
) -> tuple[Array, Array]:
    """The lowest modes of those that are orthogonal to the ``known`` ones."""
    from scipy.sparse.linalg import LinearOperator, eigsh

    n = K.shape[0]
    momenta = None if known is None else M @ known

    def solved(right: Array) -> Array:
        found = inverse.solve(right.ravel())
        return found if known is None or momenta is None else found - known @ (momenta.T @ found)

    begin = np.random.default_rng(0 if known is None else known.shape[1]).standard_normal(n)  # the same every time
    begin = begin if known is None or momenta is None else begin - known @ (momenta.T @ begin)
    operator = LinearOperator((n, n), matvec=solved, dtype=float)
    squared, shapes = eigsh(K, count, M=M, sigma=-shift, OPinv=operator, v0=begin, tol=0)
    order = np.argsort(squared)
    return squared[order], shapes[:, order]


def _missing(K: Any, M: Any, squared: Array, count: int) -> int:
    """Number of modes that were not found, below the widest gap at or after the last one asked for."""
    spread = np.diff(squared[count - 1 :])
    last = count + int(np.argmax(spread))
    below = factor(K - (squared[last - 1] + squared[last]) / 2 * M)
    return max(below.negative - last, 0) if below.symmetric else 0
