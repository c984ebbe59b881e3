"""Masses: attached ones with rotary inertia and rigid zones; the beam without mass of its own."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from vibeam_models.arrays import Array
from vibeam_models.beams.beam import Beam
from vibeam_models.beams.tables import beam_of, is_free, place_faults
from vibeam_models.effects import LAST
from vibeam_models.keys import quantity
from vibeam_models.scene import Effect, OnEitherBeam, Scene
from vibeam_models.space import BeamSpace
from vibeam_models.structure import Structure, in_coordinates, with_inertia

LEAST = 1e-3  # share of the length below which the zone changes nothing, but its elements' round-off does
SAME = 1e-8  # share of the length within which a node is at a place
KEPT = 16  # eliminations, each of a space of its own
NOTHING = 1e-12  # share of the largest 1/ω² below which a shape carries no inertia; round-off leaves 10⁻¹⁶


@dataclass(frozen=True)
class AddedMass(OnEitherBeam):
    """A further mass, an accelerometer say; one table for each."""

    mass: float = quantity("kg", "added mass", "2.4 g", above=0)
    position: float = quantity("m", "distance from x = 0, in (0, length]", "90 mm", above=0)
    rotary_inertia: float | None = quantity(
        "kg m^2", "about the axis of bending; absent = a point mass", "1e-7 kg m^2", None, above=0
    )
    rigid_half_width: float | None = quantity(
        "m", "the beam is rigid this far on either side of it; absent = nowhere", "5 mm", None, above=0
    )

    name: ClassVar[str] = "added_mass"
    inertias: ClassVar[int] = 1

    @classmethod
    def faults(cls, table: Any, case: Any) -> Iterator[tuple[str, str]]:
        """As ``Effect.faults``: a place beyond the tip, a rigid zone that reaches an end."""
        yield from place_faults(table, case)
        carrier, half = beam_of(table, case), table.rigid_half_width
        if carrier is None or None in (half, carrier.length, table.position) or table.position > carrier.length:
            return
        if half >= min(table.position, carrier.length - table.position):
            yield "rigid_half_width", f"{half:g} m reaches an end of the beam"

    @property
    def weights(self) -> tuple[tuple[float, float], ...]:
        """As ``Effect.weights``."""
        return ((self.mass, self.position),)

    @property
    def rigid_zones(self) -> tuple[tuple[float, float], ...]:
        """As ``Effect.rigid_zones``."""
        return ((self.position, self.rigid_half_width),) if self.rigid_half_width else ()

    def apply(self, structure: Structure, space: BeamSpace, scene: Scene) -> tuple[Structure, BeamSpace]:
        """M + m wᵀw with w the deflection there, and its share −m wᵀ of the base-excitation load; J θᵀθ alike."""
        structure = with_inertia(structure, space.row(self.position), self.mass, translation=1.0)
        if self.rotary_inertia is not None:
            structure = with_inertia(structure, space.row(self.position, 1), self.rotary_inertia, translation=0.0)
        if self.rigid_half_width is None:
            return structure, space
        return RigidSegment(self.position, self.rigid_half_width).apply(structure, space)


@dataclass(frozen=True)
class RotaryInertia(Effect):
    """Rotary inertia J of the attached mass, in kg m²."""

    rotary_inertia: float

    name: ClassVar[str] = "mass.rotary_inertia"
    inertias: ClassVar[int] = 1

    def apply(self, structure: Structure, space: BeamSpace, scene: Scene) -> tuple[Structure, BeamSpace]:
        """M + J θᵀθ with θ the slope at the mass; a translating base does not turn it, so the load stays."""
        slope = space.row(scene.attached(self.name).position, 1)
        return with_inertia(structure, slope, self.rotary_inertia, translation=0.0), space


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
        within = np.abs(space.nodes - self.position) <= self.half_width + SAME * space.nodes[-1]
        inside, middle = np.flatnonzero(within), self._node_at(space.nodes, self.position)
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

    def _node_at(self, nodes: Array, x: float) -> int:
        nearest = int(np.argmin(np.abs(nodes - x)))
        if abs(nodes[nearest] - x) > SAME * nodes[-1]:
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


@lru_cache(maxsize=KEPT)
def _eliminated(segment: RigidSegment, space: BeamSpace) -> tuple[Array, BeamSpace]:
    """Basis of what is left, and the space constrained to it; ValueError where the space does not allow it."""
    segment._check(space)
    basis = segment._elimination(space)
    return basis, space.constrained(basis)


@dataclass(frozen=True)
class MasslessBeam(Effect):
    """The paper's m ≫ ρAL: as many coordinates as inertias."""

    massless: bool = True

    name: ClassVar[str] = LAST

    @classmethod
    def faults(cls, table: Any, case: Any) -> Iterator[tuple[str, str]]:
        """As ``Effect.faults``: a beam that can move as a rigid body, whose masses no static deflection ties."""
        if is_free(case, "beam"):
            yield "massless", "no static deflection ties the masses of a free beam: hold it, or take massless out"

    def carrier(self, beam: Beam) -> Beam:
        """As ``Effect.carrier``."""
        return beam.massless()

    def apply(self, structure: Structure, space: BeamSpace, scene: Scene) -> tuple[Structure, BeamSpace]:
        """Static condensation: the shapes K⁻¹f under forces on the masses are all that can move. It comes last.

        M φ = ω⁻² K φ has exactly these shapes for ω⁻² > 0, whatever the units of the coordinates.
        """
        from scipy.linalg import eigh

        inverse, shapes = eigh(structure.M, structure.K)
        kept = shapes[:, inverse > NOTHING * inverse[-1]][:, ::-1]
        moving = kept / np.sqrt(np.sum(kept * (structure.M @ kept), axis=0))
        return in_coordinates(structure, moving), space.constrained(moving)
