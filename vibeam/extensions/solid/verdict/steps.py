"""Steps from the beam to the solid: scenes, each with one assumption of the beam's less than the one before it.

The beam as the case has it; without St Venant's torsion; with shear and the section's rotary inertia (Timoshenko); the
body in three dimensions, still without Poisson's contraction (σ_ii = E ε_ii, σ_ij = G γ_ij) and with the rigid zone of
the beam; free to contract, also at its clamps (a wide strip is then a plate, EI/(1 − ν²)); held at its clamps; with
elastic blocks in place of the rigid zone; met off its axis. A step that a case has no use for is left out.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace

from vibeam.extensions.solid.elasticity.plan import Solid
from vibeam.extensions.solid.elasticity.scene import SolidScene, assumed_poissons_ratio
from vibeam_models.effects.sections import Theory
from vibeam_models.scene import Scene


@dataclass(frozen=True)
class LadderStep:
    """A step: ``name`` of the model that it leads to, ``cause`` of what that changes, its ``scene``.

    ``keys`` of the rig that the model does not read: what a block is made of takes the place of a rigid zone.
    """

    name: str
    cause: str
    scene: Scene
    keys: tuple[str, ...] = ()


LESS_TORSION = "less St Venant's torsion"
BLOCK = ("mass.rigid_half_width", "mass.rotary_inertia")


def ladder(scene: SolidScene) -> tuple[LadderStep, ...]:
    """The steps, the beam first, ``scene`` itself last."""
    return tuple(_steps(scene))


def beam_of(scene: SolidScene) -> Scene:
    """The scene with its beam in place of the body."""
    return Scene(**{each.name: getattr(scene, each.name) for each in fields(Scene)})


def solid_of(scene: Scene) -> SolidScene:
    """The scene with a body in place of its beam, itself where it has one, on two elements through it at least.

    One quadratic element has the same shear all through it, which leaves a sixth of the shear flexibility out.
    """
    solid = scene.solid if isinstance(scene, SolidScene) else Solid()
    given = {each.name: getattr(scene, each.name) for each in fields(Scene)}
    return SolidScene(**given, solid=replace(solid, through=max(solid.through or 2, 2)))


def _steps(scene: SolidScene) -> Iterator[LadderStep]:
    beam, solid = beam_of(scene), scene.solid
    yield LadderStep("beam", "", beam)
    if beam.named("torsion"):
        beam = beam.without("torsion")
        yield LadderStep("beam met on its axis", LESS_TORSION, beam)
    if not beam.shaped_beam.shear:
        yield LadderStep("Timoshenko's beam", "shear", _with_shear(beam))
    free = replace(scene.without("torsion"), solid=replace(solid, clamp="sliding", mass_size=None))
    yield LadderStep("solid without contraction", "three dimensions", replace(free, contraction=False))
    yield LadderStep("solid with sliding clamps", "plate stiffening", free)
    if solid.clamp == "held" and "clamped" in scene.shaped_beam.ends and not scene.named("clamp"):
        free = replace(free, solid=replace(free.solid, clamp="held"))
        yield LadderStep("solid with held clamps", "the clamp", free)
    if solid.mass_size is not None:
        free = replace(free, solid=replace(free.solid, mass_size=solid.mass_size))
        yield LadderStep("solid with its mass as blocks", "the mass as a block", free, BLOCK)
    if scene.named("torsion"):
        yield LadderStep("solid", "torsion", scene, BLOCK if solid.mass_size is not None else ())


def _with_shear(scene: Scene) -> Scene:
    """The scene of Timoshenko's beam, with the Poisson's ratio that the solid has."""
    beam = scene.beam
    ratio = assumed_poissons_ratio(beam.youngs_modulus)[0] if beam.poissons_ratio is None else beam.poissons_ratio
    return replace(scene, beam=replace(beam, poissons_ratio=ratio), effects=(*scene.effects, Theory("timoshenko")))


def coarser(scene: SolidScene) -> SolidScene:
    """The scene on a mesh of half as many elements in each direction, one at least."""
    solid, along = scene.solid, scene.solid.along or scene.beam.elements
    along, across, through = (max(count // 2, 1) for count in (along, solid.across, solid.through or 2))
    return replace(scene, solid=replace(solid, along=along, across=across, through=through))
