"""The attached mass resists being turned: without it "bending 2" of the rig would be at 151 Hz, not 101."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from vibeam_models.scene import Effect, Scene
from vibeam_models.structure import Structure, with_inertia

if TYPE_CHECKING:
    from vibeam_models.space import BeamSpace


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
