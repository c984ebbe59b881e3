"""Linear elasticity of solid bodies by tetrahedra of ten nodes: K, M, rows, natural frequencies; by numpy and scipy.

    K = ∫ Bᵀ D B dV,  M = ∫ ρ Nᵀ N dV,  B from grad N,  D = λ 1 1ᵀ + 2 μ (Zienkiewicz, The Finite Element Method, ch. 6)

A lattice of boxes, each cut into six tetrahedra around its diagonal (Kuhn 1960), of which a body keeps those inside it;
a map may then bend the lattice, whose elements become isoparametric. Whole bodies alone: no symmetry is used.
Coordinates are x, y, z of node 0, then of node 1 and so on.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import eigsh, splu

EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))


@dataclass(frozen=True)
class Mesh:
    """``nodes`` (n, 3) in m; ``cells`` (m, 10): four corners, then the middles of ``EDGES``."""

    nodes: np.ndarray
    cells: np.ndarray

    @property
    def middles(self):
        """Centres (m, 3) of the cells, of their corners."""
        return self.nodes[self.cells[:, :4]].mean(1)


def lattice(xs, ys, zs, inside=None, bend=None):
    """The boxes between the planes ``xs``, ``ys``, ``zs`` whose centres ``inside(x, y, z)`` takes, their nodes bent."""
    axes = [np.asarray(each, float) for each in (xs, ys, zs)]
    corners = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    number = np.arange(len(corners)).reshape([len(each) for each in axes])
    first = np.stack(np.meshgrid(*(np.arange(len(each) - 1) for each in axes), indexing="ij"), -1).reshape(-1, 3)
    if inside is not None:
        middle = np.array([(each[:-1] + each[1:])[k] / 2 for each, k in zip(axes, first.T, strict=True)])
        first = first[inside(*middle)]
    paths = [np.cumsum([[0, 0, 0], *np.eye(3, dtype=int)[list(order)]], 0) for order in permutations(range(3))]
    cells = np.concatenate([number[tuple((first[:, None] + path).transpose(2, 0, 1))] for path in paths])
    pairs = np.sort(np.concatenate([cells[:, list(edge)] for edge in EDGES]), 1)
    edges, of_cell = np.unique(pairs, axis=0, return_inverse=True)
    of_cell = of_cell.reshape(len(EDGES), -1).T
    nodes = np.concatenate([corners, corners[edges].mean(1)])
    kept, cells = np.unique(np.hstack([cells, len(corners) + of_cell]), return_inverse=True)
    nodes = nodes[kept]
    return Mesh(nodes if bend is None else bend(nodes), cells.reshape(-1, 10))


def shape_functions(places):
    """N (p, 10) and grad N (p, 10, 3) at ``places`` (p, 3) of the reference tetrahedron."""
    lam = np.column_stack([1 - places.sum(1), places])
    slope = np.vstack([-np.ones(3), np.eye(3)])
    values = [each * (2 * each - 1) for each in lam.T] + [4 * lam[:, i] * lam[:, j] for i, j in EDGES]
    slopes = [(4 * lam[:, i, None] - 1) * slope[i] for i in range(4)]
    slopes += [4 * (lam[:, i, None] * slope[j] + lam[:, j, None] * slope[i]) for i, j in EDGES]
    return np.stack(values, -1), np.stack(slopes, 1)


def points(order=4):
    """Places (p, 3) and weights (p,) of Gauss' rule on a cube that is folded into the tetrahedron (Duffy 1982)."""
    at, weight = np.polynomial.legendre.leggauss(order)
    at, weight = (at + 1) / 2, weight / 2
    a, b, c = (each.ravel() for each in np.meshgrid(at, at, at, indexing="ij"))
    weights = np.einsum("i,j,k->ijk", weight, weight, weight).ravel() * (1 - b) * (1 - c) ** 2
    return np.column_stack([a * (1 - b) * (1 - c), b * (1 - c), c]), weights


def matrices(mesh, modulus, poisson, density, order=4):
    """K, M (3n, 3n) of numbers or of one each a cell; ArithmeticError where a cell is turned inside out."""
    modulus, poisson, density = (
        np.broadcast_to(each, len(mesh.cells)).astype(float) for each in (modulus, poisson, density)
    )
    shear = modulus / (2 * (1 + poisson))
    lame = modulus * poisson / ((1 + poisson) * (1 - 2 * poisson))
    places, weights = points(order)
    stiff = np.zeros((len(mesh.cells), 10, 3, 10, 3))
    mass = np.zeros((len(mesh.cells), 10, 10))
    unit, sign = np.eye(3), None
    for value, slope, weight in zip(*shape_functions(places), weights, strict=True):
        jacobian = np.einsum("eia,ib->eab", mesh.nodes[mesh.cells], slope)
        volume = np.linalg.det(jacobian)
        sign = np.sign(volume) if sign is None else sign
        if not (sign * volume > 0).all():
            raise ArithmeticError("a cell is turned inside out")
        grad = np.einsum("ib,eba->eia", slope, np.linalg.inv(jacobian))
        volume = weight * np.abs(volume)
        outer = np.einsum("e,eia,ejb->eiajb", volume, grad, grad)
        stiff += lame[:, None, None, None, None] * outer
        stiff += (shear[:, None, None, None, None]) * outer.transpose(0, 1, 4, 3, 2)
        inner = np.einsum("eiaja->eij", outer)
        stiff += shear[:, None, None, None, None] * np.einsum("eij,ab->eiajb", inner, unit)
        mass += np.einsum("e,i,j->eij", density * volume, value, value)
    names = (3 * mesh.cells[:, :, None] + np.arange(3)).reshape(-1, 30)
    mass = np.einsum("eij,ab->eiajb", mass, unit)
    return tuple(_assembled(each.reshape(-1, 30, 30), names, 3 * len(mesh.nodes)) for each in (stiff, mass))


def _assembled(blocks, names, size):
    rows, columns = np.broadcast_arrays(names[:, :, None], names[:, None, :])
    return sparse.coo_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), (size, size)).tocsc()


def mean_over_patch(mesh, on, direction):
    """Row (3n,): mean over the plane facets whose six nodes are ``on`` (n,) of the displacement along ``direction``.

    Of six nodes the corners have no weight, the middles a third each: exact for a plane triangle (Zienkiewicz).
    """
    row, area = np.zeros((len(mesh.nodes), 3)), 0.0
    for face in ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)):
        middles = [4 + k for k, edge in enumerate(EDGES) if set(edge) <= set(face)]
        met = mesh.cells[on[mesh.cells[:, [*face, *middles]]].all(1)]
        corners = mesh.nodes[met[:, list(face)]]
        size = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
        for middle in middles:
            np.add.at(row, met[:, middle], size[:, None] / 3 * np.asarray(direction, float))
        area += size.sum()
    return row.ravel() / area


def held(mesh, *masks):
    """Z (3n, m) of a body whose nodes ``masks`` = ((n,), directions) … are held."""
    free = np.ones((len(mesh.nodes), 3), bool)
    for mask, directions in masks:
        free[np.ix_(mask, list(directions))] = False
    return sparse.identity(free.size, format="csc")[:, free.ravel()]


def rigid_motions(places):
    """Displacements (3n, 6) of ``places`` (n, 3) moving as one body: along x, y, z, then turning about them."""
    x, y, z = places.T
    nil, one = np.zeros_like(x), np.ones_like(x)
    moves = [(one, nil, nil), (nil, one, nil), (nil, nil, one), (nil, -z, y), (z, nil, -x), (-y, x, nil)]
    return np.stack([np.stack(each, 1).ravel() for each in moves], 1)


def rigid_zone(mesh, mask, centre, mass, inertia):
    """Z (3n, 3n − 3k + 6) of a body whose k nodes ``mask`` move as one, and what its mass adds to the last six of M.

    ``mass`` kg at ``centre`` (3,) m with ``inertia`` (3,) kg m² about x, y, z there.
    """
    move = rigid_motions(mesh.nodes - np.asarray(centre, float)) * np.repeat(mask, 3)[:, None]
    free = sparse.identity(3 * len(mesh.nodes), format="csc")[:, np.repeat(~mask, 3)]
    return sparse.hstack([free, sparse.csc_matrix(move)]).tocsc(), np.diag([mass] * 3 + list(inertia))


def frequencies(stiff, mass, count, shift=0.0):
    """The first ``count`` natural frequencies in Hz above ``shift`` (rad/s)², and their shapes (n, count)."""
    value, shape = eigsh(stiff, count, mass, sigma=shift, which="LM", v0=np.ones(stiff.shape[0]))
    order = np.argsort(value)
    return np.sqrt(np.maximum(value[order], 0)) / (2 * np.pi), shape[:, order]


def deflection(stiff, load):
    """u (n,) of K u = ``load``."""
    return splu(stiff.tocsc()).solve(np.asarray(load, float))
