"""Error estimates of a case's fidelities against the full models of their own scenes: all modes, same restitution."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields, replace
from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.fidelity import Fidelity, gap_drift, gap_wear, system
from vibeam.runs.comparison.held_comparison import MOVING, SEVERAL
from vibeam.runs.estimate.error import estimate_error, unsuited
from vibeam.runs.estimate.flown import FullSweep, Motion, without_another_motion
from vibeam.runs.estimate.records import ErrorEstimate, FidelityEstimate
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import FrequencyResponse, join
from vibeam.system.state import StatesAfter
from vibeam_models.beam import structure_of
from vibeam_models.scene import AnyScene, RigScene

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.runs.accuracy.study import Curve
    from vibeam.system.response import Branches


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
    if (size := structure_of(scene).size) > LARGEST:
        raise ValueError(f"the full model has {size} coordinates, too many to know all of its modes")
    full = system(scene, Fidelity("full model", "full"))
    if why := unsuited(full):
        raise ValueError(f"the full model: {why}")
    return full


def estimates(
    case: Case, systems: Mapping[str, ImpactSystem], branches: Mapping[str, Branches],
    after: Mapping[str, Mapping[str, StatesAfter]],
) -> dict[str, FidelityEstimate]:  # fmt: skip
    """Estimate the error of every fidelity; ``after``: states after the points of each branch.

    The full model of a scene is made once for all fidelities of that scene, and flown once: see ``flown``.
    """
    found: dict[str, FidelityEstimate] = {}
    for names in _scenes(case, branches):
        begun = time.thread_time()
        try:
            full = _full(case, names[0])
        except ValueError as refusal:
            found |= dict.fromkeys(names, FidelityEstimate(0, {}, str(refusal)))
            continue
        made = {
            name: _estimate(case, name, (systems[name], full), branches[name], after.get(name, {})) for name in names
        }
        made |= _of_own_motions(case, full, made, branches)
        each = (time.thread_time() - begun) / len(names)
        found |= {name: replace(one, cpu_seconds=each) for name, one in made.items()}
    return {name: found[name] for name in branches}


def _scenes(case: Case, names: Iterable[str]) -> list[list[str]]:
    """Fidelities by scene: those whose changes to the case's own are the same."""
    groups: dict[str, list[str]] = {}
    for name in names:
        own = case.fidelities[name]
        groups.setdefault(repr((own.changes, own.without)), []).append(name)
    return list(groups.values())


def _full(case: Case, name: str) -> ImpactSystem:
    """Full model of a fidelity's scene; ValueError says why there is no estimate against that."""
    scene, omega = case.scene_of(name), 2 * np.pi * case.sweep.frequency
    if scene.harmonics:
        raise ValueError(SEVERAL)
    if gap_wear(scene) is not None or gap_drift(scene, omega) is not None:
        raise ValueError(MOVING)
    return full_model(scene)


def _estimate(
    case: Case, name: str, models: tuple[ImpactSystem, ImpactSystem], branches: Branches,
    after: Mapping[str, StatesAfter],
) -> FidelityEstimate:  # fmt: skip
    system, full = models
    if why := unsuited(system):
        return FidelityEstimate(0, {}, why)
    if system.size == full.size:
        return FidelityEstimate(full.size, {}, whole=True)
    return FidelityEstimate(full.size, _of_branches(case, name, models, branches, after))


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


def _of_own_motions(
    case: Case, full: ImpactSystem, made: Mapping[str, FidelityEstimate], branches: Mapping[str, Branches]
) -> dict[str, FidelityEstimate]:
    """Estimates of one scene's fidelities, without the points at which its full model makes another motion."""
    expected = {
        name: {way: Motion.predicted(response, made[name].branches[way]) for way, response in branches[name].items()}
        for name in made
        if made[name].branches
    }
    if not expected:
        return dict(made)
    whole = next((n for n, each in made.items() if each.whole and case.fidelities[n].solver == "flight"), None)
    if whole is None:
        ways = [way for way, _ in branches[next(iter(expected))].items()]
        flown = _flown(case, next(iter(expected)), full, {way: [own[way] for own in expected.values()] for way in ways})
    else:
        flown = {way: Motion.of(response) for way, response in branches[whole].items()}
    return dict(made) | {
        name: replace(
            made[name],
            branches={
                way: without_another_motion(each, own[way], flown[way]) for way, each in made[name].branches.items()
            },
        )
        for name, own in expected.items()
    }


def _flown(case: Case, name: str, full: ImpactSystem, expected: Mapping[str, Sequence[Motion]]) -> Mapping[str, Motion]:
    """Motions of the full model of a fidelity's scene by direction, wherever some are expected."""
    if not any(each.known.any() for several in expected.values() for each in several):
        return {way: several[0] for way, several in expected.items()}
    omega = np.sort(2 * np.pi * case.sweep.frequency)
    sweep = FullSweep(full, float(omega[0]), case.sweep.settle, case.sweep.output)
    grids = {way: omega if way == "up" else omega[::-1] for way in expected}
    return {
        way: sweep.branch(grid, np.broadcast_to(case.amplitude_of(name, grid), grid.shape), expected[way])
        for way, grid in grids.items()
    }


def estimate_of_choice(
    case: Case, systems: Mapping[str, ImpactSystem], curves: Mapping[str, Curve]
) -> FidelityEstimate:  # fmt: skip
    """Estimate the error of a curve within an accuracy, each point with the model that gave it; see ``estimates``."""
    begun, chosen = time.thread_time(), {name for curve in curves.values() for name in curve.fidelity}
    try:
        models = {name: (systems[name], _full(case, name)) for name in sorted(chosen)}
    except ValueError as refusal:
        return FidelityEstimate(0, {}, str(refusal))
    if why := next(filter(None, (unsuited(system) for system, _ in models.values())), ""):
        return FidelityEstimate(0, {}, why)
    found = {way: _of_curve(case, models, curve) for way, curve in curves.items()}
    for names in _scenes(case, sorted(chosen)):
        own = {way: np.isin(curve.fidelity, names) for way, curve in curves.items()}
        expected = {way: Motion.predicted(curve.response, found[way]).only(own[way]) for way, curve in curves.items()}
        flown = _flown(case, names[0], models[names[0]][1], {way: [each] for way, each in expected.items()})
        found = {way: without_another_motion(each, expected[way], flown[way]) for way, each in found.items()}
    size = max(full.size for _, full in models.values())
    return FidelityEstimate(size, found, cpu_seconds=time.thread_time() - begun)


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
