"""Run of a case with an accuracy: one curve instead of one for each fidelity."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from hashlib import sha256
from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.fidelity import gap_drift, gap_wear
from vibeam.exchange.faults import CaseError
from vibeam.runs.accuracy.study import AccuracyChoice, study
from vibeam.runs.store.accuracy import HOME
from vibeam.runs.store.branch import Branch
from vibeam.runs.store.store import Store

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.plans import AccuracyPlan
    from vibeam.system.impact_system import ImpactSystem


def refuse_beyond(case: Case, systems: Mapping[str, ImpactSystem]) -> None:
    """Raise CaseError where the finest model has no closed-form motions."""
    reasons = {name: " or ".join(system.beyond_plain) for name, system in systems.items() if system.beyond_plain}
    omega = 2 * np.pi * case.sweep.frequency
    reasons |= {name: "a gap that drifts" for name in systems if gap_drift(case.scene_of(name), omega) is not None}
    reasons |= {name: "a stop that wears" for name in systems if gap_wear(case.scene_of(name)) is not None}
    if reasons:
        listed = "; ".join(f"{name} has {reason}" for name, reason in reasons.items())
        raise CaseError([case.fault("accuracy", message=f"cannot be had of {listed}: take this key away")])


def branches_of(case: Case, branches: Mapping[str, tuple[Branch, ...]]) -> tuple[Branch, ...]:
    """Branches of the result: as the finest fidelity's, under the name ``accuracy``."""
    widest = max(branches.values(), key=lambda several: several[0].modes)
    key = sha256(f"{HOME} {case.key}".encode()).hexdigest()
    return tuple(replace(branch, fidelity=HOME, key=key, carried=False) for branch in widest)


def found_or_made(
    case: Case, plan: AccuracyPlan, systems: Mapping[str, ImpactSystem], branches: tuple[Branch, ...],
    store: Store | None,
) -> tuple[AccuracyChoice, int]:  # fmt: skip
    """Study from the file or computed, and the number of its points from the file: all or none."""
    stored = store.study(branches) if store else None
    if stored is not None:
        return stored, stored.points
    refuse_beyond(case, systems)
    made = study(case, plan.within, plan.quantities, systems)
    if store:
        for branch in branches:
            store.write(branch, 0, made.curves[branch.direction].response, ())
        store.write_study(made)
    return made, 0
