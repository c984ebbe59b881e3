"""Slender solids: quadratic hexahedra that neither lock in bending nor lose it to round-off.

A quadratic deflection of a thin element bends it without shear at two points along it alone; at three a false shear
stiffens it, and frequencies converge with the square of its length in place of the fourth power. So the shear of x
with y and z is taken at two (O. C. Zienkiewicz, R. L. Taylor & J. M. Too, Int. J. Numer. Methods Eng. 3, 1971).

A strip's bending stiffness is less than that through its thickness by (t/L)⁴, which leaves nothing of it where the same
coordinates hold both. So all nodes of a plane across the beam are counted from one of them (E. L. Wilson, in SMiA 1974:
thick shells by relative displacements): u = T v, and the plane's own coordinates meet no stiffness across it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from vibeam.extensions.solid.elasticity.elasticity import SolidElements, products_of
from vibeam_models.arrays import Array, Index

NEAR = 1e-9  # share of the body's length within which nodes are in one plane
PLANES = np.array([0.0, 0.5, 1.0])  # of an element's nodes, along its local axis


@dataclass(frozen=True, eq=False)
class SlenderElements(SolidElements):
    """Hexahedra whose nodes lie in planes across x; the stiffness is of the coordinates v of u = ``relative`` v."""

    @cached_property
    def bases(self) -> Index:
        """Node (k,) that each node is counted from: of its plane the nearest to the axis, first of all to y = 0."""
        x, y, z = self.points
        near = NEAR * float(np.ptp(x))
        along = np.argsort(x)
        plane = np.empty(len(x), dtype=np.int64)
        plane[along] = np.cumsum(np.diff(x[along], prepend=x[along[0]]) > near)
        nearest = np.lexsort((np.abs(z), np.round(np.abs(y) / near), plane))
        _, first = np.unique(plane[nearest], return_index=True)
        return np.asarray(nearest[first][plane])

    @cached_property
    def relative(self) -> Any:
        """T (3 k, 3 k), sparse: a node moves as its base and by its own coordinates."""
        from scipy.sparse import csr_array, eye_array, kron

        away = np.flatnonzero(self.bases != np.arange(len(self.bases)))
        moved = csr_array((np.ones(len(away)), (away, self.bases[away])), shape=(len(self.bases),) * 2)
        return kron(eye_array(len(self.bases)) + moved, np.eye(3), format="csc")

    @cached_property
    def stiff_nodes(self) -> Index:
        """As ``SolidElements.stiff_nodes``: those of an element, and the bases of its three planes."""
        ends = np.stack([np.flatnonzero(self._planes(axis)[:, which])[0] for axis in range(3) for which in range(3)])
        chosen = ends.reshape(3, 3)[self.axes].T
        return np.concatenate([self.nodes, self.bases[np.take_along_axis(self.nodes, chosen, axis=0)]])

    def _planes(self, axis: int) -> Array:
        """Share (nodes of an element, 3) of each node in the three planes across a local ``axis``."""
        return np.asarray(self.element.doflocs[:, axis, None] == PLANES, dtype=float)

    def _products(self, cells: Index) -> Array:
        return self._by_axis(cells, 3)

    def _sheared_along(self, cells: Index, products: Array) -> Array:
        return self._by_axis(cells, 2)

    def _by_axis(self, cells: Index, points: int) -> Array:
        """Products with so many Gauss points along the local axis that lies along x."""
        axes, count = self.axes[cells], len(self.stiff_nodes)
        found = np.empty((len(cells), 3, count, 3, count))
        for axis in np.unique(axes):
            here = axes == axis
            gradients, volumes = self._gradients(cells[here], _rule(int(axis), points))
            own = self.nodes[:, cells[here]]
            counted = np.where(self.bases[own] == own, 0.0, 1.0).T
            whole = gradients @ self._planes(int(axis)) * np.array([1.0, 0.0, 0.0])[:, None]  # of x alone
            together = np.concatenate([gradients * counted[:, None, None], whole], axis=3)
            found[here] = products_of(together, volumes)
        return found


def _rule(axis: int, count: int) -> tuple[Array, Array]:
    """Gauss' points (3, q) and weights (q,) of the reference hexahedron, ``count`` along a local axis, three across."""
    rules = [np.polynomial.legendre.leggauss(count if each == axis else 3) for each in range(3)]
    points = np.meshgrid(*((1 + at) / 2 for at, _ in rules), indexing="ij")
    weights = np.einsum("a,b,c->abc", *(weight / 2 for _, weight in rules))
    return np.stack([each.ravel() for each in points]), weights.ravel()
