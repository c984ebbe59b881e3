"""A further mass anywhere on the beam: an accelerometer, a nut, a clamping."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from vibeam_models.beams.tables import beam_of, place_faults
from vibeam_models.keys import quantity
from vibeam_models.scene import OnEitherBeam, Scene
from vibeam_models.structure import Structure, with_inertia

if TYPE_CHECKING:
    from vibeam_models.space import BeamSpace


@dataclass(frozen=True)
class AddedMass(OnEitherBeam):
    """A further mass, an accelerometer say; one table for each."""

    mass: float = quantity("kg", "added mass", "2.4 g", above=0)
    position: float = quantity("m", "distance from x = 0, in (0, length]", "90 mm", above=0)
    rotary_inertia: float | None = quantity(
        "kg m^2", "about the axis of bending; absent = a point mass", "1e-7 kg m^2", None, above=0, written=False
    )
    rigid_half_width: float | None = quantity(
        "m", "the beam is rigid this far on either side of it; absent = nowhere", "5 mm", None, above=0, written=False
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
        from vibeam_models.effects.rigid_zone import RigidSegment

        return RigidSegment(self.position, self.rigid_half_width).apply(structure, space)
