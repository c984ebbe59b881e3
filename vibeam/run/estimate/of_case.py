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
from vibeam.system.response import FrequencyResponse, join
from vibeam.system.state import StatesAfter

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.run.accuracy.study import Curve
    from vibeam.system.impact_system import ImpactSystem
    from vibeam.system.response import Branches


def estimates(
    case: Case, systems: Mapping[str, ImpactSystem], branches: Mapping[str, Branches],
    after: Mapping[str, Mapping[str, StatesAfter]],
) -> dict[str, FidelityEstimate]:  # fmt: skip
    """Estimate the error of every fidelity; ``after``: states after the points of each branch."""
    return {name: _estimate(case, name, systems[name], branches[name], after.get(name, {})) for name in branches}


def estimate_of_choice(
    case: Case, systems: Mapping[str, ImpactSystem], curves: Mapping[str, Curve]
) -> FidelityEstimate:  # fmt: skip
    """Estimate the error of a curve within an accuracy, each point with the model that gave it; see ``estimates``."""
    begun, chosen = time.thread_time(), {name for curve in curves.values() for name in curve.fidelity}
    try:
        models = {name: _models(case, name, systems[name]) for name in sorted(chosen)}
    except ValueError as refusal:
        return FidelityEstimate(0, {}, str(refusal))
    found = {way: _of_curve(case, models, curve) for way, curve in curves.items()}
    return FidelityEstimate(
        max(full.size for _, full in models.values()), found, cpu_seconds=time.thread_time() - begun
    )


def _of_curve(case: Case, models: Mapping[str, tuple[ImpactSystem, ImpactSystem]], curve: Curve) -> ErrorEstimate:
    """Estimates along one curve, put together from those of each model's points."""
    names, parts, places = np.array(curve.fidelity), [], []
    for name in dict.fromkeys(curve.fidelity):
        which = np.flatnonzero(names == name)
        values = {f.name: getattr(curve.response, f.name)[which] for f in fields(FrequencyResponse)}
        amplitude = np.broadcast_to(case.amplitude_of(name, 2 * np.pi * values["frequency"]), len(which))
        parts.append(estimate_error(FrequencyResponse(**values), *models[name], amplitude, case.sweep.output))
        places.append(which)
    order = np.argsort(np.concatenate(places))
    rows = {f.name: np.concatenate([getattr(part, f.name) for part in parts])[order] for f in fields(ErrorEstimate)}
    return ErrorEstimate(**rows)


def _models(case: Case, name: str, system: ImpactSystem) -> tuple[ImpactSystem, ImpactSystem]:
    """Model of a fidelity and the full one of its scene; ValueError says why there is no estimate against that."""
    scene, omega = case.scene_of(name), 2 * np.pi * case.sweep.frequency
    if scene.harmonics:
        raise ValueError(SEVERAL)
    if gap_wear(scene) is not None or gap_drift(scene, omega) is not None:
        raise ValueError(MOVING)
    full = full_model(scene)
    if why := unsuited(system):
        raise ValueError(why)
    return system, full


def _estimate(
    case: Case, name: str, system: ImpactSystem, branches: Branches, after: Mapping[str, StatesAfter]
) -> FidelityEstimate:
    begun = time.thread_time()
    try:
        _, full = _models(case, name, system)
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
