"""Closed-form motions of a model over a sweep: which models have them, their amplitudes, the largest of these.

Three kinds: the two with one impact a drive period, harder impact first, and the one that never reaches the stop; each
stable, and clear of the stop in between.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.fidelity import gap_drift, gap_wear
from vibeam.periodic.bifurcation_functions import motions
from vibeam.periodic.modal_sums import fault
from vibeam.periodic.predicted_response import PredictedResponse, predicted, predicted_free
from vibeam.periodic.train_sums import Trains
from vibeam.system.curves import evenly
from vibeam_models.arrays import Array, Index

if TYPE_CHECKING:
    from vibeam.system.impact_system import ImpactSystem
    from vibeam_models.scene import AnyScene

KINDS = HARDER, SOFTER, FREE = range(3)
POINTS = 16  # frequencies evaluated at once, evenly spread

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


def unsuited(system: ImpactSystem) -> str:
    """Reason why a system has no closed-form motions; empty where it has."""
    if np.any(system.omega == 0):
        return "it has a mode without stiffness"
    if system.beyond_plain:
        return f"no closed-form motions with {' or '.join(system.beyond_plain)}"
    return fault(system)


def closed_motion(system: ImpactSystem, omega: Array, base: Array, output: str, kind: int) -> PredictedResponse:
    """Motion of one ``kind`` at drives ``omega`` (points,) rad/s, ``base`` (points,) m; NaN where there is none."""
    if kind == FREE:
        return predicted_free(system, omega, base, output)
    roots = motions(system, 1, omega, base, np.full(len(omega), system.gap)).roots
    trains = Trains(roots.phase[:, kind, None], roots.impulse[:, kind, None], omega, base, 1)
    return predicted(system, trains, output)


def closed_amplitudes(
    system: ImpactSystem, omega: Array, base: Array, output: str, kinds: Sequence[int] = KINDS
) -> Array:
    """Amplitude of the closed-form motions (points, KINDS); NaN where there is none, or it was not asked for."""
    found = np.full((len(omega), len(KINDS)), np.nan)
    damped = bool(np.all(system.zeta > 0))
    for kind in kinds if not unsuited(system) else ():
        if kind != FREE or damped:  # without impacts an undamped mode keeps what disturbed it
            found[:, kind] = closed_motion(system, omega, base, output, kind).amplitude
    return found


@dataclass(frozen=True, eq=False)
class ClosedCurve:
    """Amplitudes (points, KINDS) at the frequencies ``which`` of the grid, NaN where there is no such motion.

    ``peak``: the largest over the whole grid, NaN without any.
    """

    which: Index
    amplitude: Array
    peak: float


def closed_curve(system: ImpactSystem, omega: Array, base: Array, output: str) -> ClosedCurve:
    """Closed-form motions of a plain system over ``omega`` (rad/s, ascending), under base motion ``base`` (m)."""
    which = evenly(0, len(omega) - 1, POINTS)
    found = closed_amplitudes(system, omega[which], base[which], output)
    if not np.isfinite(found).any():
        return ClosedCurve(which, found, np.nan)
    kind = int(np.nanargmax(found)) % len(KINDS)
    low, high, height = 0, len(omega) - 1, float(np.nanmax(found))
    near, values = which, found[:, kind]
    while len(near) < high - low + 1:  # the neighbours of the highest, until they are next to it on the grid
        top = int(np.nanargmax(values))
        low, high = int(near[max(top - 1, 0)]), int(near[min(top + 1, len(near) - 1)])
        near = evenly(low, high, POINTS)
        values = closed_amplitudes(system, omega[near], base[near], output, (kind,))[:, kind]
        height = max(height, float(np.nanmax(values)))
    return ClosedCurve(which, found, height)
