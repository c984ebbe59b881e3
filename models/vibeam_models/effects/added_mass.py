"""A further point mass anywhere on the beam: an accelerometer, say."""

from __future__ import annotations

from dataclasses import dataclass

from vibeam_models.space import BeamSpace
from vibeam_models.structure import Structure, with_inertia


@dataclass(frozen=True)
class PointMass:
    """``mass`` kg at ``position`` m."""

    mass: float
    position: float

    def apply(self, structure: Structure, space: BeamSpace) -> tuple[Structure, BeamSpace]:
        """M + m wᵀw with w the deflection there, and its share −m wᵀ of the base-excitation load."""
        return with_inertia(structure, space.row(self.position), self.mass, translation=1.0), space
