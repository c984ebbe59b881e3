"""Full model of a fidelity: all modes of the structure of its own scene, with the same restitution held."""

from __future__ import annotations

from vibeam.case.fidelity import Fidelity, system
from vibeam.run.estimate.error import unsuited
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.any_scene import AnyScene, RigScene

LARGEST = 1500  # coordinates of a structure all of whose modes are computed


def full_model(scene: AnyScene) -> ImpactSystem:
    """Impact system with all modes of a scene; ValueError says why there is none with closed-form motions."""
    if scene.given_mode is not None or not isinstance(scene, RigScene):
        raise ValueError("a single degree of freedom given directly has no fuller model")
    if not scene.all_modes:
        raise ValueError("the case gives a few modes, and no structure that has more")
    if scene.platform is not None and scene.platform.coupling == "two-way":
        raise ValueError("no closed-form motions on a platform that is pushed back")
    if scene.stop.law is not None:
        raise ValueError(f'no closed-form motions with the contact law "{scene.stop.law.name}"')
    if (size := scene.structure().size) > LARGEST:
        raise ValueError(f"the full model has {size} coordinates, too many to know all of its modes")
    full = system(scene, Fidelity("full model", "full"))
    if why := unsuited(full):
        raise ValueError(f"the full model: {why}")
    return full
