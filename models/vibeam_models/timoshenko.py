"""Timoshenko elements: linked interpolation, exact in statics, and bubbles that make it of fourth order.

scikit-fem has no such element; it has all else of it: mesh, degrees of freedom, quadrature, assembly, interpolation.
With Φ = 12 EI/(κGA h²) the linked deflection is cubic, the rotation quadratic and the shear strain w′ − θ constant;
Φ → 0 gives Hermite's (Friedman & Kosmatka, Computers & Structures 47 (1993) 473–481, eq. 11–14). Bubbles complete them
to all cubic deflections and quadratic rotations: s(1 − s) and s(1 − s)(2s − 1) of deflection, s(1 − s) of rotation.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from skfem import Basis
from skfem.element import DiscreteField, Element
from skfem.refdom import RefLine

from vibeam_models.arrays import Array
from vibeam_models.beams.beam import Beam
from vibeam_models.beams.stretch import Stretch
from vibeam_models.elements import BeamElements, assembled, hermite_elements


@dataclass(frozen=True, eq=False)
class TimoshenkoElements(BeamElements):
    """Elements of Timoshenko's beam; the slope of a node is the section's rotation."""

    @classmethod
    def of(cls, beam: Beam, nodes: Array) -> TimoshenkoElements:
        """The elements of ``beam``; ValueError where its shear stiffness is not known."""
        middle, steps = (nodes[1:] + nodes[:-1]) / 2, np.diff(nodes)
        bending = beam.along(Stretch.bending_stiffness, middle)
        phi = 12 * bending / (beam.along(Stretch.shear_stiffness, middle) * steps**2)
        plain = hermite_elements(nodes).basis
        return cls(nodes, Basis(plain.mesh, LinkedElement(phi, steps), plain.mapping, quadrature=plain.quadrature))

    def matrices(self, beam: Beam) -> tuple[Array, Array]:
        """∫ρA w² + ρI θ² and ∫EI θ′² + κGA (w′ − θ)², (count, count) each."""
        sections = (Stretch.mass_per_length, Stretch.rotary_inertia, Stretch.bending_stiffness, Stretch.shear_stiffness)
        mass, inertia, bending, shear = (beam.along(each, self.quadrature) for each in sections)
        inertial = assembled(self.basis, _inertial, mass=mass, inertia=inertia)
        return inertial, assembled(self.basis, _elastic, bending=bending, shear=shear)

    @staticmethod
    def derivatives(*fields: Any) -> tuple[Array, Array, Array]:
        """As ``BeamElements.derivatives``: deflection, rotation and its derivative."""
        deflection, rotation, _ = fields
        return np.asarray(deflection), np.asarray(rotation), rotation.grad[0]


def _inertial(w: Any, turn: Any, _: Any, v: Any, test: Any, __: Any, at: Any) -> Any:
    return at.mass * w * v + at.inertia * turn * test


def _elastic(_: Any, turn: Any, strain: Any, __: Any, test: Any, other: Any, at: Any) -> Any:
    return at.bending * turn.grad[0] * test.grad[0] + at.shear * strain * other


class LinkedElement(Element):  # type: ignore[misc]  # scikit-fem has no types
    """Deflection, rotation and shear strain of elements of Φ ``phi`` (k−1,) and lengths ``steps`` (k−1,) m.

    Degrees of freedom: deflection and rotation of both nodes, then the three bubbles.
    """

    nodal_dofs = 2
    interior_dofs = 3
    maxdeg = 3
    dofnames = ("w", "θ", "w bubble", "odd w bubble", "θ bubble")
    doflocs = np.array([[0.0], [0.0], [1.0], [1.0], [0.5], [0.5], [0.5]])
    refdom = RefLine

    def __init__(self, phi: Array, steps: Array) -> None:
        self.phi, self.steps = phi, steps

    def gbasis(self, mapping: Any, X: Array, i: int, tind: Any = None) -> tuple[DiscreteField, ...]:
        """Function ``i`` at the places ``X`` of the elements ``tind``, as scikit-fem asks for it."""
        cells = slice(None) if tind is None else tind
        h, phi, s = self.steps[cells][:, None], self.phi[cells][:, None], X[0]
        shape = np.broadcast_shapes(s.shape, h.shape)
        deflection, rotation, curvature, strain = (np.broadcast_to(part[i], shape) for part in _shapes(s, h, phi))
        return DiscreteField(deflection), DiscreteField(rotation, curvature[None]), DiscreteField(strain)


def _shapes(s: Array, h: Array, phi: Array) -> tuple[list[Any], list[Any], list[Any], list[Any]]:
    """Deflection, rotation, its derivative and shear strain of the seven functions at ``s`` in 0 … 1."""
    over = 1 / (1 + phi)
    turn, bend = 6 * over / h * (s**2 - s), 6 * over / h**2 * (2 * s - 1)
    bubble, slope, odd = s * (1 - s), (1 - 2 * s) / h, s * (1 - s) * (2 * s - 1)
    deflection = [
        over * (2 * s**3 - 3 * s**2 + 1 + phi * (1 - s)),
        over * h * (s**3 - (2 + phi / 2) * s**2 + (1 + phi / 2) * s),
        over * (-2 * s**3 + 3 * s**2 + phi * s),
        over * h * (s**3 - (1 - phi / 2) * s**2 - phi / 2 * s),
    ]
    rotation = [turn, over * (3 * s**2 - (4 + phi) * s + 1 + phi), -turn, over * (3 * s**2 - (2 - phi) * s)]
    curvature = [bend, over / h * (6 * s - 4 - phi), -bend, over / h * (6 * s - 2 + phi)]
    strain = [-phi * over / h, -phi * over / 2, phi * over / h, -phi * over / 2]
    return (
        [*deflection, bubble, odd, 0.0],
        [*rotation, 0.0, 0.0, bubble],
        [*curvature, 0.0, 0.0, slope],
        [*strain, slope, (-6 * s**2 + 6 * s - 1) / h, -bubble],
    )
