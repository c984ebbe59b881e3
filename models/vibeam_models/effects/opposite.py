"""A second beam opposite the first: the two meet, and the contact is between them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from vibeam_models.beams.beam import PAIRS, Beam
from vibeam_models.beams.shapes import SHAPES
from vibeam_models.beams.tables import dimension, dimension_faults, shape_of
from vibeam_models.keys import quantity, word
from vibeam_models.scene import Effect, Scene
from vibeam_models.space import BeamSpace, bare_beam
from vibeam_models.structure import Structure, side_by_side


@dataclass(frozen=True)
class Opposite(Effect):
    """A second beam on the same base, which the first one meets; absent = the stop stands on the base.

    What it does not say is as in [beam]; [[section]], [[plate]], [[support]] and [[added_mass]] are its own with
    on = "opposite". Its modes count among the beam's, for damping ratios and for fidelities.
    """

    position: float = quantity("m", "where it is met, from its own x = 0", "380 mm", above=0)
    arm: float = quantity(
        "m", "the contact stands this far beyond that place, on what turns with it or on a [leaf]", "57 mm", 0.0
    )
    length: float | None = quantity("m", "length, from x = 0 to its tip", "392.5 mm", None, above=0)
    shape: str | None = word(tuple(SHAPES), "of its section", "tube", None)
    width: float | None = dimension("rectangle", "width")
    thickness: float | None = dimension("rectangle", "thickness")
    diameter: float | None = dimension("round", "diameter")
    outer_diameter: float | None = dimension("tube", "outer_diameter")
    wall: float | None = dimension("tube", "wall")
    web: float | None = dimension("I", "web")
    flange: float | None = dimension("I", "flange")
    area: float | None = dimension("general", "area")
    second_moment: float | None = dimension("general", "second_moment")
    shear_area: float | None = dimension("general", "shear_area")
    youngs_modulus: float | None = quantity("Pa", "modulus of elasticity", "210 GPa", None, above=0)
    density: float | None = quantity("kg/m^3", "mass per volume", "7850 kg/m^3", None, above=0)
    ends: str | None = word(PAIRS, "how its ends are held; absent = clamped-free", "clamped-free", None)

    name: ClassVar[str] = "opposite"

    @classmethod
    def faults(cls, table: Any, case: Any) -> Iterator[tuple[str, str]]:
        """As ``Effect.faults``: a place beyond its tip, dimensions that are no shape, effects that know one beam."""
        length = table.length or case.beam.length
        if None not in (table.position, length) and table.position > length:
            yield "position", f"{table.position:g} m is beyond its tip: it is {length:g} m long"
        yield from dimension_faults(table, case.beam)
        if case.beam.massless or case.torsion is not None or (case.gravity and case.gravity.direction != "transverse"):
            yield "", "does not go with a massless beam, torsion, or weight along the beam: take one of them out"

    def beam(self, scene: Scene) -> Beam:
        """The opposite beam with all that changes it."""
        own = scene.beam
        given = {name: getattr(self, name) for name in ("length", "youngs_modulus", "density", "ends")}
        made = replace(own, shape=shape_of(self, own.shape), **{k: v for k, v in given.items() if v is not None})
        for effect in scene.of("opposite"):
            made = effect.carrier(made)
        return made

    def moving_mass(self, scene: Scene) -> float:
        """kg: of the opposite beam with all that is on it."""
        return self.beam(scene).mass + sum(mass for effect in scene.of("opposite") for mass, _ in effect.weights)

    def apply(self, structure: Structure, space: BeamSpace, scene: Scene) -> tuple[Structure, BeamSpace]:
        """Both beams side by side; the contact reads u₁(x₁) − u₂(x₂) − a θ₂(x₂), a the arm, or u₁(x₁) − the leaf's.

        Further outputs, m: ``"opposite"``, the second beam's displacement at the contact, and ``"opposite_tip"``.
        """
        other, at = self.other_beam(scene)
        rigid = at.row(self.position) + self.arm * at.row(self.position, 1)
        meeting = other.contact if scene.named("leaf") else rigid
        outputs = {"opposite": meeting, "opposite_tip": other.outputs["tip"]}
        other = other.with_(outputs=outputs, units=dict.fromkeys(outputs, "m"))
        both = side_by_side(structure, other, np.concatenate([structure.contact, -meeting]))
        return both, space.widened(other.size)

    def other_beam(self, scene: Scene) -> tuple[Structure, BeamSpace]:
        """The structure of the opposite beam alone with what it carries, and its space."""
        effects = scene.of("opposite")
        zones = [zone for effect in effects for zone in effect.rigid_zones]
        places = [x for middle, half in zones for x in (middle, middle - half, middle + half)]
        inserted = [] if any(abs(self.position - middle) <= half for middle, half in zones) else [self.position]
        structure, space = bare_beam(self.beam(scene), [*places, *inserted])
        for effect in sorted(effects, key=lambda each: each.name == "leaf"):  # it stands on all others
            structure, space = effect.apply(structure, space, scene)
        return structure, space
