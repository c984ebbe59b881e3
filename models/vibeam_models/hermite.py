"""Cubic Hermite elements on one mesh: shape functions, and mass and stiffness matrices of any section of each element.

What a mesh alone decides is computed once, and kept for the next beam on the same mesh. In a shape function the four
coefficients are those of 1, x, x², x³, x from the clamp.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibeam_models.arrays import Array
from vibeam_models.beams.beam import Beam
from vibeam_models.beams.stretch import Stretch

Indices = NDArray[np.intp]
KEPT = 32  # meshes
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(4)  # exact to degree 7, a mass matrix has 6
PLACES, SHARES = 0.5 * POINTS + 0.5, WEIGHTS / 2  # on an element of length 1
FACTORS = ((1, 1, 1, 1), (0, 1, 2, 3), (0, 0, 2, 6))  # of 1, x, x², x³ in the derivatives 0, 1, 2


@dataclass(frozen=True, eq=False)
class HermiteElements:
    """Elements between ``nodes`` (k,) m, degrees of freedom (2k): deflection and slope of each node in turn.

    ``coefficients`` (k−1, 4, 4): of power p in the function of degree of freedom i of an element. ``values``,
    ``curvatures``: the functions (4, k−1, 4) and their second derivatives at the Gauss points, ``steps`` (k−1, 4) the
    weights there; ``places`` (4, 4, k−1): where an element's entries stand in the flattened matrix.
    """

    nodes: Array
    coefficients: Array
    values: Array
    curvatures: Array
    steps: Array
    places: Indices

    @property
    def count(self) -> int:
        """Number of degrees of freedom."""
        return 2 * len(self.nodes)

    def matrices(self, beam: Beam) -> tuple[Array, Array]:
        """Mass and stiffness (count, count) of ``beam``."""
        if beam.is_uniform:
            return self.mass(beam.mass_per_length), self.stiffness(beam.bending_stiffness)
        at = self.quadrature
        mass, bending = beam.along(Stretch.mass_per_length, at), beam.along(Stretch.bending_stiffness, at)
        return self.mass(mass), self.stiffness(bending)

    def inner(self, cells: Indices) -> Indices:
        """Degrees of freedom inside these elements: none."""
        return np.zeros(0, dtype=np.intp)

    @property
    def quadrature(self) -> Array:
        """Gauss points (k−1, 4) m."""
        return _within(self.nodes[:-1], self.nodes[1:], PLACES)

    def mass(self, per_length: ArrayLike) -> Array:
        """Consistent mass ∫ρA uv (count, count); ``per_length`` in kg/m, one number or one a Gauss point."""
        return self._assembled(per_length, self.values)

    def stiffness(self, bending: ArrayLike) -> Array:
        """∫EI u″v″ (count, count); ``bending`` in N m², one number or one a Gauss point."""
        return self._assembled(bending, self.curvatures)

    def rows(self, x: Array, derivative: int) -> Array:
        """Rows (m, count) that read the deflection (0), slope (1) or curvature (2) at ``x`` (m,) m, on the beam."""
        cells = np.searchsorted(self.nodes[1:-1], x, side="right")
        local = (x - self.nodes[cells]) * (1.0 / (self.nodes[cells + 1] - self.nodes[cells]))
        rows = np.zeros((len(x), self.count))
        columns = 2 * cells[:, None] + np.arange(4)
        within = _within(self.nodes[cells], self.nodes[cells + 1], local[:, None])
        rows[np.arange(len(x))[:, None], columns] = _shapes(self.coefficients[cells], within, derivative)[:, :, 0].T
        return rows

    def _assembled(self, section: ArrayLike, functions: Array) -> Array:
        """Sum of the elements' matrices, symmetric to the bit."""
        own = np.asarray(section, dtype=float) * functions
        entries = np.sum(own[:, None] * functions[None, :] * self.steps, axis=-1)
        whole = np.bincount(self.places.ravel(), entries.ravel(), self.count**2).reshape(self.count, self.count)
        return np.asarray((whole + whole.T) / 2)


def hermite_elements(nodes: ArrayLike) -> HermiteElements:
    """Elements between ascending ``nodes`` (k,) m."""
    return _on_mesh(np.ascontiguousarray(nodes, dtype=float).tobytes())


@lru_cache(maxsize=KEPT)
def _on_mesh(content: bytes) -> HermiteElements:
    nodes = np.frombuffer(content)
    start, end = nodes[:-1], nodes[1:]
    ends = [_powers(x, derivative) for x in (start, end) for derivative in (0, 1)]  # what its four freedoms read
    coefficients = np.linalg.inv(np.stack(ends, axis=1))
    within = _within(start, end, PLACES)
    dofs = 2 * np.arange(len(start)) + np.arange(4)[:, None]
    return HermiteElements(
        nodes,
        coefficients,
        _shapes(coefficients, within, 0),
        _shapes(coefficients, within, 2),
        (end - start)[:, None] * SHARES,
        dofs[None, :, :] * (2 * len(nodes)) + dofs[:, None, :],
    )


def _within(start: Array, end: Array, local: Array) -> Array:
    """Positions (elements, points) m of ``local`` ones, 0 at an element's start and 1 at its end."""
    return np.asarray((end - start)[:, None] * local + start[:, None])


def _powers(x: Array, derivative: int) -> Array:
    """Derivative of 1, x, x², x³ at ``x`` (elements,): (elements, 4)."""
    return np.stack([FACTORS[derivative][p] * x ** max(p - derivative, 0) for p in range(4)], axis=1)


def _shapes(coefficients: Array, x: Array, derivative: int) -> Array:
    """Derivative of the four shape functions at ``x`` (elements, points): (4, elements, points)."""
    found = np.zeros((4, *x.shape))
    for p in range(derivative, 4):
        found += coefficients[:, p].T[:, :, None] * (FACTORS[derivative][p] * x ** (p - derivative))
    return found
