"""Finite elements of a beam by scikit-fem: its mesh, basis, degrees of freedom, quadrature and interpolation.

What a mesh alone decides, the basis with its shape functions at the Gauss points, is computed once, and kept for the
next beam on the same mesh. scikit-fem is imported where the first beam is built.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibeam_models.arrays import Array
from vibeam_models.beams.beam import Beam
from vibeam_models.beams.stretch import Stretch

Indices = NDArray[np.intp]
KEPT = 32  # meshes
ORDER = 6  # of the polynomials that quadrature integrates exactly: a mass matrix of cubics


@dataclass(frozen=True, eq=False)
class BeamElements(ABC):
    """Elements between ``nodes`` (k,) m, by a ``basis`` of scikit-fem.

    Degrees of freedom (count,): deflection and slope of each node in turn, then those inside the elements.
    """

    nodes: Array
    basis: Any

    @abstractmethod
    def matrices(self, beam: Beam) -> tuple[Array, Array]:
        """Mass and stiffness (count, count) of ``beam``."""

    @staticmethod
    @abstractmethod
    def derivatives(*fields: Any) -> tuple[Array, Array, Array]:
        """Deflection, slope and curvature of a shape function, from its ``fields`` in scikit-fem's basis."""

    @property
    def count(self) -> int:
        """Number of degrees of freedom."""
        return int(self.basis.N)

    @property
    def quadrature(self) -> Array:
        """Gauss points (k−1, 4) m."""
        return np.asarray(self.basis.mapping.F(self.basis.X)[0])

    def inner(self, cells: Indices) -> Indices:
        """Degrees of freedom inside these elements."""
        return np.asarray(self.basis.interior_dofs[:, cells].ravel(order="F"), dtype=np.intp)

    def rows(self, x: Array, derivative: int) -> Array:
        """Rows (m, count) that read the deflection (0), slope (1) or curvature (2) at ``x`` (m,) m, on the beam.

        As ``Basis.probes`` of scikit-fem, which reads no derivatives.
        """
        basis = self.basis
        cells = basis.mesh.element_finder(mapping=basis.mapping)(x)
        local = basis.mapping.invF(x[None, :, None], tind=cells)
        shapes = [basis.elem.gbasis(basis.mapping, local, i, tind=cells) for i in range(basis.Nbfun)]
        rows = np.zeros((len(x), self.count))
        values = np.stack([self.derivatives(*fields)[derivative][:, 0] for fields in shapes], axis=1)
        rows[np.arange(len(x))[:, None], basis.element_dofs[:, cells].T] = values
        return rows


class HermiteElements(BeamElements):
    """Cubic Hermite elements of Euler and Bernoulli's beam."""

    def matrices(self, beam: Beam) -> tuple[Array, Array]:
        """As ``BeamElements.matrices``."""
        if beam.is_uniform:
            return self.mass(beam.mass_per_length), self.stiffness(beam.bending_stiffness)
        at = self.quadrature
        mass, bending = beam.along(Stretch.mass_per_length, at), beam.along(Stretch.bending_stiffness, at)
        return self.mass(mass), self.stiffness(bending)

    def mass(self, per_length: ArrayLike) -> Array:
        """Consistent mass ∫ρA uv (count, count); ``per_length`` in kg/m, one number or one a Gauss point."""
        return assembled(self.basis, lambda u, v, at: at.mass * u * v, mass=per_length)

    def stiffness(self, bending: ArrayLike) -> Array:
        """∫EI u″v″ (count, count); ``bending`` in N m², one number or one a Gauss point."""
        return assembled(self.basis, lambda u, v, at: at.bending * u.hess[0, 0] * v.hess[0, 0], bending=bending)

    @staticmethod
    def derivatives(*fields: Any) -> tuple[Array, Array, Array]:
        """As ``BeamElements.derivatives``."""
        (deflection,) = fields
        return np.asarray(deflection), deflection.grad[0], deflection.hess[0, 0]


def hermite_elements(nodes: ArrayLike) -> HermiteElements:
    """Elements between ascending ``nodes`` (k,) m."""
    return _on_mesh(_content(nodes))


@lru_cache(maxsize=KEPT)
def _on_mesh(mesh: bytes) -> HermiteElements:
    return HermiteElements(np.frombuffer(mesh), _basis(mesh, "ElementLineHermite", ORDER))


def basis_of(nodes: ArrayLike, element: str, order: int) -> Any:
    """scikit-fem's basis on ascending ``nodes`` (k,) m of its ``element``; quadrature exact to that ``order``."""
    return _basis(_content(nodes), element, order)


@lru_cache(maxsize=KEPT)
def _basis(mesh: bytes, element: str, order: int) -> Any:
    import skfem

    return skfem.Basis(skfem.MeshLine(np.frombuffer(mesh)), getattr(skfem, element)(), intorder=order)


def _content(nodes: ArrayLike) -> bytes:
    return np.ascontiguousarray(nodes, dtype=float).tobytes()


def assembled(basis: Any, form: Callable[..., Any], **coefficients: ArrayLike) -> Array:
    """Matrix (N, N) of a symmetric bilinear ``form`` on a basis of scikit-fem, symmetric to the bit.

    ``coefficients``: attributes of the form's last argument, each one number or one a Gauss point.
    """
    from skfem import BilinearForm

    given = {name: np.broadcast_to(np.asarray(value, float), basis.dx.shape) for name, value in coefficients.items()}
    whole = BilinearForm(form).assemble(basis, **given).toarray()
    return np.asarray((whole + whole.T) / 2)
