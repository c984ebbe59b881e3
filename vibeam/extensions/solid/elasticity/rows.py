"""Rows that read a displacement of a solid: its mean over a patch, at a point, over the section at a place."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np

from vibeam.extensions.solid.elasticity.body import SolidBody
from vibeam.extensions.solid.elasticity.elasticity import SolidElements, shape_functions
from vibeam_models.arrays import Array, Flags, Index

X, Y, Z = range(3)  # components of a displacement
NEAR = 1e-9  # share of the body's length within which two places are one
INSIDE = 1e-6  # share of an element by which a point may lie outside of it and still be of it
STEPS = 20  # of Newton's method for the local place of a point
SETTLED = 1e-13  # change of the local place at which it ends
FACET_SETTLED = 1e-9  # the same on facets: of an element 1e-5 as long as the body, 1e-11 of it is round-off
PATCH_ORDER = 4  # of the quadrature over a patch
GAUSS = np.polynomial.legendre.leggauss(3)


@dataclass(frozen=True, eq=False)
class SolidRows:
    """Rows (3 k,) on the displacements of the ``elements`` of a ``body``."""

    body: SolidBody
    elements: SolidElements

    def patch(self, name: str) -> Array:
        """Mean of u_z over the facets of a patch, by their area as seen along z: 1 as the body rises by 1."""
        nodes, values, areas, normals = self._on_facets(self.body.patches[name])
        seen = areas * np.abs(normals[Z])
        return self._row(Z, nodes, np.einsum("aeq,eq->ae", values, seen) / seen.sum())

    def facets(self, facets: Index, component: int) -> Array:
        """Mean of a component over ``facets`` (m,) of the mesh, by area."""
        nodes, values, areas, _ = self._on_facets(facets)
        return self._row(component, nodes, np.einsum("aeq,eq->ae", values, areas) / areas.sum())

    def vertices(self, vertices: Index, component: int) -> Array:
        """Mean of a component over ``vertices`` (m,) of the mesh."""
        at = self.elements.dofs.nodal_dofs[0, vertices]
        return self._row(component, at, np.full(len(at), 1 / len(at)))

    def bed(self, facets: Index, component: int) -> Any:
        """∫ u v dA over ``facets`` of one component (3 k, 3 k), sparse, m²."""
        from scipy.sparse import csc_array

        nodes, values, areas, _ = self._on_facets(facets)
        shares = np.einsum("aeq,beq,eq->abe", values, values, areas, optimize=True)
        rows, columns = np.broadcast_arrays(nodes[:, None], nodes[None])
        places = 3 * rows.ravel() + component, 3 * columns.ravel() + component
        return csc_array((shares.ravel(), places), shape=(self.elements.size,) * 2)

    def point(self, place: Array, component: int = Z) -> Array:
        """A component at ``place`` (3,) m, by the shape functions of the element; ValueError where there is none."""
        cells, local = self._located(place)
        values, _ = shape_functions(self.elements.element, local[:, None])
        return self._row(component, self.elements.nodes[:, cells], values[:, 0])

    def section(self, x: float) -> Array:
        """Motions (6, 3 k) of the beam's section at ``x`` m as a whole, in the order of ``RigidPart.motions``.

        Mean displacements along x and z, slope −∫z u_x/∫z², mean along y, turn −∫y u_x/∫y² about z, twist
        ∫(y u_z − z u_y)/∫(y² + z²): by least squares, of the elements before the section where two meet.
        """
        places, nodes, values, area = self._slab(x)
        mean = area / area.sum()
        y, z = places[Y], places[Z] - (places[Z] * mean).sum()
        yy, zz = (y**2 * area).sum(), (z**2 * area).sum()

        def row(weight: Array, component: int) -> Array:
            return self._row(component, nodes, np.einsum("aeq,eq->ae", values, weight))

        twist = row(y * area / (yy + zz), Z) - row(z * area / (yy + zz), Y)
        slope, turn = -row(z * area / zz, X), -row(y * area / yy, X)
        return np.stack([row(mean, X), row(mean, Z), slope, row(mean, Y), turn, twist])

    def _row(self, component: int, nodes: Index, weights: Array) -> Array:
        found = np.zeros(self.elements.size)
        count = self.elements.size // 3
        found[component::3] = np.bincount(nodes.ravel(), weights.ravel(), count)
        return found

    def _on_facets(self, facets: Index) -> tuple[Index, Array, Array, Array]:
        """Nodes (a, m), shape functions (a, m, q), areas (m, q) m² and normals (3, m, q) of ``facets`` (m,)."""
        from skfem import FacetBasis
        from skfem.mapping import MappingIsoparametric

        mesh, element = self.elements.mesh, type(self.elements.element)()
        mapping: Any = copy(mesh._mapping())
        if isinstance(mapping, MappingIsoparametric):
            mapping.invF = partial(mapping.invF, newton_tol=FACET_SETTLED)
        facets = np.asarray(facets, dtype=np.int32)
        basis = FacetBasis(mesh, element, mapping, facets=facets, intorder=PATCH_ORDER)
        values = np.stack([np.asarray(each[0]) for each in basis.basis])
        return basis.element_dofs.astype(np.int64), values, np.asarray(basis.dx), np.asarray(basis.normals)

    @cached_property
    def _ranges(self) -> tuple[Array, Array]:
        """Least and largest x (elements,) of each element; of one that is not the beam's NaN."""
        x = self.elements.mesh.p[0][self.elements.mesh.t]
        beam = np.ones(x.shape[1], dtype=bool) if self.body.beam is None else self.body.beam
        return np.where(beam, x.min(axis=0), np.nan), np.where(beam, x.max(axis=0), np.nan)

    @cached_property
    def areas(self) -> Array:
        """Area (elements,) m² of the section through each element, plates and blocks among it: volume over length."""
        x = self.elements.mesh.p[0][self.elements.mesh.t]
        low, length = x.min(axis=0), np.ptp(x, axis=0)
        _, slab = np.unique(np.round(low / (NEAR * np.ptp(x))), return_inverse=True)
        return np.asarray(np.bincount(slab, self.elements.volumes().sum(axis=1) / length)[slab])

    @cached_property
    def _forward(self) -> Flags:
        """Test of each element whether x grows along its local axis that lies along x."""
        slopes = self.elements.jacobian(np.full((3, 1), 0.5))[:, 0, X]
        return np.asarray(slopes[np.arange(len(slopes)), self.elements.axes] > 0)

    def _slab(self, x: float) -> tuple[Array, Index, Array, Array]:
        """Quadrature points (3, e, q) of the section at x, nodes, shape functions and areas of the elements it cuts."""
        low, high = self._ranges
        near = NEAR * float(np.nanmax(high) - np.nanmin(low))
        cut = (low < x - near) & (x <= high + near)
        cells = np.flatnonzero(cut if cut.any() else (low <= x + near) & (x < high))
        share = (x - low[cells]) / (high[cells] - low[cells])
        axes = self.elements.axes[cells]
        local, weights = _across(axes, np.where(self._forward[cells], share, 1 - share))
        jacobian = self.elements.jacobian(local, cells)
        first, second = ((axes + step) % 3 for step in (1, 2))
        each = np.arange(len(cells))
        a, b = (jacobian[each, :, 1:, :][each, :, :, axis] for axis in (first, second))
        area = np.abs(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]) * weights
        values, _ = shape_functions(self.elements.element, local)
        return self.elements.places(local, cells), self.elements.nodes[:, cells], values, area

    def _located(self, place: Array) -> tuple[int, Array]:
        """Element that a ``place`` (3,) m lies in, and its local place (3,)."""
        corners = self.elements.mesh.p[:, self.elements.mesh.t]
        low, high = corners.min(axis=1), corners.max(axis=1)
        margin = 0.1 * (high - low)
        near = np.all((place[:, None] >= low - margin) & (place[:, None] <= high + margin), axis=0)
        cells = np.flatnonzero(near)
        local = np.full((3, len(cells), 1), 0.5)
        for _ in range(STEPS if len(cells) else 0):
            missed = place[:, None, None] - self.elements.places(local, cells)
            step = np.linalg.solve(self.elements.jacobian(local, cells)[:, 0], missed[:, :, 0].T[:, :, None])[:, :, 0]
            local = np.clip(local + step.T[:, :, None], -1.0, 2.0)
            if np.abs(step).max() < SETTLED:
                break
        outside = np.maximum(-local, local - 1).max(axis=(0, 2))
        if not len(cells) or outside.min() > INSIDE:
            raise ValueError(f"solid: no element at ({', '.join(f'{each:g}' for each in place)}) m")
        best = int(np.argmin(outside))
        return int(cells[best]), np.clip(local[:, best, 0], 0.0, 1.0)


def _across(axes: Index, share: Array) -> tuple[Array, Array]:
    """Local points (3, elements, 9) across an element at ``share`` of its local axis, and their weights (9,)."""
    points, weights = (GAUSS[0] + 1) / 2, GAUSS[1] / 2
    first, second = (each.ravel() for each in np.meshgrid(points, points, indexing="ij"))
    local = np.empty((3, len(axes), len(first)))
    each = np.arange(len(axes))
    local[axes, each] = share[:, None]
    local[(axes + 1) % 3, each] = first
    local[(axes + 2) % 3, each] = second
    return local, np.outer(weights, weights).ravel()
