"""Timoshenko elements: linked interpolation, exact in statics, and bubbles that make it of fourth order.

With Φ = 12 EI/(κGA h²) the linked deflection is cubic, the rotation quadratic and the shear strain w′ − θ constant;
Φ → 0 gives Hermite's (Friedman & Kosmatka, Computers & Structures 47 (1993) 473–481, eq. 11–14). Bubbles complete them
to all cubic deflections and quadratic rotations: s(1 − s) and s(1 − s)(2s − 1) of deflection, s(1 − s) of rotation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vibeam_models.arrays import Array
from vibeam_models.beams.beam import Beam
from vibeam_models.beams.stretch import Stretch

Indices = NDArray[np.intp]
BUBBLES = 3  # of each element
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(4)
LOCAL, SHARES = (1 + POINTS) / 2, WEIGHTS / 2  # on an element of length 1


@dataclass(frozen=True, eq=False)
class TimoshenkoElements:
    """Elements between ``nodes`` (k,) m: degrees of freedom: deflection and rotation of each node in
    turn, then the bubbles of each element.

    ``phi`` (k−1,): Φ of each element, of its middle.
    """

    nodes: Array
    phi: Array

    @classmethod
    def of(cls, beam: Beam, nodes: Array) -> TimoshenkoElements:
        """The elements of ``beam``; ValueError where its shear stiffness is not known."""
        middle, steps = (nodes[1:] + nodes[:-1]) / 2, np.diff(nodes)
        bending = beam.along(Stretch.bending_stiffness, middle)
        return cls(nodes, 12 * bending / (beam.along(Stretch.shear_stiffness, middle) * steps**2))

    @property
    def count(self) -> int:
        """Number of degrees of freedom."""
        return 2 * len(self.nodes) + BUBBLES * len(self.phi)

    @property
    def quadrature(self) -> Array:
        """Gauss points (k−1, 4) m."""
        return np.asarray(self.nodes[:-1, None] + np.diff(self.nodes)[:, None] * LOCAL)

    def inner(self, cells: Indices) -> Indices:
        """Degrees of freedom inside these elements, (3 · cells,): their bubbles."""
        return np.asarray((2 * len(self.nodes) + BUBBLES * cells[:, None] + np.arange(BUBBLES)).ravel())

    def matrices(self, beam: Beam) -> tuple[Array, Array]:
        """∫ρA w² + ρI θ² and ∫EI θ′² + κGA (w′ − θ)², (count, count) each."""
        at = self.quadrature
        deflection, rotation, curvature, strain = self._shapes(np.broadcast_to(LOCAL, at.shape), slice(None))
        mass, inertia = beam.along(Stretch.mass_per_length, at), beam.along(Stretch.rotary_inertia, at)
        bending, shear = beam.along(Stretch.bending_stiffness, at), beam.along(Stretch.shear_stiffness, at)
        stiffness = self._summed((bending, curvature), (shear, strain))
        return self._summed((mass, deflection), (inertia, rotation)), stiffness

    def rows(self, x: Array, derivative: int) -> Array:
        """Rows (m, count) that read the deflection (0), rotation (1) or its derivative (2) at ``x`` (m,) m."""
        cells = np.clip(np.searchsorted(self.nodes, x, side="right") - 1, 0, len(self.nodes) - 2)
        local = (x - self.nodes[cells]) / (self.nodes[cells + 1] - self.nodes[cells])
        rows = np.zeros((len(x), self.count))
        rows[np.arange(len(x))[:, None], self._dofs(cells)] = self._shapes(local[:, None], cells)[derivative][:, :, 0].T
        return rows

    def _shapes(self, s: Array, cells: Indices | slice) -> tuple[Array, Array, Array, Array]:
        """Deflection, rotation, its derivative and shear strain (7, elements, points) at ``s`` in 0 … 1."""
        h, phi = np.diff(self.nodes)[cells][:, None], self.phi[cells][:, None]
        over, none = 1 / (1 + phi), np.zeros_like(s)
        deflection = [
            over * (2 * s**3 - 3 * s**2 + 1 + phi * (1 - s)),
            over * h * (s**3 - (2 + phi / 2) * s**2 + (1 + phi / 2) * s),
            over * (-2 * s**3 + 3 * s**2 + phi * s),
            over * h * (s**3 - (1 - phi / 2) * s**2 - phi / 2 * s),
        ]
        turn = 6 * over / h * (s**2 - s)
        rotation = [turn, over * (3 * s**2 - (4 + phi) * s + 1 + phi), -turn, over * (3 * s**2 - (2 - phi) * s)]
        bend = 6 * over / h**2 * (2 * s - 1)
        curvature = [bend, over / h * (6 * s - 4 - phi), -bend, over / h * (6 * s - 2 + phi)]
        strain = [-phi * over / h + none, -phi * over / 2 + none, phi * over / h + none, -phi * over / 2 + none]
        bubble, slope, odd = s * (1 - s), (1 - 2 * s) / h, s * (1 - s) * (2 * s - 1)
        deflection += [bubble, odd, none]
        rotation += [none, none, bubble]
        curvature += [none, none, slope]
        strain += [slope, (-6 * s**2 + 6 * s - 1) / h, -bubble]
        return np.stack(deflection), np.stack(rotation), np.stack(curvature), np.stack(strain)

    def _dofs(self, cells: Indices) -> Indices:
        """Degrees of freedom (cells, 7) of elements: both nodes', then the bubbles."""
        return np.hstack([2 * cells[:, None] + np.arange(4), self.inner(cells).reshape(-1, BUBBLES)])

    def _summed(self, *parts: tuple[Array, Array]) -> Array:
        """Sum of the elements' matrices ∫ c N Nᵀ over ``parts`` (c, N), symmetric to the bit."""
        steps = np.diff(self.nodes)[:, None] * SHARES
        entries = sum(np.einsum("ep,iep,jep->eij", value * steps, shape, shape) for value, shape in parts)
        whole, dofs = np.zeros((self.count, self.count)), self._dofs(np.arange(len(steps)))
        np.add.at(whole, (dofs[:, :, None], dofs[:, None, :]), entries)
        return np.asarray((whole + whole.T) / 2)
