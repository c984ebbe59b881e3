"""Peaks of a case's fidelities with either restitution held, by closed forms of their motions."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from vibeam.case.case import Case
from vibeam.case.held import held_of, other_choice, with_other_choice
from vibeam.periodic.motions import closed_curve
from vibeam.runs.closed_motions import without_closed_forms
from vibeam.runs.comparison.differences import BothChoices, HeldComparison
from vibeam.system.curves import NAN
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import Branches

SAME = 0.01  # share by which the amplitude of a run and that of the closed form of its motion may differ
OTHER = "the peak of its run is that of another motion than one with at most one impact a drive period"


@dataclass(frozen=True)
class _Peaks:
    """Peaks of a model by closed forms, as held and with the other choice; ``why``: they are not known."""

    held: float = NAN
    other: float = NAN
    why: str = ""


def comparisons(
    case: Case, finest: Mapping[str, str], systems: Mapping[str, ImpactSystem], branches: Mapping[str, Branches]
) -> tuple[HeldComparison, ...]:
    """Comparisons of all fidelities with the ``finest`` of each, one for each of these that there is."""
    groups = {top: [name for name in finest if finest[name] == top != name] for top in dict.fromkeys(finest.values())}
    return tuple(_comparison(case, top, names, systems, branches) for top, names in groups.items() if names)


def _comparison(
    case: Case, top: str, names: list[str], systems: Mapping[str, ImpactSystem], branches: Mapping[str, Branches]
) -> HeldComparison:
    begun = time.thread_time()
    held = held_of(case.scene_of(top))
    other = other_choice(held)
    peaks = {
        name: _Peaks() if other is None else _peaks(case, name, systems[name], branches[name].peak.amplitude)
        for name in (top, *names)
    }
    rows = tuple(_row(name, branches[name].off(branches[top]).peak, peaks[name], peaks[top]) for name in names)
    return HeldComparison(top, held, other, rows, time.thread_time() - begun)


def _row(name: str, off: float, own: _Peaks, top: _Peaks) -> BothChoices:
    why = top.why or own.why
    return BothChoices(name, off, NAN if why else own.other / top.other - 1, why)


def _peaks(case: Case, name: str, system: ImpactSystem, run: float) -> _Peaks:
    """Peaks of one fidelity, whose run has the peak ``run``."""
    scene: Any = case.scene_of(name)
    omega = 2 * np.pi * np.sort(case.sweep.frequency)
    base = np.broadcast_to(np.asarray(case.amplitude_of(name, omega), dtype=float), omega.shape)
    why = _excluded(scene, system) or without_closed_forms(scene, omega)

    def peak(make: Callable[[], ImpactSystem]) -> float:
        return float(closed_curve(make(), omega, base, case.sweep.output).peak)

    try:
        if why:
            raise ValueError(why)
        held, other = peak(lambda: system), peak(lambda: with_other_choice(scene, system))
    except ValueError as refusal:
        return _Peaks(why=str(refusal))
    return _Peaks(held, other, "" if abs(held / run - 1) < SAME else OTHER)


def _excluded(scene: Any, system: ImpactSystem) -> str:
    """Reason why a model has no closed-form motions or no other choice; empty where it has both."""
    if scene.given_mode is not None:
        return "a single degree of freedom given directly has no more modes"
    if not system.beyond_plain:
        return ""
    features, law = " or ".join(system.beyond_plain), getattr(scene.stop, "law", None)
    if law is not None and system.law is not None:  # without loss hunt-crossley is hertz to the system
        features = features.replace(f'"{system.law.name}"', f'"{law.name}"')
    return f"closed forms are not known with {features}"
