"""A leaf spring with its mass, clamped to the opposite beam: the stop that is itself a beam."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from vibeam_models.beams.beam import Beam
from vibeam_models.beams.shapes import Rectangle
from vibeam_models.keys import quantity
from vibeam_models.scene import Effect, Scene
from vibeam_models.space import BeamSpace, bare_beam
from vibeam_models.structure import Structure, in_coordinates, side_by_side

ELEMENTS = 24  # along the leaf: its third frequency is exact to 1e-5


@dataclass(frozen=True)
class Leaf(Effect):
    """A leaf spring on the opposite beam, clamped to it at opposite.position: the contact stands at opposite.arm on it.

    It moves and turns with its clamping and has its own mass, so that its modes are among the beams'. The stop's law is
    then that of the touch alone.
    """

    length: float = quantity("m", "free length, from its clamping to its tip", "57 mm", above=0)
    width: float = quantity("m", "width", "40 mm", above=0)
    thickness: float = quantity("m", "thickness, along the motion", "1 mm", above=0)
    mass: float = quantity("kg", "of the free length", "18.04 g", above=0)
    youngs_modulus: float | None = quantity(
        "Pa", "modulus of elasticity; absent = the opposite beam's", "210 GPa", None, above=0
    )

    name: ClassVar[str] = "leaf"

    @classmethod
    def faults(cls, table: Any, case: Any) -> Iterator[tuple[str, str]]:
        """As ``Effect.faults``: no beam that carries it, a contact off the leaf."""
        if case.opposite is None:
            yield "", "stands on an opposite beam: add [opposite]; a leaf on the base is an [opposite] beam itself"
        elif None not in (table.length, case.opposite.arm) and not 0 < case.opposite.arm <= table.length:
            said = f'opposite.arm says where on the leaf the contact is: write arm = "{table.length:g} m" for its tip'
            yield "length", f"{said}, or less, above 0"

    @property
    def carried_by(self) -> str:
        """As ``Effect.carried_by``."""
        return "opposite"

    @property
    def weights(self) -> tuple[tuple[float, float], ...]:
        """As ``Effect.weights``, its place counted from its clamping."""
        return ((self.mass, self.length / 2),)

    def beam(self, scene: Scene) -> Beam:
        """The leaf as a beam that nothing holds, with 0 at its clamping."""
        modulus = next(each.beam(scene).youngs_modulus for each in scene.named("opposite"))
        density = self.mass / (self.length * self.width * self.thickness)
        shape = Rectangle(self.width, self.thickness)
        return Beam(
            self.length, shape, self.youngs_modulus or modulus, density, scene.beam.damping, ELEMENTS, ends="free-free"
        )

    def apply(self, structure: Structure, space: BeamSpace, scene: Scene) -> tuple[Structure, BeamSpace]:
        """Both side by side, with deflection and slope of the leaf's first node those of its clamping.

        The contact is the deflection of the leaf at the opposite beam's arm.
        """
        stand = next(iter(scene.named("opposite")))
        leaf, along = bare_beam(self.beam(scene), [stand.arm])
        both = side_by_side(structure, leaf, np.concatenate([np.zeros(structure.size), along.row(stand.arm)]))
        basis = np.eye(both.size)
        clamping = np.stack([space.row(stand.position, order) for order in (0, 1)])
        basis[structure.size : structure.size + 2, : structure.size] = clamping
        joined = np.delete(basis, [structure.size, structure.size + 1], axis=1)
        outputs = {name: row for name, row in both.outputs.items() if name not in leaf.outputs} | {
            name: np.concatenate([row, np.zeros(leaf.size)]) for name, row in structure.outputs.items()
        }
        return in_coordinates(both.with_(outputs=outputs), joined), space.widened(leaf.size - 2)
