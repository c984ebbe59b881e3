"""Error estimates of a case's fidelities against the full models of their own scenes: all modes, same restitution.

Where the run has the full model itself, errors are the differences from it. Elsewhere it is swept too, where that takes
no longer than a few seconds: points at which it makes another motion than that of the reduced model have no estimate
(``full_sweep``).
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields, replace

import numpy as np

from vibeam.case.case import Case
from vibeam.case.fidelity import Fidelity, gap_drift, gap_wear, system
from vibeam.periodic.motions import unsuited
from vibeam.runs.closed_motions import SEVERAL
from vibeam.runs.estimate.by_orbits import looked_at
from vibeam.runs.estimate.error import estimate_error
from vibeam.runs.estimate.full_sweep import FullSweep, Motion, without_another_motion
from vibeam.runs.estimate.records import MANY, Basis, ErrorEstimate, FidelityEstimate, difference
from vibeam.runs.estimate.work import LEAST, SHARE, CountedWork, TooDear, work_of
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import Branches, join, modes_of
from vibeam.system.state import StatesAfter
from vibeam_models.beam import structure_of
from vibeam_models.scene import AnyScene, RigScene

LARGEST = 1500  # coordinates of a structure all of whose modes are computed

DEAR = "flights of the full model, of {} modes, take too long beside the run's own"
SWEPT = 3.0  # times the work that is known before, a full model's sweep may take
WEARS = "each impact widens the gap, so that no motion repeats"


def without_orbits(scene: AnyScene) -> str:
    """Reason why motions of a scene's models are not carried over to the full one; empty where they are."""
    return SEVERAL if scene.harmonics else WEARS if gap_wear(scene) is not None else ""


def full_model(scene: AnyScene) -> ImpactSystem:
    """Impact system with all modes of a scene; ValueError says why no periodic motions of it are known.

    Of a solid, or of very many coordinates, ``MANY`` modes, the contact's residual flexibility among them, stand for
    all.
    """
    if why := without_orbits(scene):
        raise ValueError(why)
    if scene.given_mode is not None or not isinstance(scene, RigScene):
        raise ValueError("a single degree of freedom given directly has no fuller model")
    if not scene.all_modes:
        raise ValueError("the case gives a few modes, and no structure that has more")
    if _is_large(scene):
        return system(scene, Fidelity("full model", "residual_flexibility", modes=MANY))
    return system(scene, Fidelity("full model", "full"))


def _is_large(scene: AnyScene) -> bool:
    return scene.in_three_dimensions or structure_of(scene).size > LARGEST


def estimates(
    case: Case, systems: Mapping[str, ImpactSystem], branches: Mapping[str, Branches],
    after: Mapping[str, Mapping[str, StatesAfter]],
) -> dict[str, FidelityEstimate]:  # fmt: skip
    """Estimate the error of every fidelity; ``after``: states after the points of each branch.

    The full model of a scene is made once for all fidelities of that scene, and flown once: see ``FullSweep``. Orbits
    take about as much work as the sweeps did, each fidelity its part.
    """
    found: dict[str, FidelityEstimate] = {}
    most = max(LEAST, SHARE * sum(work_of(systems[name], each) for name, each in branches.items()))
    shares = {name: CountedWork(most / len(branches)) for name in branches}
    for names in _scenes(case, branches):
        begun, scene = time.thread_time(), case.scene_of(names[0])
        if whole := next((name for name in names if _is_whole(case, name, systems[name])), ""):
            found |= {name: _beside_run(branches[name], branches[whole], systems[name].size) for name in names}
            continue
        try:
            full = full_model(scene)
        except ValueError as refusal:
            found |= dict.fromkeys(names, FidelityEstimate(0, {}, str(refusal)))
            continue
        made = {
            name: _estimate(case, name, (systems[name], full), branches[name], after.get(name, {}), shares[name])
            for name in names
        }
        left = sum(shares[name].most - shares[name].spent for name in names)
        made |= _of_own_motions(case, full, made, branches, left)
        each = (time.thread_time() - begun) / len(names)
        short = full.size == MANY and _is_large(scene)
        found |= {name: replace(one, cpu_seconds=each, short=short) for name, one in made.items()}
    return {name: found[name] for name in branches}


def _is_whole(case: Case, name: str, system: ImpactSystem) -> bool:
    """Test whether a fidelity is the full model of its scene, and computed exactly."""
    scene, own = case.scene_of(name), case.fidelities[name]
    if own.solver != "flight" or not (isinstance(scene, RigScene) and scene.all_modes):
        return False
    return own.reduction == "full" or (not _is_large(scene) and system.size >= structure_of(scene).size)


def _beside_run(own: Branches, whole: Branches, modes: int) -> FidelityEstimate:
    """Errors against the run of the full model, itself among those that are judged."""
    if modes == modes_of(whole):
        return FidelityEstimate(modes, {}, whole=True)
    full = dict(whole.items())
    return FidelityEstimate(modes_of(whole), {way: difference(each, full[way]) for way, each in own.items()})


def _scenes(case: Case, names: Iterable[str]) -> list[list[str]]:
    """Fidelities by scene: those whose changes to the case's own are the same, and solids apart from beams."""
    groups: dict[str, list[str]] = {}
    for name in names:
        own = case.fidelities[name]
        groups.setdefault(repr((own.changes, own.without, case.scene_of(name).in_three_dimensions)), []).append(name)
    return list(groups.values())


def _estimate(
    case: Case, name: str, models: tuple[ImpactSystem, ImpactSystem], branches: Branches,
    after: Mapping[str, StatesAfter], work: CountedWork,
) -> FidelityEstimate:  # fmt: skip
    system, full = models
    if system.size == full.size:
        return FidelityEstimate(full.size, {}, whole=True)
    found = _of_branches(case, name, models, branches, after, work)
    dear = any((each.basis == Basis.DEAR.code).any() for each in found.values())
    if dear and not any(each.impacting.any() for each in found.values()):
        return FidelityEstimate(full.size, {}, DEAR.format(full.size))
    return FidelityEstimate(full.size, found)


def _of_branches(
    case: Case, name: str, models: tuple[ImpactSystem, ImpactSystem], branches: Branches,
    after: Mapping[str, StatesAfter], work: CountedWork,
) -> dict[str, ErrorEstimate]:  # fmt: skip
    """Both directions at once: what they have in common is computed once."""
    system, full = models
    parts = dict(branches.items())
    response = join(list(parts.values()))
    known = [after.get(way) or StatesAfter.unknown(len(part), system.size) for way, part in parts.items()]
    states = StatesAfter(*(np.concatenate([getattr(each, f.name) for each in known]) for f in fields(StatesAfter)))
    amplitude = case.amplitude_of(name, 2 * np.pi * response.frequency)
    points = np.concatenate([looked_at(part) for part in parts.values()])
    drift = gap_drift(case.scene_of(name), 2 * np.pi * response.frequency)
    whole = estimate_error(response, system, full, amplitude, case.sweep.output, states, points, drift, work)
    ends = np.cumsum([len(part) for part in parts.values()])[:-1]
    pieces = {field.name: np.split(getattr(whole, field.name), ends) for field in fields(ErrorEstimate)}
    return {way: ErrorEstimate(**{name: pieces[name][i] for name in pieces}) for i, way in enumerate(parts)}


def _of_own_motions(
    case: Case, full: ImpactSystem, made: Mapping[str, FidelityEstimate], branches: Mapping[str, Branches], left: float
) -> dict[str, FidelityEstimate]:
    """Estimates of one scene's fidelities that have any, without points at which its full model makes another motion.

    Its sweep may take the work ``left``.
    """
    plain = not unsuited(full)
    expected = {
        name: {way: Motion.predicted(response, each.branches[way], plain) for way, response in branches[name].items()}
        for name, each in made.items()
        if each.branches
    }
    if not expected:
        return {}
    first, *_ = expected
    flown = _flown(case, first, full, {way: [own[way] for own in expected.values()] for way in expected[first]}, left)
    found = {}
    for name, own in expected.items():
        parts = made[name].branches
        kept = {way: without_another_motion(parts[way], own[way], there) for way, there in flown.items()}
        found[name] = replace(made[name], branches=kept or parts, swept=bool(flown))
    return found


def _flown(
    case: Case, name: str, full: ImpactSystem, expected: Mapping[str, Sequence[Motion]], left: float
) -> Mapping[str, Motion]:
    """Motions of the full model of a fidelity's scene by direction, wherever some are expected.

    Empty where the sweep costs too much, or the gap changes along it.
    """
    if not any(each.known.any() for several in expected.values() for each in several):
        return {way: several[0] for way, several in expected.items()}
    omega = np.sort(2 * np.pi * case.sweep.frequency)
    base = np.broadcast_to(np.asarray(case.amplitude_of(name, omega), dtype=float), omega.shape)
    limited = bool(unsuited(full))
    work, middle, points = CountedWork(left if limited else float("inf")), len(omega) // 2, len(omega) * len(expected)
    sweep = FullSweep(full, float(omega[0]), case.sweep.settle, case.sweep.output, work)
    drifts = gap_drift(case.scene_of(name), omega) is not None
    if drifts or (limited and sweep.work(omega[middle], float(base[middle]), points) > left / SWEPT):
        return {}
    legs = {way: slice(None) if way == "up" else slice(None, None, -1) for way in expected}
    try:
        return {way: sweep.branch(omega[leg], base[leg], expected[way]) for way, leg in legs.items()}
    except TooDear:
        return {}
