"""The attached mass resists being turned: without it "bending 2" of the rig would be at 151 Hz, not 101."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from vibeam_models.space import BeamSpace
from vibeam_models.structure import Structure, with_inertia

if TYPE_CHECKING:
    from vibeam_models.scene import Mass


@dataclass(frozen=True)
class RotaryInertia:
    """``inertia`` J kg m² about the point ``position`` m."""

    inertia: float
    position: float

    inertias: ClassVar[int] = 1

    @classmethod
    def of(cls, mass: Mass) -> RotaryInertia:
        """That of an attached mass, which has one."""
        return cls(mass.rotary_inertia or 0.0, mass.position)

    def apply(self, structure: Structure, space: BeamSpace) -> tuple[Structure, BeamSpace]:
        """M + J θᵀθ with θ the slope there; a translating base does not turn it, so the load stays."""
        return with_inertia(structure, space.row(self.position, 1), self.inertia, translation=0.0), space
