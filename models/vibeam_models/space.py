"""BeamSpace: Hermite finite elements on one mesh, with what its constraints have left free.

scikit-fem is imported where a beam is assembled: commands that only read a case do without it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

NEAR = 0.25  # share of a uniform element within which a uniform node gives way to an inserted one

SAME = 1e-9  # share of the length within which two inserted nodes are one


def nodes(length: float, elements: int, inserted: Iterable[float] = ()) -> NDArray[np.float64]:
    """Ascending node positions (k,) in m: ``elements`` uniform ones on [0, length] and every ``inserted`` one.

    A uniform node nearer than a quarter element to an inserted one is left out, so that no element is needlessly
    short; both ends stay. ValueError for ``elements`` < 1 or an inserted node outside [0, length].
    """
    if elements < 1:
        raise ValueError(f"elements: {elements}, a mesh needs at least 1")
    kept = [0.0, length]
    for position in inserted:
        if not 0 <= position <= length:
            raise ValueError(f"no node can stand at {position} m: the beam ends at {length} m")
        if _distance(position, kept) > SAME * length:
            kept.append(float(position))
    uniform = np.linspace(0.0, length, elements + 1)[1:-1]
    kept += [float(x) for x in uniform if _distance(x, kept) > NEAR * length / elements]
    return np.array(sorted(kept))


def _distance(position: float, others: list[float]) -> float:
    return float(np.min(np.abs(np.array(others) - position)))


Array = NDArray[np.float64]


@dataclass(frozen=True)
class BeamSpace:
    """Cubic Hermite elements: deflection and slope at each node, and the constraints upon them.

    ``basis``: the scikit-fem basis; ``constraint`` (dofs, size): dofs = constraint @ x, x the free coordinates.
    """

    basis: Any
    constraint: Array

    @classmethod
    def clamped(cls, nodes: ArrayLike) -> BeamSpace:
        """The space on ``nodes`` (k,) in m, ascending, clamped at the first one: 2(k−1) coordinates."""
        from skfem import Basis, ElementLineHermite, MeshLine

        element = ElementLineHermite()  # a new one for every mesh: it remembers the first mesh it met
        basis = Basis(MeshLine(np.asarray(nodes, dtype=float)), element, intorder=6)
        return cls(basis, np.eye(int(basis.N))[:, 2:])

    @property
    def nodes(self) -> Array:
        """Node positions (k,) in m."""
        return np.asarray(self.basis.mesh.p[0], dtype=float)

    @property
    def size(self) -> int:
        """Number of free coordinates."""
        return int(self.constraint.shape[1])

    @property
    def free(self) -> NDArray[np.intp]:
        """The degrees of freedom, ascending, that any coordinate moves."""
        return np.flatnonzero(np.any(self.constraint, axis=1))

    @property
    def is_plain(self) -> bool:
        """True where every coordinate is one degree of freedom, in their order."""
        free = self.free
        if not len(free) == self.size == np.count_nonzero(self.constraint):
            return False
        return bool(np.all(self.constraint[free, np.arange(self.size)] == 1))

    def widened(self, count: int) -> BeamSpace:
        """The same space with ``count`` further coordinates that bend nothing."""
        return self.constrained(np.eye(self.size, self.size + count))

    def constrained(self, further: Array) -> BeamSpace:
        """The same space with x = further @ y: ``further`` (size, fewer)."""
        return replace(self, constraint=self.constraint @ further)

    def mass(self, per_length: float) -> Array:
        """Consistent mass ∫ρA uv (dofs, dofs) of all degrees of freedom, the clamp's too; ``per_length`` in kg/m."""
        return self._assembled(lambda u, v, _: per_length * u * v)

    def stiffness(self, bending: float) -> Array:
        """∫EI u″v″ (dofs, dofs) of all degrees of freedom, the clamp's too; ``bending`` in N m²."""
        from skfem.helpers import dd

        return self._assembled(lambda u, v, _: bending * dd(u)[0, 0] * dd(v)[0, 0])

    def translation(self) -> Array:
        """Unit translation (dofs,) of every degree of freedom, the clamp's too: deflections 1, slopes 0."""
        unit = np.zeros(int(self.basis.N))
        unit[self.basis.nodal_dofs[0]] = 1.0
        return unit

    def row(self, x: float, derivative: int = 0) -> Array:
        """Row (size,) that reads the deflection (``derivative=0``, m) or slope (1, rad) at ``x`` m, node or not."""
        return np.asarray(self.rows([x], derivative)[0])

    def rows(self, positions: ArrayLike, derivative: int = 0) -> Array:
        """``row`` of many positions (k,) at once: (k, size). ValueError for a position off the beam."""
        x = np.atleast_1d(np.asarray(positions, dtype=float))
        end = self.nodes[-1]
        if np.any((x < 0) | (x > end)):
            raise ValueError(f"positions must lie in [0, {end}] m: {x[(x < 0) | (x > end)]}")
        if derivative not in (0, 1):
            raise ValueError(f"derivative: {derivative}, Hermite elements offer 0 and 1")
        cells = np.clip(np.searchsorted(self.nodes, x, side="right") - 1, 0, len(self.nodes) - 2)
        rows = np.zeros((len(x), int(self.basis.N)))
        for k in range(4):
            rows[np.arange(len(x)), self.basis.element_dofs[k, cells]] = self._shape(k, x, cells, derivative)
        return rows @ self.constraint

    def _shape(self, k: int, x: Array, cells: NDArray[np.intp], derivative: int) -> Array:
        mapping = self.basis.mapping
        local = mapping.invF(x[np.newaxis, :, np.newaxis], tind=cells)
        field = self.basis.elem.gbasis(mapping, local, k, tind=cells)[0]
        return np.asarray(field.grad[0] if derivative else field)[:, 0]

    def _assembled(self, form: Any) -> Array:
        from skfem import BilinearForm

        matrix: Array = BilinearForm(form).assemble(self.basis).toarray()
        return (matrix + matrix.T) / 2
