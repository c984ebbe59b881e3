"""Plan of a run: the branches of every fidelity, and the results file that keeps them."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path

import numpy as np

from vibeam.case.case import Case
from vibeam.case.plans import ResultNumber, ShowPlan
from vibeam.exchange.faults import suggest
from vibeam.runs.keys import branch_key, model_key
from vibeam.runs.result import output_units
from vibeam.runs.store.adaptation import Requirements
from vibeam.runs.store.branches import BranchPlan
from vibeam.runs.store.file import Store, opened
from vibeam.runs.store.records import Keyed
from vibeam.runs.systems import ModelProperties
from vibeam.store.place import Tell, warn
from vibeam.system.impact_system import ImpactSystem


def restricted(case: Case, names: Collection[str]) -> Case:
    """Case with these of its fidelities alone, and with the checks, measured numbers and figures of no others.

    ValueError for a name that it does not have.
    """
    for name in names:
        if name not in case.fidelities:
            raise ValueError(f"{name}: no such fidelity; {suggest(name, case.fidelities)}")
    if names and set(names) < set(case.fidelities):
        shows = {
            name: plan for name, each in case.shows.items() if (plan := _restricted_figure(each, names)).fidelities
        }

        def of(each: ResultNumber) -> bool:
            return {each.fidelity, each.against} <= {None, *names} and (each.show is None or each.show in shows)

        return replace(
            case,
            fidelities={name: each for name, each in case.fidelities.items() if name in names},
            references={name: each for name, each in case.references.items() if each.fidelity in names},
            expectations={name: each for name, each in case.expectations.items() if of(each)},
            measured={name: each for name, each in case.measured.items() if of(each)},
            shows=shows,
        )
    return case


def _restricted_figure(plan: ShowPlan, names: Collection[str]) -> ShowPlan:
    """Figure of these fidelities alone; its numbers are others then."""
    own = tuple(name for name in plan.fidelities if name in names)
    if own == plan.fidelities:
        return plan
    return replace(plan, fidelities=own, key=sha256(f"{plan.key} {own}".encode()).hexdigest())


@dataclass(frozen=True)
class RunPlan:
    """Branches of every fidelity; properties of their ``models`` where the file has them of this case and code."""

    branches: Mapping[str, tuple[BranchPlan, ...]]
    models: Mapping[str, ModelProperties]


def _plan(case: Case, systems: Mapping[str, ImpactSystem], stored: Keyed) -> RunPlan:
    """Plan of a run by what the file has ``stored`` of its models, else by their systems."""
    keys = {name: model_key(case, name) for name in case.fidelities}
    fit = all(key and stored.get(name, ("", None))[0] == key for name, key in keys.items())
    models = {name: stored[name][1] for name in keys} if fit else {}
    sizes = {name: models[name].modes if fit else systems[name].size for name in keys}
    return RunPlan({name: _branches(case, name, modes) for name, modes in sizes.items()}, models)


def _branches(case: Case, name: str, modes: int) -> tuple[BranchPlan, ...]:
    up = np.sort(case.sweep.frequency)
    grids = {"up": up, "down": up[::-1].copy()}
    wanted = ("up", "down") if case.sweep.direction == "both" else (case.sweep.direction,)
    keys = {direction: branch_key(case.own[name], direction, up, after_up=len(wanted) > 1) for direction in wanted}
    return tuple(BranchPlan(name, direction, grids[direction], modes, keys[direction]) for direction in wanted)


@contextmanager
def planned(
    case: Case, systems: Mapping[str, ImpactSystem], path: Path | None, fresh: bool, tell: Tell | None
) -> Iterator[tuple[Store | None, RunPlan]]:
    """Results file (None: nowhere) opened for all branches of the case, and the plan."""
    if path is None:
        yield None, _plan(case, systems, {})
        return

    def wanted(stored: Keyed) -> Requirements:
        branches = [each for several in _plan(case, systems, stored).branches.values() for each in several]
        return Requirements(
            case.numbers, case.key, case.shared, branches, case.text, case.path.name, output_units(case)
        )

    with opened(path, wanted, fresh=fresh, tell=tell or warn) as store:
        yield store, _plan(case, systems, store.models)
