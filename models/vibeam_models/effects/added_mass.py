"""A further point mass anywhere on the beam: an accelerometer, say."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from vibeam_models.effects import Effect
from vibeam_models.keys import quantity
from vibeam_models.structure import Structure, with_inertia

if TYPE_CHECKING:
    from vibeam_models.scene import Scene
    from vibeam_models.space import BeamSpace


@dataclass(frozen=True)
class AddedMass(Effect):
    """A further point mass, an accelerometer say; one table for each."""

    mass: float = quantity("kg", "added mass", "2.4 g", above=0)
    position: float = quantity("m", "distance from the clamp, in (0, length]", "90 mm", above=0)

    name: ClassVar[str] = "added_mass"
    inertias: ClassVar[int] = 1

    @classmethod
    def faults(cls, table: Any, case: Any) -> Iterator[tuple[str, str]]:
        """As ``Effect.faults``: a place beyond the tip."""
        length = case.beam.length
        if length is not None and table.position is not None and table.position > length:
            yield "position", f"{table.position:g} m is beyond the tip: beam.length is {length:g} m"

    @property
    def weights(self) -> tuple[tuple[float, float], ...]:
        """As ``Effect.weights``."""
        return ((self.mass, self.position),)

    def apply(self, structure: Structure, space: BeamSpace, scene: Scene) -> tuple[Structure, BeamSpace]:
        """M + m wᵀw with w the deflection there, and its share −m wᵀ of the base-excitation load."""
        return with_inertia(structure, space.row(self.position), self.mass, translation=1.0), space
