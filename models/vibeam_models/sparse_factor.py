"""Multifrontal factors of sparse symmetric matrices: Cholesky's, or LDLᵀ in the fronts where one is indefinite.

Nested dissection gives fronts, each with its own coordinates and a border of later ones that these touch. A front is a
dense matrix: what the matrix has there, and the Schur complements of the fronts that end in it (I. S. Duff & J. K.
Reid, ACM Trans. Math. Softw. 9, 1983; J. Liu, SIAM Review 34, 1992). The number of negative eigenvalues is the sum of
those of the fronts' own blocks (E. Haynsworth, Linear Algebra Appl. 1, 1968). Sizes are known before any number is
factored.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from vibeam_models.arrays import Array, Index
from vibeam_models.memory import check_room
from vibeam_models.sparse_ordering import compressed, dissection, is_net

WEAK = 1e-8  # share of its diagonal entry below which a pivot may be round-off
TINY = float(np.finfo(float).tiny)
WRONG = 0.03  # residual, of a right side of 1, of a solution that is round-off


@dataclass(frozen=True, eq=False)
class Front:
    """Own coordinates ``begin``:``end`` in the order of elimination, and the later ones ``border`` (k,) they touch.

    ``children``: fronts whose Schur complements are added, with the first of their border that is not of this front's
    own, and the places of their border in this front's own and in its border.
    """

    begin: int
    end: int
    border: Index
    children: tuple[tuple[int, int, Index, Index], ...]


@dataclass(frozen=True, eq=False)
class Symbolic:
    """Fronts of a sparsity pattern; ``order`` (n,): the coordinates as they are eliminated, ``place`` its inverse."""

    order: Index
    place: Index
    fronts: tuple[Front, ...]

    def bytes(self, keep: bool = True) -> int:
        """Largest memory in bytes while the matrix is factored: entries, if they are kept, and what waits."""
        most = kept = waiting = 0
        for front in self.fronts:
            own, border = front.end - front.begin, len(front.border)
            most = max(most, kept + waiting + 2 * own * own + own * border + border * border)
            kept += own * (own + border) * keep
            waiting += border * border - sum(len(self.fronts[child].border) ** 2 for child, *_ in front.children)
        return 8 * most


def symbolic(pattern: Any) -> Symbolic:
    """Fronts of a symmetric ``pattern`` (n, n), a CSC array whose diagonal is stored."""
    graph = compressed(pattern)
    parts = dissection(graph)
    vertices = np.concatenate(parts)
    rank = np.empty(len(vertices), dtype=np.int64)
    rank[vertices] = np.arange(len(vertices))
    ends = np.cumsum([len(part) for part in parts])
    borders, children = _borders(graph.adjacent, parts, rank, ends)
    starts = np.concatenate(([0], np.cumsum(graph.weight[vertices])))
    order = np.argsort(rank[graph.group], kind="stable")
    place = np.empty(len(order), dtype=np.int64)
    place[order] = np.arange(len(order))
    spread = [_ranges(starts[border], starts[border + 1]) for border in borders]
    fronts = []
    for number, end in enumerate(ends):
        begin, last = int(starts[end - len(parts[number])]), int(starts[end])
        links = tuple((child, *_places(spread[child], begin, last, spread[number])) for child in children[number])
        fronts.append(Front(begin, last, spread[number], links))
    return Symbolic(order, place, tuple(fronts))


def pattern_of(*matrices: Any) -> Any:
    """Sparsity pattern (n, n) of symmetric sparse matrices together, with the diagonal."""
    from scipy.sparse import csc_array, eye_array

    ones = [csc_array((np.ones(len(m.data), dtype=np.int8), m.indices, m.indptr), shape=m.shape) for m in matrices]
    return sum(ones, start=csc_array(eye_array(matrices[0].shape[0], dtype=np.int8)))


def congruent_pattern(pattern: Any, basis: Any) -> Any:
    """Entries of BᵀAB of a ``pattern`` A (n, n) and a sparse ``basis`` B (n, m), all 0, those by chance among them."""
    from scipy.sparse import csc_array

    columns = csc_array(basis)
    ones = csc_array((np.ones(columns.nnz), columns.indices, columns.indptr), shape=columns.shape)
    entries = csc_array((np.ones(pattern.nnz), pattern.indices, pattern.indptr), shape=pattern.shape)
    return 0.0 * (ones.T.tocsc() @ (entries @ ones))


def _borders(near: Any, parts: list[Index], rank: Index, ends: Index) -> tuple[list[Index], list[list[int]]]:
    """Ranks of the later vertices that each front touches, and the fronts that end in each."""
    borders: list[Index] = []
    children: list[list[int]] = [[] for _ in parts]
    for number, part in enumerate(parts):
        touched = [rank[near.indices[_ranges(near.indptr[part], near.indptr[part + 1])]]]
        found = np.unique(np.concatenate([*touched, *(borders[child] for child in children[number])]))
        borders.append(found[found >= ends[number]])
        if len(borders[-1]):
            children[int(np.searchsorted(ends, borders[-1][0], side="right"))].append(number)
    return borders, children


def _ranges(begins: Index, ends: Index) -> Index:
    """The numbers of all ranges one after the other."""
    lengths = ends - begins
    shifts = np.repeat(begins - np.concatenate(([0], np.cumsum(lengths)[:-1])), lengths)
    return np.asarray(shifts + np.arange(len(shifts)), dtype=np.int64)


def _places(border: Index, begin: int, end: int, beyond: Index) -> tuple[int, Index, Index]:
    split = int(np.searchsorted(border, end))
    return split, border[:split] - begin, np.searchsorted(beyond, border[split:])


@dataclass(frozen=True, eq=False)
class FrontFactor:
    """Factors of a front: L₁₁ and L₂₁ of Cholesky's; or, with ``pivots``, LDLᵀ of its own block and A₂₁A₁₁⁻¹."""

    own: Array
    beyond: Array
    pivots: Any = None


@dataclass(frozen=True, eq=False)
class Fronts:
    """The factors of a matrix by front."""

    symbolic: Symbolic
    blocks: tuple[FrontFactor, ...]

    def solve(self, right: Array) -> Array:
        """The solution (n,) or (n, k) for a right side."""
        from scipy.linalg.blas import dtrsm
        from scipy.linalg.lapack import dsytrs

        x = right.reshape(len(right), -1)[self.symbolic.order]
        pairs = list(zip(self.symbolic.fronts, self.blocks, strict=True))
        for front, block in pairs:
            own = x[front.begin : front.end]
            if block.pivots is None:
                own[:] = dtrsm(1.0, block.own, own, lower=1)
                x[front.border] -= block.beyond @ own
            else:
                x[front.border] -= block.beyond @ own
                own[:] = dsytrs(block.own, block.pivots, own, lower=1)[0]
        for front, block in reversed(pairs):
            own, later = x[front.begin : front.end], block.beyond.T @ x[front.border]
            own[:] = own - later if block.pivots is not None else dtrsm(1.0, block.own, own - later, lower=1, trans_a=1)
        return np.asarray(x[self.symbolic.place].reshape(right.shape))


@dataclass(frozen=True, eq=False)
class SymmetricFactor:
    """The ``factors`` of a symmetric matrix; ``symbolic``: their fronts, None where they are SuperLU's.

    ``regular``: the matrix has an inverse, without which there are no factors; ``negative``: the number of its
    eigenvalues below 0; ``weakest``: the smallest pivot as a share of its diagonal entry.
    """

    factors: Any
    symbolic: Symbolic | None
    regular: bool
    negative: int
    weakest: float

    def solve(self, right: Array) -> Array:
        """The solution (n,) or (n, k) for a right side."""
        return np.asarray(self.factors.solve(np.asarray(right, dtype=float)))


def factor(matrix: Any, known: Symbolic | None = None, keep: bool = True) -> SymmetricFactor:
    """Factor a sparse symmetric matrix (n, n); ``known``: fronts of a pattern that holds the matrix's.

    Without them SuperLU factors a net (``is_net``), whose fronts would be too small to be worth it. ``keep`` = False:
    the negative eigenvalues are counted, and nothing kept.
    """
    matrix = matrix.tocsc()
    found = _of_net(matrix) if known is None and is_net(matrix) else None
    return found or _by_fronts(matrix, symbolic(pattern_of(matrix)) if known is None else known, keep)


def _by_fronts(matrix: Any, known: Symbolic, keep: bool) -> SymmetricFactor:
    coordinates = f"a structure of {len(known.order)} coordinates"
    check_room(coordinates, known.bytes(keep), "take a coarser mesh, or half of it where it is symmetric")
    sizes = _sizes(matrix)[known.order]
    waiting: dict[int, Array] = {}
    blocks: list[FrontFactor] = []
    negative, weakest, weak = 0, np.inf, 0
    where = np.full(len(known.order), -1)
    for number, front in enumerate(known.fronts):
        own, beyond, later = _assembled(matrix, known, front, where, waiting)
        block, pivots = _eliminated(own, beyond, later)
        shares = np.abs(pivots) / sizes[front.begin : front.end]
        if not shares.min() >= weakest:
            weakest, weak = float(shares.min()), front.begin + int(np.argmin(shares))
        if not weakest > TINY:
            return SymmetricFactor(None, known, False, 0, 0.0)
        negative += int(np.count_nonzero(pivots < 0))
        if len(front.border):
            waiting[number] = later
        if keep:
            blocks.append(block)
    found = SymmetricFactor(Fronts(known, tuple(blocks)), known, True, negative, weakest)
    return _judged(found, matrix, int(known.order[weak])) if keep else found


def _of_net(matrix: Any) -> SymmetricFactor | None:
    """SuperLU's factors; None where it took rows and columns in another order, so that the signs say nothing."""
    from scipy.sparse.linalg import splu

    try:
        found = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError:  # exactly singular
        return SymmetricFactor(None, None, False, 0, 0.0)
    if not np.array_equal(found.perm_r, found.perm_c):
        return None
    pivots = found.U.diagonal()[found.perm_c]
    shares = np.abs(pivots) / _sizes(matrix)
    weak, negative = int(np.argmin(shares)), int(np.count_nonzero(pivots < 0))
    return _judged(SymmetricFactor(found, None, True, negative, float(shares[weak])), matrix, weak)


def _sizes(matrix: Any) -> Array:
    """Sizes of the diagonal's entries; where one is 0, the largest, or 1."""
    diagonal = np.abs(matrix.diagonal())
    return np.asarray(np.where(diagonal == 0, diagonal.max() or 1.0, diagonal))


def _judged(found: SymmetricFactor, matrix: Any, weak: int) -> SymmetricFactor:
    """The factors if they are any: where the weakest pivot is small, if they solve for a force on its coordinate."""
    if found.weakest > WEAK:
        return found
    sizes = np.sqrt(_sizes(matrix))
    right = np.zeros(len(sizes))
    right[weak] = sizes[weak]
    fine = found.weakest > TINY and np.linalg.norm((matrix @ found.solve(right) - right) / sizes) < WRONG
    return found if fine else replace(found, factors=None, regular=False)


def _assembled(
    matrix: Any, known: Symbolic, front: Front, where: Index, waiting: dict[int, Array]
) -> tuple[Array, Array, Array]:
    """The front's own block, its rows beyond, and what its children leave of the border's: lower triangles."""
    size, border = front.end - front.begin, len(front.border)
    own, beyond, later = (np.zeros(shape, order="F") for shape in ((size, size), (border, size), (border, border)))
    columns = known.order[front.begin : front.end]
    begins, ends = matrix.indptr[columns], matrix.indptr[columns + 1]
    entries = _ranges(begins, ends)
    rows = known.place[matrix.indices[entries]]
    column = np.repeat(np.arange(size), ends - begins)
    data = matrix.data[entries]
    inside, after = (rows >= front.begin) & (rows < front.end), rows >= front.end
    own[rows[inside] - front.begin, column[inside]] = data[inside]
    where[front.border] = np.arange(border)
    row = where[rows[after]]
    where[front.border] = -1
    if row.min(initial=0) < 0:
        raise ValueError("factor: the matrix has entries outside the pattern that its fronts are of")
    beyond[row, column[after]] = data[after]
    for child, split, mine, further in front.children:
        left = waiting.pop(child)
        inner, outer = _runs(mine), _runs(further)
        _add(own, inner, inner, left[:split, :split])
        _add(beyond, outer, inner, left[split:, :split])
        _add(later, outer, outer, left[split:, split:])
    return own, beyond, later


def _add(to: Array, rows: list[tuple[slice, slice]], columns: list[tuple[slice, slice]], values: Array) -> None:
    """Add run by run; of a symmetric part the lower triangle."""
    for number, (column, j) in enumerate(columns):
        for row, i in rows[number if rows is columns else 0 :]:
            to[row, column] += values[i, j]


def _runs(places: Index) -> list[tuple[slice, slice]]:
    """Runs of successive ascending places, and where they are among them."""
    bounds = [0, *(np.flatnonzero(np.diff(places) != 1) + 1).tolist(), len(places)]
    return [
        (slice(first := int(places[begin]), first + end - begin), slice(begin, end))
        for begin, end in pairwise(bounds)
        if end > begin
    ]


def _eliminated(own: Array, beyond: Array, later: Array) -> tuple[FrontFactor, Array]:
    """A front's factors and its pivots; its Schur complement is left in ``later``."""
    from scipy.linalg.blas import dgemm, dsyrk, dtrsm
    from scipy.linalg.lapack import dpotrf, dsytrf, dsytrs

    lower, fault = dpotrf(own, lower=1, clean=0)
    if not fault:
        if len(beyond):
            beyond = dtrsm(1.0, lower, beyond, side=1, lower=1, trans_a=1, overwrite_b=1)
            dsyrk(-1.0, beyond, beta=1.0, c=later, lower=1, overwrite_c=1)
        return FrontFactor(lower, beyond), np.diagonal(lower) ** 2
    lower, pivots, _ = dsytrf(own, lower=1, lwork=64 * len(own))
    values = _pivots(lower, pivots)
    if not len(beyond) or not values.all():
        return FrontFactor(lower, beyond, pivots), values
    solved = dsytrs(lower, pivots, np.asfortranarray(beyond.T), lower=1)[0]
    dgemm(-1.0, beyond, solved, beta=1.0, c=later, overwrite_c=1)
    return FrontFactor(lower, np.asfortranarray(solved.T), pivots), values


def _pivots(lower: Array, pivots: Any) -> Array:
    """Eigenvalues of the diagonal blocks of Bunch's and Kaufman's factors: of 1 × 1, or of 2 × 2, one of each sign."""
    found = np.diagonal(lower).copy()
    pairs = np.flatnonzero(pivots < 0)[::2]
    for i in pairs:
        a, b, c = lower[i, i], lower[i + 1, i], lower[i + 1, i + 1]
        found[i], found[i + 1] = np.linalg.eigvalsh([[a, b], [b, c]])
    return found
