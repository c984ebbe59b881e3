"""The strip cannot bend where the mass is clamped to it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from vibeam_models.arrays import Array
from vibeam_models.scene import Effect, Scene
from vibeam_models.structure import Structure, in_coordinates

if TYPE_CHECKING:
    from vibeam_models.space import BeamSpace

LEAST = 1e-3  # share of the length below which the zone changes nothing, but its elements' round-off does
KEPT = 16  # eliminations, each of a space of its own


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
        basis, constrained = _eliminated(self, space)
        return in_coordinates(structure, basis), constrained

    def _elimination(self, space: BeamSpace) -> Array:
        """x = basis @ y: free coordinates by those that are left, u_i = u_m + θ_m (x_i − x_m), θ_i = θ_m."""
        inside, middle = np.flatnonzero(self._within(space.nodes)), self._node_at(space.nodes, self.position)
        deflection, slope = (self._coordinates(space, 2 * inside + which) for which in (0, 1))
        at = int(np.flatnonzero(inside == middle)[0])
        full = np.eye(space.size)
        full[np.concatenate([deflection, slope])] = 0.0
        full[deflection, deflection[at]] = 1.0
        full[deflection, slope[at]] = space.nodes[inside] - space.nodes[middle]
        full[slope, slope[at]] = 1.0
        bubbles = self._coordinates(space, space.elements.inner(inside[:-1]))
        return np.delete(full, [*np.delete(deflection, at), *np.delete(slope, at), *bubbles], axis=1)

    def _coordinates(self, space: BeamSpace, dofs: NDArray[np.intp]) -> NDArray[np.intp]:
        """The coordinates that are these degrees of freedom; ValueError where one is held or tied to others."""
        rows = space.constraint[dofs]
        if np.any(np.count_nonzero(rows, axis=1) != 1) or np.any(np.max(rows, axis=1, initial=1.0) != 1):
            raise ValueError(f"rigid zone at {self.position} m: a support or another rigid zone holds part of it")
        return np.asarray(np.argmax(rows, axis=1))

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
        for x in (start, end):
            self._node_at(space.nodes, x)

    @staticmethod
    def _tolerance(nodes: Array) -> float:
        return float(1e-8 * nodes[-1])


@lru_cache(maxsize=KEPT)
def _eliminated(segment: RigidSegment, space: BeamSpace) -> tuple[Array, BeamSpace]:
    """Basis of what is left, and the space constrained to it; ValueError where the space does not allow it."""
    segment._check(space)
    basis = segment._elimination(space)
    return basis, space.constrained(basis)
