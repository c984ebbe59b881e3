"""Models, frequencies and schedules of a study of solvers; the order of its runs within a budget."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from heapq import heappop, heappush

import numpy as np

from vibeam.case.case import Case
from vibeam.case.fidelity import Fidelity
from vibeam.case.fineness import fineness
from vibeam.flight.engine.threads import Clock
from vibeam.studies.cost.measure import Measurement, Plan, Setting
from vibeam.system.curves import evenly
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array

POINTS, SETTLE, HOLD = 9, 100, 10


@dataclass(frozen=True)
class CostModel:
    """Fidelity with its system."""

    name: str
    fidelity: Fidelity
    system: ImpactSystem


def models(case: Case) -> tuple[list[CostModel], dict[str, str]]:
    """Models in the case's order, and the model of each name that is another's: they differ in their solver alone."""
    found: list[CostModel] = []
    same: dict[str, str] = {}
    for name, fidelity in case.fidelities.items():
        new = CostModel(name, fidelity, case.system(name))
        twin = next((model for model in found if model.system == new.system), None)
        if twin is None:
            found.append(new)
        else:
            same[name] = twin.name
    return found, same


def finest_model(case: Case, found: Sequence[CostModel]) -> CostModel:
    """Finest CostModel, the first of several."""
    return max(found, key=lambda model: fineness(case, model.name, model.system.size))


def frequencies(case: Case) -> Array:
    """Frequencies (Hz) of the runs: those asked for, or nine of the sweep's, evenly spread."""
    if case.cost.frequency is not None:
        return np.array(case.cost.frequency)
    grid = np.sort(case.sweep.frequency)
    return np.asarray(grid[evenly(0, len(grid) - 1, POINTS)])


def plan_of(case: Case, model: CostModel, hertz: Array, exact: bool = False) -> Plan:
    """Plan of a model's runs; that of the ``exact`` one settles at least as long as the case's sweep."""
    sweep, asked, omega = case.sweep, case.cost, 2 * np.pi * hertz
    settle = min(sweep.settle, SETTLE) if asked.settle is None else asked.settle
    hold = min(sweep.hold, HOLD) if asked.hold is None else asked.hold
    base = np.broadcast_to(case.amplitude_of(model.name, omega), omega.shape)
    return Plan(omega, base, max(settle, sweep.settle) if exact else settle, hold, sweep.output)


@dataclass(frozen=True)
class LeftOut:
    """Run that did not take place, and why; ``refused``: the solver cannot take the model."""

    fidelity: str
    run: str
    why: str
    refused: bool = False


@dataclass(frozen=True)
class SettingSeries:
    """Settings of one solver on one model, loose to strict."""

    model: CostModel
    plan: Plan
    settings: tuple[Setting, ...]

    def begun(self, setting: Setting, clock: Clock) -> Measurement:
        """Measurement by one of the settings, nothing computed yet."""
        return Measurement(self.model.system, setting, self.plan, clock)

    def left_out(self, settings: Iterable[Setting], why: str) -> Iterator[LeftOut]:
        """Some of the settings, left out."""
        return (LeftOut(self.model.name, setting.label, why) for setting in settings)


Outcome = tuple[CostModel, Measurement] | LeftOut


def run_in_turn(series: Sequence[SettingSeries], end: float, clock: Clock) -> Iterator[Outcome]:
    """Run point by point, always the run that has used least, until ``end`` on the ``clock``.

    The first point of a run may take an equal share of the time that is left, at most half of it. A run whose point
    does not end in time is given up with what it has, and the settings of its method that are behind it are left out;
    all settings where it was the first of them. A setting counts as dear as the one before it.
    """
    heap = [(0.0, order, each.settings[1:], each.begun(each.settings[0], clock)) for order, each in enumerate(series)]
    while heap:
        _, order, rest, run = heappop(heap)
        own, left = series[order], end - clock()
        if left <= 0 and not run.used:
            yield from own.left_out((run.setting, *rest), "the time was up")
            continue
        try:
            goes_on = left > 0 and run.step(left if len(run) else left / (len(heap) + 2))
        except ValueError as refusal:
            yield LeftOut(own.model.name, run.setting.solver, str(refusal), refused=True)
            continue
        if goes_on and not run.done:
            heappush(heap, (run.used, order, rest, run))
            continue
        run.timed_again()
        yield own.model, run
        if not goes_on:
            first = run.setting == own.settings[0]
            behind = tuple(each for each in rest if first or each.method == run.setting.method)
            yield from own.left_out(behind, f"{run.setting.label} was given up before it")
            rest = tuple(each for each in rest if each not in behind)
        if rest:
            heappush(heap, (run.used, order, rest[1:], own.begun(rest[0], clock)))
