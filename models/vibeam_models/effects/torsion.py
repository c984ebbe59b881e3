"""The strip twists when the stop meets it off its axis: St Venant torsion beside the bending."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from skfem import Basis, BilinearForm, ElementLineP2, MeshLine
from skfem.helpers import dot, grad

from vibeam_models.scene import Beam
from vibeam_models.space import BeamSpace
from vibeam_models.structure import Array, Structure

TERMS = 40  # of the series, where tanh is 1 and the rest of Σ n⁻⁵ is below 10⁻⁹


@dataclass(frozen=True)
class StVenantTorsion:
    """Twist of ``beam`` with ``polar_inertia`` kg m² at ``mass_at`` m and the contact at ``contact_at`` m.

    ``eccentricity`` m: how far off the axis the contact lies; ``shear_modulus`` Pa; ``rigid_half_width`` m: the strip
    does not twist either this far from the mass (0: everywhere).
    """

    eccentricity: float
    shear_modulus: float
    polar_inertia: float
    beam: Beam
    mass_at: float
    contact_at: float
    rigid_half_width: float = 0.0

    def apply(self, structure: Structure, space: BeamSpace) -> tuple[Structure, BeamSpace]:
        """The structure and, uncoupled but for the contact's row w + eθ, the twist of the beam held at x = 0."""
        mass, stiffness, angle = self._twist(space.nodes)
        count = len(mass)
        wider = Structure(
            M=_beside(structure.M, mass),
            C=_beside(structure.C, np.zeros((count, count))),
            K=_beside(structure.K, stiffness),
            load=_longer(structure.load, np.zeros(count)),
            static=_longer(structure.static, np.zeros(count)),
            contact=_longer(structure.contact, self.eccentricity * angle),
            outputs=_all_longer(structure.outputs, count),
            units=structure.units,
        )
        return wider, space.widened(count)

    def _twist(self, nodes: Array) -> tuple[Array, Array, Array]:
        """Inertia, stiffness and the row of the contact's angle, quadratic elements on the same nodes."""
        basis = Basis(MeshLine(nodes), ElementLineP2(), intorder=4)
        places = basis.doflocs[0]
        free = self._elimination(places)
        inertia = BilinearForm(lambda u, v, _: u * v).assemble(basis).toarray() * self.inertia_per_length
        stiffness = BilinearForm(lambda u, v, _: dot(grad(u), grad(v))).assemble(basis).toarray() * self.rigidity
        at_mass = self._row(basis, self.mass_at) @ free
        mass = free.T @ inertia @ free + self.polar_inertia * np.outer(at_mass, at_mass)
        return _symmetric(mass), _symmetric(free.T @ stiffness @ free), self._row(basis, self.contact_at) @ free

    @property
    def rigidity(self) -> float:
        """GJ_t in N m²."""
        return self.shear_modulus * torsion_constant(self.beam.width, self.beam.thickness)

    @property
    def inertia_per_length(self) -> float:
        """ρI_p in kg m: b² + t² over 12 of the mass per length."""
        return self.beam.mass_per_length * (self.beam.width**2 + self.beam.thickness**2) / 12

    def _elimination(self, places: Array) -> Array:
        """All angles by the free ones: none at the clamp, one for the whole rigid zone."""
        within = np.abs(places - self.mass_at) <= self.rigid_half_width + 1e-8 * self.beam.length
        first = int(np.argmin(np.abs(places - self.mass_at)))
        full = np.eye(len(places))
        if self.rigid_half_width > 0:
            full[within] = np.eye(len(places))[first]
        gone = (places == 0) | (within & (np.arange(len(places)) != first) & (self.rigid_half_width > 0))
        return np.asarray(full[:, ~gone])

    def _row(self, basis: Any, x: float) -> Array:
        return np.asarray(basis.probes(np.array([[x]])).toarray()[0])


def torsion_constant(width: float, thickness: float) -> float:
    """J_t in m⁴ of a rectangle, St Venant's series: bt³/3 (1 − 192t/(π⁵b) Σ tanh(nπb/2t)/n⁵), n odd, b ≥ t."""
    b, t = max(width, thickness), min(width, thickness)
    n = np.arange(1, 2 * TERMS, 2)
    series = float(np.sum(np.tanh(n * np.pi * b / (2 * t)) / n**5.0))
    return b * t**3 / 3 * (1 - 192 * t / (np.pi**5 * b) * series)


def _beside(one: Array, two: Array) -> Array:
    empty = np.zeros((len(one), len(two)))
    return np.block([[one, empty], [empty.T, two]])


def _longer(row: Array, more: Array) -> Array:
    return np.concatenate([row, more])


def _all_longer(rows: Mapping[str, Array], count: int) -> dict[str, Array]:
    return {name: _longer(row, np.zeros(count)) for name, row in rows.items()}


def _symmetric(matrix: Array) -> Array:
    return np.asarray((matrix + matrix.T) / 2)
