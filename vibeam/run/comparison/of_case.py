"""Comparisons of a case's fidelities, one for each finest fidelity of the same physics."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.fidelity import gap_drift, gap_wear
from vibeam.run.comparison.differences import HeldComparison
from vibeam.run.comparison.held_comparison import ComparedModel, held_comparison

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.system.impact_system import ImpactSystem
    from vibeam.system.response import Branches

MOVING = "the gap changes along the sweep, which no closed form follows"

SEVERAL = "no closed-form motions under several harmonics"


def comparisons(
    case: Case, finest: Mapping[str, str], systems: Mapping[str, ImpactSystem], branches: Mapping[str, Branches]
) -> tuple[HeldComparison, ...]:
    """Compare every fidelity with its ``finest``; those compared with none are left out, and cost nothing.

    ``branches``: of the fidelities that were run, empty where only the chosen points of an accuracy were.
    """
    models = {name: compared_model(case, name, systems[name], branches.get(name)) for name in finest}
    groups = {top: [models[n] for n in finest if finest[n] == top != n] for top in dict.fromkeys(finest.values())}
    return tuple(held_comparison(models[top], others) for top, others in groups.items() if others)


def compared_model(
    case: Case, name: str, system: ImpactSystem, branches: Branches | None = None, like: str | None = None
) -> ComparedModel:
    """Model of one fidelity over the case's sweep, with the branches of its run; ``like``: whose scene it has."""
    omega, scene = 2 * np.pi * np.sort(case.sweep.frequency), case.scene_of(like or name)
    base = np.broadcast_to(np.asarray(case.amplitude_of(like or name, omega), dtype=float), omega.shape)
    moves = gap_wear(scene) is not None or gap_drift(scene, omega) is not None
    why = SEVERAL if scene.harmonics else MOVING if moves else ""
    return ComparedModel(name, scene, system, omega, base, case.sweep.output, branches, why)
