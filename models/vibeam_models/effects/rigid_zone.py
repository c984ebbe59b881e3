"""The strip cannot bend where the mass is clamped to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vibeam_models.space import BeamSpace
from vibeam_models.structure import Array, Structure, in_coordinates

if TYPE_CHECKING:
    from vibeam_models.scene import Mass

LEAST = 1e-3  # share of the length below which the zone changes nothing, but its elements' round-off does


@dataclass(frozen=True)
class RigidZone:
    """Over ``position`` ± ``half_width`` m the deflection is linear; the strip's mass there moves along.

    The middle and both ends must be nodes of the mesh.
    """

    position: float
    half_width: float

    @classmethod
    def of(cls, mass: Mass) -> RigidZone:
        """That of an attached mass, which has one."""
        return cls(mass.position, mass.rigid_half_width or 0.0)

    def apply(self, structure: Structure, space: BeamSpace) -> tuple[Structure, BeamSpace]:
        """Deflection and slope of the middle stand for those of every node of the zone (kinematic elimination).

        ValueError where the zone reaches the clamp or the tip, or where the mesh has no node it needs.
        """
        self._check(space)
        basis = self._elimination(space)
        return in_coordinates(structure, basis), space.constrained(basis)

    def _elimination(self, space: BeamSpace) -> Array:
        """x = basis @ y: free coordinates by those that are left, u_i = u_m + θ_m (x_i − x_m), θ_i = θ_m."""
        inside = np.flatnonzero(self._within(space.nodes))
        middle = self._node_at(space.nodes, self.position)
        full = np.eye(int(space.basis.N))
        for node in inside:
            deflection, slope = space.basis.nodal_dofs[:, node]
            full[[deflection, slope]] = 0.0
            full[deflection, space.basis.nodal_dofs[:, middle]] = 1.0, space.nodes[node] - space.nodes[middle]
            full[slope, space.basis.nodal_dofs[1, middle]] = 1.0
        gone = space.basis.nodal_dofs[:, inside[inside != middle]].ravel()
        free = space.free
        return full[free][:, np.setdiff1d(free, gone)]

    def _within(self, nodes: Array) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
        return np.asarray(np.abs(nodes - self.position) <= self.half_width + self._tolerance(nodes))

    def _node_at(self, nodes: Array, x: float) -> int:
        nearest = int(np.argmin(np.abs(nodes - x)))
        if abs(nodes[nearest] - x) > self._tolerance(nodes):
            raise ValueError(f"rigid zone: the mesh has no node at {x} m")
        return nearest

    def _check(self, space: BeamSpace) -> None:
        start, end = self.position - self.half_width, self.position + self.half_width
        length = space.nodes[-1]
        if self.half_width < 0 or start <= 0 or end >= length:
            raise ValueError(f"rigid zone [{start}, {end}] m must lie inside the beam, (0, {length}) m")
        if 0 < self.half_width < LEAST * length:
            raise ValueError(f"rigid zone: ±{self.half_width} m is below {LEAST:g} of the beam's length: leave it out")
        if not space.is_plain:
            raise ValueError("rigid zone: the space is constrained already; it must come first or alone")
        for x in (start, end):
            self._node_at(space.nodes, x)

    @staticmethod
    def _tolerance(nodes: Array) -> float:
        return float(1e-8 * nodes[-1])
