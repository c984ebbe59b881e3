"""Nested dissection of the graph of a sparse symmetric matrix: the order in which its coordinates are eliminated.

Coordinates that touch the same others, as the three of a node, are one vertex of the graph. Where the neighbourhoods of
vertices of least degree hold all of its edges, they are elements, as of the midpoints of quadratic hexahedra; otherwise
each vertex is one. A part is cut where the difference of the distances to two far elements is near its median, by the
pair whose cut leaves the fewest coordinates between the halves: along the mesh's own lines, since distances are counted
from face to face. What both halves touch is eliminated after them (A. George, SIAM J. Numer. Anal. 10, 1973; A. George
& J. Liu, Computer Solution of Large Sparse Positive Definite Systems, 1981, ch. 8).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from vibeam_models.arrays import Index

LEAF = 200  # coordinates of a part that is cut no further
SPARSE, WIDE = 12, 3  # entries a column of a net, and times √n coordinates at one distance, at most
COVERED = 0.9  # share of the edges that lie in elements, where there are any; a mass on a section ties others
LANDMARKS = 8  # far elements of a part, whose distances are compared in pairs
LEAST = 0.3  # share of the coordinates that a half may have at least, where the distances allow it
STRONG = 0.4  # share of the most coordinates an element has in common with another, from which the two are face to face


def is_net(matrix: Any) -> bool:
    """Test whether a matrix is that of a net or a chain: few entries a column, and few coordinates at any distance."""
    if matrix.nnz > SPARSE * matrix.shape[0]:
        return False
    far = int(np.argmax(_distance(matrix, 0)))
    return bool(np.bincount(_distance(matrix, far)).max() <= WIDE * np.sqrt(matrix.shape[0]))


@dataclass(frozen=True, eq=False)
class Graph:
    """Vertices of equal sparsity: ``group`` (n,) the vertex of each coordinate, ``weight`` (vertices,) their number.

    ``adjacent``: sparse (vertices, vertices) array of rows, each vertex beside itself.
    """

    group: Index
    weight: Index
    adjacent: Any


def compressed(pattern: Any) -> Graph:
    """Graph of a symmetric ``pattern`` (n, n), a CSC array with its diagonal."""
    n = pattern.shape[0]
    marks = np.random.default_rng(0).integers(1, 2**62, n, dtype=np.int64)
    sums = np.add.reduceat(marks[pattern.indices], pattern.indptr[:-1])
    _, first, group, weight = np.unique(sums, return_index=True, return_inverse=True, return_counts=True)
    chosen = pattern[:, first].tocsr()[first]
    return Graph(group, weight, chosen)


def dissection(graph: Graph) -> list[Index]:
    """Vertices (k,) of each front in the order of elimination: what a front touches beyond itself comes later."""
    elements, faces = _elements(graph)
    fronts: list[Index] = []
    pending: list[tuple[Index, Index, bool]] = [(np.arange(len(graph.weight)), np.arange(faces.shape[0]), False)]
    while pending:  # a separator waits below its halves
        vertices, cells, whole = pending.pop()
        if whole or graph.weight[vertices].sum() <= LEAF or len(cells) < 2:
            fronts.append(vertices)
            continue
        one, other, between = _cut(graph, elements[vertices][:, cells], faces[cells][:, cells], vertices)
        pending.append((vertices[between], cells[:0], True))
        for half in (one, other):
            touched = np.unique(elements[vertices[half]][:, cells].indices)
            pending.append((vertices[half], cells[touched], False))
    return _sorted(graph, [front for front in fronts if len(front)])


def _sorted(graph: Graph, fronts: list[Index]) -> list[Index]:
    """The vertices of each front by the first front that touches them: what a front touches then is in few runs."""
    number = np.empty(len(graph.weight), dtype=np.int64)
    number[np.concatenate(fronts)] = np.repeat(np.arange(len(fronts)), [len(front) for front in fronts])
    first = np.minimum.reduceat(number[graph.adjacent.indices], graph.adjacent.indptr[:-1])
    return [front[np.argsort(first[front], kind="stable")] for front in fronts]


def _elements(graph: Graph) -> tuple[Any, Any]:
    """Vertices of the elements (vertices, elements), and which of these are face to face.

    Neighbourhoods that leave many edges out are none of a mesh: each vertex is then an element of its own.
    """
    from scipy.sparse import csr_array, eye_array

    near = csr_array((np.ones(graph.adjacent.nnz, dtype=np.int32), graph.adjacent.indices, graph.adjacent.indptr))
    found = near[:, _midpoints(near)].tocsr()
    if (found @ found.T).multiply(near).nnz >= COVERED * near.nnz:
        return found, _faces(found.T @ found.multiply(graph.weight[:, None]))
    return csr_array(eye_array(len(graph.weight), dtype=np.int32)), _faces((near @ near).multiply(near))


def _midpoints(near: Any) -> Index:
    """Vertices of least degree, no two of them neighbours, and every other vertex beside one."""
    degree = np.diff(near.indptr)
    rank = np.empty(len(degree), dtype=np.int64)
    rank[np.lexsort((np.random.default_rng(1).random(len(degree)), degree))] = np.arange(len(degree))
    undecided, chosen = np.ones(len(degree), dtype=bool), np.zeros(len(degree), dtype=bool)
    while undecided.any():
        open_rank = np.where(undecided, rank, len(rank))
        least = np.minimum.reduceat(open_rank[near.indices], near.indptr[:-1])
        fresh = undecided & (least == rank)
        chosen |= fresh
        undecided &= ~fresh & (near @ fresh.astype(np.int32) == 0)
    return np.flatnonzero(chosen)


def _faces(shared: Any) -> Any:
    from scipy.sparse import csr_array

    pairs = shared.tocoo()
    apart = pairs.row != pairs.col
    row, column, common = pairs.row[apart], pairs.col[apart], pairs.data[apart]
    most = np.zeros(shared.shape[0], dtype=common.dtype)
    np.maximum.at(most, row, common)
    strong = common >= STRONG * np.minimum(most[row], most[column])
    return csr_array((np.ones(int(strong.sum()), dtype=np.int8), (row[strong], column[strong])), shape=shared.shape)


def _cut(graph: Graph, elements: Any, faces: Any, vertices: Index) -> tuple[Index, Index, Index]:
    """The halves of a part, and what is between them: places in ``vertices``."""
    weight = graph.weight[vertices]
    size = np.bincount(
        elements.indices, np.repeat(weight / np.diff(elements.indptr), np.diff(elements.indptr)), elements.shape[1]
    )
    low = _candidates(faces, size)  # (elements, candidates)
    in_one, in_other = elements @ low > 0, elements @ (1 - low) > 0
    both = weight @ (in_one & in_other)
    one, other = weight @ (in_one & ~in_other), weight @ (in_other & ~in_one)
    best = int(np.argmin(both / np.maximum(one * other, 1e-9)))
    side = np.where(in_one[:, best], np.where(in_other[:, best], 2, 0), 1)
    _separate(graph, vertices, side)
    return tuple(np.flatnonzero(side == each) for each in range(3))  # type: ignore[return-value]


def _separate(graph: Graph, vertices: Index, side: Index) -> None:
    """Move vertices between the halves where an edge still joins these."""
    if (side == 2).all():
        return
    near = graph.adjacent[vertices[side == 0]][:, vertices[side == 1]]
    if near.nnz:
        touching = np.flatnonzero(np.diff(near.indptr)), np.unique(near.indices)
        which = int(len(touching[1]) < len(touching[0]))
        side[np.flatnonzero(side == which)[touching[which]]] = 2


def _candidates(faces: Any, size: Any) -> Any:
    """Lower halves (elements, candidates), 1 or 0, of a part by differences of distances."""
    from scipy.sparse.csgraph import connected_components

    count, component = connected_components(faces, directed=False)
    if count > 1:
        sizes = np.bincount(component, size)
        order = np.argsort(-sizes)
        low = np.zeros(count, dtype=np.int32)
        halves = [0.0, 0.0]
        for each in order:
            which = int(halves[1] < halves[0])
            low[each] = which
            halves[which] += sizes[each]
        return low[component][:, None]
    distances = _distances(faces)
    pairs = [(i, j) for i in range(len(distances)) for j in range(i)]
    return np.stack([_lower(distances[i] - distances[j], size) for i, j in pairs], axis=1)


def _lower(height: Index, size: Any) -> Any:
    """1 below the level nearest to the median of ``height``, if that can be where no half is too small."""
    order = np.argsort(height, kind="stable")
    share = np.cumsum(size[order]) / size.sum()
    steps = np.flatnonzero(np.diff(height[order])) if len(order) > 1 else order[:0]
    cut = int(np.argmin(np.abs(share - 0.5)))
    if len(steps):
        nearest = int(steps[np.argmin(np.abs(share[steps] - 0.5))])
        cut = nearest if LEAST < share[nearest] < 1 - LEAST else cut
    low = np.zeros(len(order), dtype=np.int32)
    low[order[: min(cut + 1, len(order) - 1)]] = 1
    return low


def _distances(faces: Any) -> list[Index]:
    start = int(np.argmax(_distance(faces, 0)))
    found = [_distance(faces, start)]
    for _ in range(min(LANDMARKS, faces.shape[0]) - 1):
        found.append(_distance(faces, int(np.argmax(np.min(found, axis=0)))))
    return found


def _distance(faces: Any, start: int) -> Index:
    """Number of faces crossed from an element to each, by breadth first; 0 where none leads there."""
    from scipy.sparse.csgraph import breadth_first_order

    order, before = breadth_first_order(faces, start, directed=False)
    place = np.zeros(faces.shape[0], dtype=np.int64)
    place[order] = np.arange(len(order))
    parents = place[before[order[1:]]]  # ascending
    bounds = [0, 1]
    while bounds[-1] < len(order):
        bounds.append(1 + int(np.searchsorted(parents, bounds[-1])))
    found = np.zeros(faces.shape[0], dtype=np.int64)
    found[order] = np.repeat(np.arange(len(bounds) - 1), np.diff(bounds))
    return found
