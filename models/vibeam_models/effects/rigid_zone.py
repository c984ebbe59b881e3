"""The strip cannot bend where the mass is clamped to it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from vibeam_models.effects import Effect
from vibeam_models.structure import Array, Structure, in_coordinates

if TYPE_CHECKING:
    from vibeam_models.scene import Scene
    from vibeam_models.space import BeamSpace

LEAST = 1e-3  # share of the length below which the zone changes nothing, but its elements' round-off does


@dataclass(frozen=True)
class RigidZone(Effect):
    """The strip is rigid where the mass is clamped to it, ``rigid_half_width`` m on either side."""

    rigid_half_width: float

    name: ClassVar[str] = "mass.rigid_half_width"

    @classmethod
    def faults(cls, table: Any, case: Any) -> Iterator[tuple[str, str]]:
        """As ``Effect.faults``: a zone that reaches an end, or is too short to matter."""
        middle, half, length = table.position, table.rigid_half_width, case.beam.length
        if middle is None:
            return
        if half >= middle:
            yield "rigid_half_width", f"{half:g} m reaches the clamp: mass.position is {middle:g} m"
        elif length is not None and half < LEAST * length:
            message = f"{half:g} m is below a thousandth of beam.length and changes nothing: leave it out"
            yield "rigid_half_width", message
        elif length is not None and middle <= length <= middle + half:
            yield "rigid_half_width", f"{half:g} m reaches the tip, {length - middle:g} m beyond mass.position"

    def apply(self, structure: Structure, space: BeamSpace, scene: Scene) -> tuple[Structure, BeamSpace]:
        """As ``RigidSegment.apply``."""
        return RigidSegment(scene.attached(self.name).position, self.rigid_half_width).apply(structure, space)


@dataclass(frozen=True)
class RigidSegment:
    """Over ``position`` ± ``half_width`` m the deflection is linear; the strip's mass there moves along.

    The middle and both ends must be nodes of the mesh.
    """

    position: float
    half_width: float

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
