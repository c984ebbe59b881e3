"""Error estimates of a case's fidelities against the full models of their own scenes."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import fields
from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.fidelity import gap_drift, gap_wear
from vibeam.run.comparison.of_case import MOVING, SEVERAL
from vibeam.run.estimate.error import estimate_error, unsuited
from vibeam.run.estimate.full_model import full_model
from vibeam.run.estimate.records import ErrorEstimate, FidelityEstimate
from vibeam.system.response import join
from vibeam.system.state import StatesAfter

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.system.impact_system import ImpactSystem
    from vibeam.system.response import Branches


def estimates(
    case: Case, systems: Mapping[str, ImpactSystem], branches: Mapping[str, Branches],
    after: Mapping[str, Mapping[str, StatesAfter]],
) -> dict[str, FidelityEstimate]:  # fmt: skip
    """Estimate the error of every fidelity; ``after``: states after the points of each branch."""
    return {name: _estimate(case, name, systems[name], branches[name], after.get(name, {})) for name in branches}


def _estimate(
    case: Case, name: str, system: ImpactSystem, branches: Branches, after: Mapping[str, StatesAfter]
) -> FidelityEstimate:
    begun, scene = time.thread_time(), case.scene_of(name)
    omega = 2 * np.pi * case.sweep.frequency
    try:
        if scene.harmonics:
            raise ValueError(SEVERAL)
        if gap_wear(scene) is not None or gap_drift(scene, omega) is not None:
            raise ValueError(MOVING)
        full = full_model(scene)
        if why := unsuited(system):
            raise ValueError(why)
    except ValueError as refusal:
        return FidelityEstimate(0, {}, str(refusal))
    if system.size == full.size:
        return FidelityEstimate(full.size, {}, whole=True)
    found = _of_branches(case, name, (system, full), branches, after)
    return FidelityEstimate(full.size, found, cpu_seconds=time.thread_time() - begun)


def _of_branches(
    case: Case, name: str, models: tuple[ImpactSystem, ImpactSystem], branches: Branches,
    after: Mapping[str, StatesAfter],
) -> dict[str, ErrorEstimate]:  # fmt: skip
    """Both directions at once: what they have in common is computed once."""
    system, full = models
    parts = dict(branches.items())
    response = join(list(parts.values())) if len(parts) > 1 else next(iter(parts.values()))
    known = [after.get(way) or StatesAfter.unknown(len(part), system.size) for way, part in parts.items()]
    states = StatesAfter(*(np.concatenate([getattr(each, f.name) for each in known]) for f in fields(StatesAfter)))
    amplitude = case.amplitude_of(name, 2 * np.pi * response.frequency)
    whole = estimate_error(response, system, full, amplitude, case.sweep.output, states)
    ends = np.cumsum([len(part) for part in parts.values()])[:-1]
    pieces = {field.name: np.split(getattr(whole, field.name), ends) for field in fields(ErrorEstimate)}
    return {way: ErrorEstimate(**{name: pieces[name][i] for name in pieces}) for i, way in enumerate(parts)}
