"""Comparison of a case's fidelities with either restitution held, beside the finest one's own limit."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.case.case import Case
from vibeam.case.held import held_of, other_choice, with_other_choice
from vibeam.periodic.motions import ClosedCurve, closed_curve
from vibeam.runs.closed_motions import without_closed_forms
from vibeam.runs.comparison.differences import BothChoices, HeldComparison, OwnLimit
from vibeam.runs.comparison.limit import GIVEN, limit
from vibeam.system.curves import NAN, Difference
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import Branches, periodic
from vibeam_models.arrays import Array
from vibeam_models.scene import RigScene

SAME = 0.01  # share by which the amplitude of a run and that of the closed form of its motion may differ
SURE = 1e-4  # differences smaller than this share have no sign
SMALL = 0.1  # largest share of a difference that the finest's distance from its limit may be


@dataclass(frozen=True)
class ComparedModel:
    """Model of a comparison: its ``system`` and ``scene`` over ``omega`` (points,) rad/s, under ``base`` (points,) m.

    ``run``: its branches, by which its motions are told apart; None where it was not run. ``why``: a reason
    that excludes closed forms beside those of the system.
    """

    name: str
    scene: Any
    system: ImpactSystem
    omega: Array
    base: Array
    output: str
    run: Branches | None = None
    why: str = ""


Closed = ClosedCurve | str  #: or the reason why there is none


def held_comparison(
    finest: ComparedModel, others: Iterable[ComparedModel], other_physics: bool = False
) -> HeldComparison:
    """Compare ``others`` with ``finest`` by closed-form motions, at a few frequencies and at the peaks.

    ``other_physics``: they have limits of their own, so that only the difference of two distances is uncertain.
    """
    begun = time.thread_time()
    held = held_of(finest.scene)
    here, there = _both(finest)
    own = _own_limit(finest, here, there)
    rows = tuple(_row(model, finest, (here, there), own, other_physics) for model in others)
    return HeldComparison(finest.name, held, other_choice(held), rows, own, time.thread_time() - begun)


def _both(model: ComparedModel) -> tuple[Closed, Closed]:
    """Closed-form curves of a model as held and with the other choice."""
    if why := _excluded(model):
        return why, why
    return _curve(model, lambda: model.system), _curve(model, lambda: with_other_choice(model.scene, model.system))


def _excluded(model: ComparedModel) -> str:
    """Reason why a model has no closed-form motions or no other choice; empty where it has both."""
    if model.scene.given_mode is not None:
        return "a single degree of freedom given directly has no more modes"
    if model.system.beyond_plain:
        features, law = " or ".join(model.system.beyond_plain), getattr(model.scene.stop, "law", None)
        if law is not None and model.system.law is not None:  # without loss hunt-crossley is hertz to the system
            features = features.replace(f'"{model.system.law.name}"', f'"{law.name}"')
        return f"its limit is computed in closed form alone, not with {features}"
    return model.why


def _curve(model: ComparedModel, make: Callable[[], ImpactSystem]) -> Closed:
    """Closed-form curve of a model's system as it is made, or the reason why it cannot be."""
    try:
        return closed_curve(make(), model.omega, model.base, model.output)
    except ValueError as refusal:
        return str(refusal)


def _own_limit(finest: ComparedModel, here: Closed, there: Closed) -> OwnLimit:
    scene = finest.scene
    if isinstance(here, str):
        return OwnLimit(why=GIVEN if isinstance(scene, RigScene) and not scene.all_modes else here)
    try:
        own = limit(scene, finest.system.size)
    except ValueError as refusal:
        return OwnLimit(why=str(refusal))
    kinds = _kinds(finest, here)
    if not kinds.any():
        return OwnLimit(why="no motion with at most one impact a drive period, and no other has a closed form")
    choices = ("contact", "first mode")
    held, other = choices if scene.stop.restitution_of == "contact" else choices[::-1]
    by_limit, by_other = (_curve(finest, partial(own.holding, scene, choice)) for choice in (held, other))
    distance = _difference(here, by_limit, kinds)
    if _peak_fault(finest, here):
        distance = replace(distance, peak=NAN)
    why = by_limit if isinstance(by_limit, str) else ""
    return OwnLimit(distance, _difference(there, by_other), own.modes, own.elements, why)


def _kinds(model: ComparedModel, closed: ClosedCurve) -> NDArray[np.bool_]:
    """Mask (points, kinds) of the closed-form motions that a run has; all of them where there was no run."""
    if model.run is None:
        return np.isfinite(closed.amplitude)
    seen = np.zeros(closed.amplitude.shape, dtype=bool)
    for _, response in model.run.items():
        run = np.where(periodic(response), response.amplitude, np.nan)[np.argsort(response.frequency)]
        seen |= np.abs(closed.amplitude / run[closed.which, None] - 1) < SAME
    return seen


def _difference(one: Closed, other: Closed, kinds: NDArray[np.bool_] | None = None) -> Difference:
    """Difference of ``one`` over ``other`` where both have motions of the same kind."""
    if isinstance(one, str) or isinstance(other, str):
        return Difference()
    counted = np.isfinite(one.amplitude) if kinds is None else kinds
    values = (one.amplitude / other.amplitude - 1)[counted & np.isfinite(other.amplitude)]
    return Difference.of(values, int(np.count_nonzero(counted)), one.peak / other.peak - 1)


def _row(
    model: ComparedModel, finest: ComparedModel, top: tuple[Closed, Closed], own: OwnLimit, other_physics: bool
) -> BothChoices:
    here, there = _both(model)
    held = _difference(here, top[0], None if isinstance(here, str) else _kinds(model, here))
    if model.run and finest.run:
        held = replace(held, peak=model.run.off(finest.run).peak)
    why = next((each for each in (*top, here, there) if isinstance(each, str)), "")
    why = why or _peak_fault(finest, top[0]) or _peak_fault(model, here)
    other = _difference(there, top[1])
    other = replace(other, peak=NAN) if why else other
    of_model = _own_limit(model, here, there) if other_physics else OwnLimit(held=AT_LIMIT, other=AT_LIMIT)
    margins = _margin(held, own.held, of_model.held), _margin(other, own.other, of_model.other)
    turns = _sign(held.peak, margins[0]) * _sign(other.peak, margins[1]) < 0
    small = not margins[0] > SMALL * abs(held.peak if isfinite(held.peak) else held.rms)
    return BothChoices(model.name, held, other, margins, turns, small, why)


AT_LIMIT = Difference(0.0, 0.0, 0.0)


def _margin(difference: Difference, finest: Difference, model: Difference) -> float:
    """Change of a difference where both models go to their limits, a model without one of its own staying as it is."""
    for off, one, other in ((getattr(each, name) for each in (difference, finest, model)) for name in ("peak", "rms")):
        if isfinite(off) and isfinite(one) and isfinite(other):
            return float(abs((1 + off) * (1 + one) / (1 + other) - 1 - off))
    return NAN


def _sign(difference: float, margin: float) -> int:
    """Sign of a difference that is larger than its uncertainty; else 0."""
    return int(np.sign(difference)) if abs(difference) > max(SURE, margin if isfinite(margin) else 0.0) else 0


def _peak_fault(model: ComparedModel, closed: Closed) -> str:
    """Reason why the peak of a model's run is not that of its closed forms; empty where it is."""
    if isinstance(closed, str) or not model.run or abs(closed.peak / model.run.peak.amplitude - 1) < SAME:
        return ""
    return f"the peak of {model.name} is not that of an exact motion with one impact a drive period"


def comparisons(
    case: Case, finest: Mapping[str, str], systems: Mapping[str, ImpactSystem], branches: Mapping[str, Branches]
) -> tuple[HeldComparison, ...]:
    """Compare every fidelity with its ``finest``; those compared with none are left out, and cost nothing.

    ``branches``: of the fidelities that were run.
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
    return ComparedModel(
        name, scene, system, omega, base, case.sweep.output, branches, without_closed_forms(scene, omega)
    )  # fmt: skip
