"""Quadratic finite elements of a solid: stiffness and mass by batched products of gradients.

Linear isotropic elasticity, K = ∫ λ div u div v + 2μ ε(u) : ε(v) (T. J. R. Hughes, The Finite Element Method, 2000,
§2.7), on the quadratic field of hexahedra (27 nodes) or tetrahedra (10). A displacement u (3 k,) has the components
x, y, z of each of the k nodes in turn, so that K is made of blocks of 3 × 3. scikit-fem numbers the nodes and has the
shape functions; its loop over the pairs of these takes twenty times as long as one matrix product an element.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from vibeam_models.arrays import Array, Flags, Index
from vibeam_models.beams.stretch import Material

FIELDS = {"MeshHex1": "ElementHex2", "MeshHex2": "ElementHex2", "MeshTet1": "ElementTetP2", "MeshTet2": "ElementTetP2"}
ORDER = 5  # of quadrature: exact for the mass of a parallelepiped or a straight tetrahedron; all weights are positive
Pairs = tuple[Index, Index, Index]
CHUNK = 512  # elements at a time: 27 MB of products


@dataclass(frozen=True, eq=False)
class SolidElements:
    """The quadratic field on a ``mesh`` of scikit-fem: MeshHex, MeshHex2, MeshTet or MeshTet2, coordinates in m."""

    mesh: Any

    @cached_property
    def element(self) -> Any:
        """The scalar element, an object of this mesh alone."""
        import skfem

        return getattr(skfem, FIELDS[type(self.mesh).__name__])()

    @cached_property
    def dofs(self) -> Any:
        """Numbers of the nodes of the field by vertex, edge, face and element, as scikit-fem gives them."""
        from skfem.assembly import Dofs

        return Dofs(self.mesh, self.element)

    @cached_property
    def nodes(self) -> Index:
        """Nodes (nodes of an element, elements) of the field."""
        return np.asarray(self.dofs.element_dofs, dtype=np.int64)

    @cached_property
    def points(self) -> Array:
        """Places (3, k) m of the nodes of the field."""
        found = np.empty((3, int(self.nodes.max()) + 1))
        found[:, self.nodes.T] = self.places(self.element.doflocs.T)
        return found

    def among(self, vertices: Index) -> Flags:
        """Test of each node (k,) of the field whether all vertices of its edge, face or element are of ``vertices``."""
        chosen = np.zeros(self.mesh.nvertices, dtype=bool)
        chosen[vertices] = True
        found = np.zeros(self.points.shape[1], dtype=bool)
        parts = (np.arange(len(chosen))[None], self.mesh.edges, self.mesh.facets, self.mesh.t)
        numbers = (self.dofs.nodal_dofs, self.dofs.edge_dofs, self.dofs.facet_dofs, self.dofs.interior_dofs)
        for corners, nodes in zip(parts, numbers, strict=True):
            if nodes.size:  # of tetrahedra neither faces nor elements have nodes of their own
                found[nodes] = chosen[corners].all(axis=0)
        return found

    @property
    def size(self) -> int:
        """Number of components of a displacement, 3 k."""
        return 3 * int(self.points.shape[1])

    def places(self, local: Array, cells: Any = slice(None)) -> Array:
        """Places (3, elements, q) m of ``local`` points (3, q), or (3, elements, q), of the elements ``cells``."""
        values, _ = shape_functions(self.mesh.elem(), local)
        form = "iae,aq->ieq" if local.ndim == 2 else "iae,aeq->ieq"
        return np.asarray(np.einsum(form, self._corners[:, :, cells], values))

    def jacobian(self, local: Array, cells: Any = slice(None)) -> Array:
        """∂x_i/∂ξ_j (elements, q, 3, 3) at ``local`` points, as ``places``."""
        _, slopes = shape_functions(self.mesh.elem(), local)
        form = "iae,jaq->eqij" if local.ndim == 2 else "iae,jaeq->eqij"
        return np.asarray(np.einsum(form, self._corners[:, :, cells], slopes))

    @cached_property
    def _corners(self) -> Array:
        """Places (3, nodes of an element, elements) of the nodes that the mesh itself has."""
        return np.asarray(self.mesh.doflocs[:, self.mesh.dofs.element_dofs])

    @cached_property
    def quadrature(self) -> tuple[Array, Array]:
        """Points (3, q) and weights (q,) of the reference element."""
        from skfem.quadrature import get_quadrature

        points, weights = get_quadrature(self.element.refdom, ORDER)
        return np.asarray(points), np.asarray(weights)

    def volumes(self) -> Array:
        """Volume (elements, q) m³ that each quadrature point stands for."""
        points, weights = self.quadrature
        return np.asarray(np.abs(np.linalg.det(self.jacobian(points))) * weights)

    def stiffness(self, materials: Sequence[Material], material: Index, contraction: bool = True) -> Any:
        """K (3 k, 3 k), sparse, N/m: the ``material`` (elements,) of each element is one of ``materials``.

        ``contraction`` False: σ_ii = E ε_ii, σ_ij = 2G ε_ij with the same E and G, as a beam's theory has it.
        """
        moduli = np.array([_moduli(each, contraction) for each in materials])[material]

        def blocks(cells: Index) -> Iterator[tuple[int, int, Array]]:
            products = self._products(cells)
            along = self._sheared_along(cells, products)
            lame, shear, alone = moduli[cells].T[:, :, None, None]
            for i in range(3):
                others = sum((along if 0 in (i, j) else products)[:, j, :, j] for j in range(3) if j != i)
                yield i, i, (lame + 2 * shear + alone) * products[:, i, :, i] + shear * others
                for j in range(i):
                    block = lame * products[:, i, :, j] + shear * (along if j == 0 else products)[:, j, :, i]
                    yield i, j, block
                    yield j, i, block.swapaxes(1, 2)

        return self._assembled(blocks)

    def mass(self, density: Array) -> Any:
        """M (3 k, 3 k), sparse, kg; ``density`` (elements,) kg/m³."""
        values, _ = shape_functions(self.element, self.quadrature[0])
        shares = self.volumes() * density[:, None]
        return self._alike(lambda cells: np.einsum("aq,eq,bq->eab", values, shares[cells], values, optimize=True))

    def initial_stress(self, stress: Array) -> Any:
        """∫ σ ∂u/∂x · ∂v/∂x (3 k, 3 k), sparse, N/m, of an axial ``stress`` σ (elements, q) Pa, tension positive."""

        def along(cells: Index) -> Array:
            slopes, volumes = self._gradients(cells, self.quadrature)
            weighted = (stress[cells] * volumes)[:, :, None] * slopes[:, :, 0]
            return np.asarray(slopes[:, :, 0].swapaxes(1, 2) @ weighted)

        return self._alike(along)

    def _sheared_along(self, cells: Index, products: Array) -> Array:
        """The products that the shear of x with y and z has."""
        return products

    @cached_property
    def axes(self) -> Index:
        """Local axis (elements,) that lies along x."""
        return np.asarray(np.argmax(np.abs(self.jacobian(np.full((3, 1), 0.5))[:, 0, 0]), axis=1))

    def _gradients(self, cells: Index, rule: tuple[Array, Array]) -> tuple[Array, Array]:
        """∂φ/∂x_i (elements, q, 3, nodes of an element) and dV (elements, q) at the points of a ``rule``."""
        points, weights = rule
        _, slopes = shape_functions(self.element, points)
        jacobian = self.jacobian(points, cells)
        gradients = np.linalg.inv(jacobian).swapaxes(2, 3) @ slopes.transpose(2, 0, 1)
        return gradients, np.abs(np.linalg.det(jacobian)) * weights

    def _products(self, cells: Index) -> Array:
        """∫ ∂φ_a/∂x_i ∂φ_b/∂x_j (elements, 3, a, 3, b)."""
        return products_of(*self._gradients(cells, self.quadrature))

    def _alike(self, matrix: Callable[[Index], Array]) -> Any:
        """The same element ``matrix`` (elements, a, b) for each of the three components, assembled."""
        from scipy.sparse import csr_array, kron

        _, columns, starts = pairs = self._pairs(self.nodes)
        (summed,) = self._summed(pairs, 1, lambda cells: iter([(0, matrix(cells))]))
        return kron(csr_array((summed, columns, starts)), np.eye(3), format="csc")

    def _assembled(self, blocks: Callable[[Index], Iterator[tuple[int, int, Array]]]) -> Any:
        """The sum over all elements of ``blocks``: components i, j and their matrix (elements, a, b)."""
        from scipy.sparse import bsr_array, csc_array

        _, columns, starts = pairs = self._pairs(self.stiff_nodes)
        summed = self._summed(pairs, 9, lambda cells: ((3 * i + j, matrix) for i, j, matrix in blocks(cells)))
        shape = (self.size, self.size)
        rows = bsr_array((summed.reshape(3, 3, -1).transpose(2, 0, 1), columns, starts), shape=shape).tocsr()
        return csc_array((rows.data, rows.indices, rows.indptr), shape=shape)  # symmetric: its rows are its columns

    @property
    def stiff_nodes(self) -> Index:
        """Nodes (a, elements) whose coordinates an element's stiffness is of."""
        return self.nodes

    def _summed(self, pairs: Pairs, count: int, matrices: Callable[[Index], Iterator[tuple[int, Array]]]) -> Array:
        """Sums (count, pairs of nodes) over all elements of numbered ``matrices`` (elements, a, b)."""
        places, columns, _ = pairs
        summed = np.zeros((count, len(columns)))
        for cells in np.array_split(every := np.arange(self.nodes.shape[1]), 1 + len(every) // CHUNK):
            at = places[cells].ravel()
            low, high = int(at.min()), int(at.max()) + 1
            for number, matrix in matrices(cells):
                summed[number, low:high] += np.bincount(at - low, matrix.ravel(), high - low)
        return summed

    def _pairs(self, nodes: Index) -> Pairs:
        """Place (elements, a b) of each pair of ``nodes`` (a, elements); column of each, the first of each row."""
        count, here = self.points.shape[1], nodes.T
        keys, places = np.unique((here[:, :, None] * count + here[:, None, :]).ravel(), return_inverse=True)
        starts = np.searchsorted(keys, count * np.arange(count + 1))
        return places.reshape(len(here), -1), keys % count, starts


def shape_functions(element: Any, local: Array) -> tuple[Array, Array]:
    """Values (functions, …) and derivatives (3, functions, …) of a scalar ``element`` at ``local`` points (3, …)."""
    both = [element.lbasis(local, number) for number in range(len(element.doflocs))]
    shape = local.shape[1:]
    values = np.stack([np.broadcast_to(value, shape) for value, _ in both])
    slopes = np.stack([np.stack([np.broadcast_to(each, shape) for each in slope]) for _, slope in both], axis=1)
    return values, slopes


def products_of(gradients: Array, volumes: Array) -> Array:
    """Products (elements, 3, a, 3, b) of ``gradients`` (elements, q, 3, a), summed over ``volumes`` (elements, q)."""
    count, points, _, nodes = gradients.shape
    flat = np.sqrt(volumes)[:, :, None] * gradients.reshape(count, points, 3 * nodes)
    return np.asarray((flat.swapaxes(1, 2) @ flat).reshape(count, 3, nodes, 3, nodes))  # symmetric to the bit


def _moduli(material: Material, contraction: bool) -> tuple[float, float, float]:
    """λ and G of a material in Pa, and E − 2G without contraction, which stands for λ then.

    ValueError unless −1 < ν < ½, beyond which the energy of a strain is not positive.
    """
    ratio, modulus = material.poissons_ratio, material.youngs_modulus
    if ratio is None or not -1 < ratio < 0.5:
        raise ValueError(f"solid: Poisson's ratio {ratio}, must be known and above -1, below 0.5")
    shear = material.shear_modulus
    return (2 * shear * ratio / (1 - 2 * ratio), shear, 0.0) if contraction else (0.0, shear, modulus - 2 * shear)
