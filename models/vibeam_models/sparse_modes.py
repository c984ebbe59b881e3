"""The lowest natural modes of sparse matrices: block Lanczos with one sparse factor, and a count of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.sparse_factor import SymmetricFactor, factor
from vibeam_models.structure import STIFF

ROUGH = STIFF  # first shift of a free body, as a share of a bound from below of its highest ω²
RIGID = 1e-6  # share of the first shift below which ω² is that of a rigid motion
TRIES = 6  # of modes that were left out
SPARE = 5  # modes beyond those asked for, so that a close one is not left out
BLOCK = 8  # vectors solved for at once: the factors are read once for all of them
SETTLED = 1e-12  # residual of a mode, as a share of its 1/(ω² + s), at which it is found
NEAR = 1e-5  # the same of the spare ones, whose frequencies are then right to about its square
ROUND_OFF = 1e-15  # the same as a share of the largest
EXHAUSTED = 1e-10  # share of a vector that is left where the Krylov space is complete
GROWTH = 0.1  # share by which the Krylov space grows between two looks at its modes
CLEAR = 1e-12  # weakest pivot with which a count of negative eigenvalues is trusted


def lowest_modes(K: Any, M: Any, count: int, inverse: SymmetricFactor) -> tuple[Array, Array]:
    """ω² (count,) ascending and shapes (n, count) with ΦᵀMΦ = I, of sparse ``K`` ≥ 0 and ``M`` > 0.

    ``inverse``: the factors of K, by fronts that hold the pattern of M too.

    The eigenvalues 1/(ω² + s) of (K + s M)⁻¹ M are found by Lanczos' method in blocks, with s = 0, or, for a free body,
    the first ω² above 0. Sylvester's law then counts the eigenvalues below the last one: where a multiple frequency has
    more modes than were found, they are looked for beside these. ValueError for a negative stiffness.
    """
    shift = 0.0
    highest = float(np.max(K.diagonal() / M.diagonal()))
    if inverse.negative or not inverse.regular:
        rough = ROUGH * highest
        inverse = factor(K + rough * M, inverse.symbolic)
        if inverse.negative:
            raise ValueError("structure: K: must be positive semidefinite: a direction has negative stiffness")
        squared, _ = _lanczos(M, rough, inverse, min(count + SPARE, K.shape[0] - 1))
        flexible = squared[squared > RIGID * rough]
        shift, fronts = float(flexible[0]) if len(flexible) else rough, inverse.symbolic
        del inverse  # before the next, which is as large
        inverse = factor(K + shift * M, fronts)
    squared, shapes = _lanczos(M, shift, inverse, min(count + SPARE, K.shape[0] - 1))
    for _ in range(TRIES):
        squared[np.abs(squared) < RIGID * shift] = 0.0
        missing = _missing(K, M, squared, count, inverse)
        if not missing:
            return squared[:count], shapes[:, :count]
        more = _lanczos(M, shift, inverse, min(missing + SPARE, K.shape[0] - 1 - len(squared)), shapes)
        order = np.argsort(together := np.append(squared, more[0]))
        squared, shapes = together[order], np.column_stack((shapes, more[1]))[:, order]
    raise ValueError(f"structure: {missing} of the lowest modes were not found: ask for a few more or fewer")


def _lanczos(
    M: Any, shift: float, inverse: SymmetricFactor, count: int, known: Array | None = None
) -> tuple[Array, Array]:
    """The lowest modes of those that are M-orthogonal to the ``known`` ones (G. Golub & R. Underwood, 1977).

    The last ones, ``SPARE``, are found nearly.
    """
    n = M.shape[0]
    aside = np.zeros((n, 0)) if known is None else known
    begin = np.random.default_rng(aside.shape[1]).standard_normal((n, min(BLOCK, count)))  # the same every time
    look = count
    for space in krylov_spaces(M, inverse, inverse.solve(M @ begin), aside):
        size = len(space.projected)
        if size < look and len(space.rest) and size + aside.shape[1] < n:
            continue
        values, shares = np.linalg.eigh(space.projected)
        values, shares = values[::-1][:count], shares[:, ::-1][:, :count]
        wrong = np.linalg.norm(space.rest @ shares[size - space.rest.shape[1] :], axis=0)
        allowed = np.where(np.arange(count) < count - SPARE, SETTLED, NEAR) * values + ROUND_OFF * values[0]
        if bool((wrong <= allowed).all()):
            break
        look = int(size * (1 + GROWTH)) + 1
    squared = 1 / values - shift
    order = np.argsort(squared)
    return squared[order], space.vectors @ shares[:, order]


@dataclass(frozen=True, eq=False)
class KrylovSpace:
    """M-orthonormal ``vectors`` (n, m), (K + s M)⁻¹ M in them ``projected`` (m, m).

    ``rest`` (left, k): what the image of the last k vectors has beyond them; without rows where the space is complete.
    ``start``: the block it began with in the first vectors.
    """

    vectors: Array
    projected: Array
    rest: Array
    start: Array


def krylov_spaces(M: Any, inverse: SymmetricFactor, block: Array, aside: Array) -> Iterator[KrylovSpace]:
    """Spaces of (K + s M)⁻¹ M that grow from a ``block`` (n, k) by as much at a time, until they are complete.

    They are M-orthogonal to the vectors ``aside`` (n, j).
    """
    first = filled = aside.shape[1]
    vectors = np.empty((len(aside), first + 8 * block.shape[1]), order="F")
    vectors[:, :first] = aside
    block, _, start = _orthonormal(M, block, vectors[:, :filled])
    projected = np.zeros((0, 0))
    while block.shape[1] and filled < len(aside):
        width = block.shape[1]
        vectors = _with_room(vectors, filled + width)
        vectors[:, filled : filled + width] = block
        filled += width
        block, along, rest = _orthonormal(M, inverse.solve(M @ block), vectors[:, :filled])
        projected = np.pad(projected, ((0, width), (0, width)))
        projected[:, -width:] = along[first:]
        projected[-width:] = along[first:].T
        projected[-width:, -width:] = (along[-width:] + along[-width:].T) / 2
        yield KrylovSpace(vectors[:, first:filled], projected, rest, start)


def _with_room(vectors: Array, columns: int) -> Array:
    if columns <= vectors.shape[1]:
        return vectors
    wider = np.empty((len(vectors), columns + columns // 4), order="F")
    wider[:, : vectors.shape[1]] = vectors
    return wider


def _orthonormal(M: Any, block: Array, before: Array) -> tuple[Array, Array, Array]:
    """M-orthonormal Q of what is left of a ``block`` beside the vectors ``before`` V; A and R of block = V A + Q R."""
    along, rest = np.zeros((before.shape[1], block.shape[1])), np.eye(block.shape[1])
    sizes = np.sqrt(np.sum(block * (M @ block), axis=0))
    for _ in range(2):
        share = before.T @ (M @ block)
        along += share @ rest
        block, turn = _side_by_side(M, block - before @ share, sizes)
        rest, sizes = turn @ rest, np.ones(len(turn))
    return block, along, rest


def _side_by_side(M: Any, block: Array, sizes: Array) -> tuple[Array, Array]:
    """M-orthonormal Q and R of a ``block`` Q R, by Gram and Schmidt; without what is round-off beside ``sizes``."""
    columns, momenta, shares = list[Array](), list[Array](), np.zeros((block.shape[1],) * 2)
    for number, column in enumerate(block.T):
        for i, (other, momentum) in enumerate(zip(columns, momenta, strict=True)):
            shares[i, number] = momentum @ column
            column = column - shares[i, number] * other
        momentum = M @ column
        length = float(np.sqrt(max(column @ momentum, 0.0)))
        if length > EXHAUSTED * sizes[number]:
            shares[len(columns), number] = length
            columns.append(column / length)
            momenta.append(momentum / length)
    return np.array(columns).reshape(-1, len(block)).T, shares[: len(columns)]


def _missing(K: Any, M: Any, squared: Array, count: int, inverse: SymmetricFactor) -> int:
    """Number of modes that were not found, below the widest gap at or after the last one asked for."""
    spread = np.diff(squared[count - 1 :])
    last = count + int(np.argmax(spread))
    for share in (0.5, 0.4, 0.6):
        level = (1 - share) * squared[last - 1] + share * squared[last]
        below = factor(K - level * M, inverse.symbolic, keep=False)
        if below.weakest > CLEAR:
            break
    return max(below.negative - last, 0)
