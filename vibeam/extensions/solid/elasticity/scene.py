"""SolidScene: the rig as a three-dimensional body; Poisson's ratio of a material that does not say it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from vibeam.extensions.solid.elasticity.plan import Solid
from vibeam_models.beam import structure_of
from vibeam_models.beams.beam import Beam
from vibeam_models.registry import loaded
from vibeam_models.scene import Scene
from vibeam_models.structure import Structure

SPATIAL = "vibeam.extensions.solid.spatial"


@dataclass(frozen=True)
class SolidScene(Scene):
    """A scene whose beam is a three-dimensional elastic body; stop, base, outputs and effects as of the beam.

    ``contraction`` False: no Poisson's contraction, σ_ii = E ε_ii and σ_ij = G γ_ij with the same E and G, as a beam's
    theory assumes. No key: a step from the beam to the solid.
    """

    solid: Solid = field(default_factory=Solid)
    contraction: bool = True

    @property
    def spatial(self) -> str:
        """As ``AnyScene.spatial``."""
        return SPATIAL

    @property
    def assumed(self) -> tuple[str, ...]:
        """As ``AnyScene.assumed``."""
        return tuple(assumptions(self))


@structure_of.register
def _(scene: SolidScene) -> Structure:
    """The structure of the body, made where it is first asked for: a case without one imports none of it."""
    made: Structure = loaded("vibeam.extensions.solid.elasticity.structure:solid_structure")(scene)
    return made


#: modulus in Pa, Poisson's ratio, name: usual values, of no one alloy
MATERIALS = ((210e9, 0.3, "steel"), (110e9, 0.34, "copper or titanium"), (70e9, 0.33, "aluminium"))
NEAR = 0.1  # of the modulus within which it is that of a material
USUAL = 0.3
THIN = 2000  # heights: length from which round-off counts


def assumed_poissons_ratio(youngs_modulus: float) -> tuple[float, str]:
    """Poisson's ratio for a modulus in Pa, and the material that it is taken from; empty: it is near to none."""
    for modulus, ratio, name in MATERIALS:
        if abs(youngs_modulus - modulus) <= NEAR * modulus:
            return ratio, name
    return USUAL, ""


def assumption(youngs_modulus: float, key: str = "beam.poissons_ratio") -> str:
    """Sentence that says which Poisson's ratio is assumed for a modulus in Pa, why, and which ``key`` says it."""
    ratio, material = assumed_poissons_ratio(youngs_modulus)
    of = f"of {material} by" if material else "as of most metals, for"
    return f"Poisson's ratio {ratio:g}, {of} E = {youngs_modulus / 1e9:.4g} GPa, is assumed: {key} says it"


def assumptions(scene: SolidScene) -> Iterator[str]:
    """Sentences about every Poisson's ratio that a solid assumes, of beams, sections, plates and blocks; round-off."""
    beams = [scene.shaped_beam, *(each.beam(scene) for each in scene.named("opposite"))]
    stretches = [each for beam in beams for each in beam.stretches]
    moduli = [each.material.youngs_modulus for each in stretches if each.material.poissons_ratio is None]
    yield from map(assumption, dict.fromkeys(moduli))
    bonded = [(plate.youngs_modulus, each) for each in stretches for plate in each.plates if plate.stiffens]
    others = [modulus for modulus, each in bonded if modulus != each.material.youngs_modulus]
    if scene.solid.mass_size and scene.solid.mass_youngs_modulus not in (None, scene.beam.youngs_modulus):
        others.append(scene.solid.mass_youngs_modulus)
    yield from (assumption(each, "no key") for each in dict.fromkeys(others) if each not in moduli)
    slenderness = max(beam.length / min(heights(beam)) for beam in beams)
    if slenderness > THIN:
        yield (
            f"the beam is {slenderness:.0f} times as long as thick: round-off is some 3e-5 of its first frequency at "
            "2000 times, 2e-4 at 4000, and grows on: a beam's model has none"
        )


def heights(beam: Beam) -> list[float]:
    """Heights (m) of the beam's own sections where its stretches begin and end; NaN where none is known."""
    ends = [each.section(np.array(x)) for each in beam.stretches for x in (each.start, each.end)]
    return [float(section.height or np.nan) for section in ends]
