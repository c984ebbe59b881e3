"""The beam is a spring only: what has no inertia follows what has, statically."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from vibeam_models.effects import LAST
from vibeam_models.scene import Effect, Scene
from vibeam_models.structure import Structure, in_coordinates

if TYPE_CHECKING:
    from vibeam_models.beams.beam import Beam
    from vibeam_models.space import BeamSpace

NOTHING = 1e-12  # share of the largest 1/ω² below which a shape carries no inertia; round-off leaves 10⁻¹⁶


@dataclass(frozen=True)
class MasslessBeam(Effect):
    """The paper's m ≫ ρAL: as many coordinates as inertias."""

    massless: bool = True

    name: ClassVar[str] = LAST

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
