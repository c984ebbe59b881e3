"""The clamp yields when it is turned: its rotation is one more coordinate, held by a spring."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from vibeam_models.effects import Effect
from vibeam_models.keys import quantity
from vibeam_models.structure import Structure

if TYPE_CHECKING:
    from vibeam_models.scene import Beam, Scene
    from vibeam_models.space import BeamSpace


@dataclass(frozen=True)
class Clamp(Effect):
    """The clamp yields when it is turned; absent = it does not."""

    stiffness: float = quantity("N m/rad", "moment per rotation of the clamp", "500 N m/rad", above=0)

    name: ClassVar[str] = "clamp"
    on_bare_beam: ClassVar[bool] = True

    def apply(self, structure: Structure, space: BeamSpace, scene: Scene) -> tuple[Structure, BeamSpace]:
        """The beam alone with the slope at x = 0 freed, K + k θᵀθ. It changes the beam's support and so comes first.

        ValueError where the space is not that of a clamped beam.
        """
        count = int(space.basis.N)
        if not (space.is_plain and space.size == count - 2):
            raise ValueError("sprung clamp: the space is constrained already; it must come first")
        sprung = replace(space, constraint=np.eye(count)[:, 1:])
        return self._held(sprung, structure, scene.carrier), sprung

    def _held(self, space: BeamSpace, structure: Structure, beam: Beam) -> Structure:
        free, slope = space.constraint, space.row(0.0, 1)
        mass = space.mass(beam.mass_per_length)
        tip = space.row(beam.length)
        return structure.with_(
            M=free.T @ mass @ free,
            C=np.zeros((space.size, space.size)),
            K=free.T @ space.stiffness(beam.bending_stiffness) @ free + self.stiffness * np.outer(slope, slope),
            load=-free.T @ mass @ space.translation(),
            static=np.zeros(space.size),
            contact=tip,
            outputs={"tip": tip},
        )
