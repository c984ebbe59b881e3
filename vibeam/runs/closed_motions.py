"""Scenes without closed-form motions: several harmonics, a gap that changes, a platform that is pushed back."""

from __future__ import annotations

from vibeam.case.fidelity import gap_drift, gap_wear
from vibeam_models.arrays import Array
from vibeam_models.scene import AnyScene

SEVERAL = "no closed-form motions under several harmonics"
MOVING = "the gap changes along the sweep, which no closed form follows"
PUSHED = "no closed-form motions on a platform that is pushed back"


def without_closed_forms(scene: AnyScene, omega: Array) -> str:
    """Reason why no model of a scene has closed-form motions along a sweep over ``omega`` (rad/s); empty: some have."""
    if scene.harmonics:
        return SEVERAL
    if gap_wear(scene) is not None or gap_drift(scene, omega) is not None:
        return MOVING
    return PUSHED if scene.platform is not None and scene.platform.coupling == "two-way" else ""
