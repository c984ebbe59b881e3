"""Planning of the runs of a study: its models, frequencies, settling, drive, start of the path, order within a budget.

The models are the case's fidelities, and its finest one truncated to fewer modes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from heapq import heapify, heappop, heappush
from math import isfinite, nan
from typing import Any

import numpy as np

from vibeam.case.case import Case
from vibeam.case.fidelity import Fidelity, system
from vibeam.case.fineness import fineness
from vibeam.observe.restitution import first_mode_restitution
from vibeam.studies.cost.measure import Plan, Series, Setting, measure
from vibeam.studies.cost.reference import FLIGHT, curve
from vibeam.system.curves import evenly
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam_models.arrays import Array

COUNTS = (1, 2, 4, 8, 16, 32, 64)
CUT_SOLVERS = ("flight", "orbit")  # of a truncated model


@dataclass(frozen=True)
class CostModel:
    """Fidelity with its system; ``cut``: not in the case, truncated to show the effect of the number of modes.

    ``like``: the fidelity of the case whose scene it uses.
    """

    name: str
    fidelity: Fidelity
    system: ImpactSystem
    cut: bool = False
    like: str = ""


def models(case: Case, counts: tuple[int, ...] | None = None) -> tuple[list[CostModel], dict[str, str]]:
    """Models in the case's order, then truncated ones by ``counts`` of modes; and the model of each name.

    ``counts`` None: 1, 2, 4, 8 … below the finest fidelity's. Fidelities that differ in their solver alone are one
    model. ValueError for a fidelity that cannot be built.
    """
    found: list[CostModel] = []
    same: dict[str, str] = {}
    for name, fidelity in case.fidelities.items():
        _add(found, same, CostModel(name, fidelity, case.system(name), like=name))
    if case.scene.given_mode is not None:
        return found, same
    top = finest_model(case, found)
    for count in [n for n in COUNTS if n < top.system.size] if counts is None else counts:
        cut: dict[str, Any] = {"reduction": "modal", "modes": count, "parameters": {}}
        fidelity = replace(top.fidelity, name=f"modes_{count}", **cut)
        cut_off = system(case.scene_of(top.name), fidelity)
        _add(found, {}, CostModel(fidelity.name, fidelity, cut_off, True, top.name))
    return found, same


def finest_model(case: Case, found: list[CostModel]) -> CostModel:
    """Finest CostModel, the first of several."""
    return max(found, key=lambda model: fineness(case, model.like, model.system.size))


def _add(found: list[CostModel], same: dict[str, str], new: CostModel) -> None:
    twin = next((model for model in found if model.system == new.system), None)
    if twin is None:
        found.append(new)
    else:
        same[new.name] = twin.name


def first_mode_restitution_of(model: ImpactSystem) -> float:
    """First-mode restitution R₁; NaN where the law has no single coefficient."""
    return first_mode_restitution(model) if model.law is None else float("nan")


POINTS, SETTLE, HOLD, CLOUD, WINDOW = 9, 100, 10, 200, 10


class Planning:
    """Plans of a case, each made on first use; ``finest``: the model whose motion defines them."""

    def __init__(self, case: Case, finest: CostModel) -> None:
        self._case, self._finest = case, finest

    @cached_property
    def first(self) -> Plan:
        """Sweep alone, as the case asks for it."""
        sweep, asked = self._case.sweep, self._case.cost
        omega = 2 * np.pi * frequencies(self._case)
        settle = min(sweep.settle, SETTLE) if asked.settle is None else asked.settle
        hold = min(sweep.hold, HOLD) if asked.hold is None else asked.hold
        base = np.broadcast_to(self._case.amplitude(omega), omega.shape)
        return Plan(omega, base, settle, hold, sweep.output, 0, 0, 1.0, self._drive(float(omega[0])))

    def _drive(self, omega: float) -> Drive:
        return Drive(omega, float(np.ravel(self._case.amplitude(np.array([omega])))[0]))

    @cached_property
    def plan(self) -> Plan:
        """Common plan of all runs: the path is driven at the reference's peak and starts one swing from the stop."""
        response = measure(self._finest.system, FLIGHT, self.first).response
        reach, top = response.reach[np.isfinite(response.reach)], response.peak.frequency
        drive = self._drive(2 * np.pi * top) if np.isfinite(top) else self.first.drive
        size = float(np.median(reach)) if len(reach) else 0.0
        return replace(self.first, cloud=CLOUD, window=WINDOW, size=size if size > 0 else 1.0, drive=drive)

    @cached_property
    def long(self) -> Plan:
        """Plan with at least the case's own settling, for the exact runs."""
        return replace(self.plan, settle=max(self._case.sweep.settle, self.plan.settle))

    def of(self, model: CostModel, long: bool = False) -> Plan:
        """Plan, or the long one, with the drive of the model's own scene."""
        plan = self.long if long else self.plan
        if not self._case.scenes:
            return plan
        place = np.array([plan.drive.omega])
        base, alone = (self._case.amplitude_of(model.like, omega) for omega in (plan.omega, place))
        drive = Drive(plan.drive.omega, float(np.ravel(alone)[0]))
        return replace(plan, amplitude=np.broadcast_to(base, plan.omega.shape), drive=drive)


def frequencies(case: Case) -> Array:
    """Frequencies (Hz) of the runs: those asked for, or nine of the sweep's, evenly spread."""
    asked = case.cost
    if asked.frequency is not None:
        return np.array(asked.frequency)
    grid = np.sort(case.sweep.frequency)
    if asked.reference is not None:
        grid = np.array(sorted(f for f in curve(case) if grid[0] <= f <= grid[-1]))
        if not len(grid):
            raise ValueError(f"cost.reference: {asked.reference!r} has no point within the sweep")
    return np.asarray(grid[evenly(0, len(grid) - 1, POINTS)])


OVER = "over the whole budget"


@dataclass(frozen=True)
class RunSchedule:
    """Series of settings of one solver on one fidelity; ``estimate``: seconds of its first setting, maybe inf."""

    fidelity: str
    series: Series
    estimate: float


@dataclass(frozen=True)
class LeftOut:
    """Run that did not take place, and why; ``seconds`` that it would take, ∞ if over the budget, NaN unknown."""

    fidelity: str
    run: str
    why: str
    seconds: float = nan


Run = Callable[[str, Setting], float | None]


def run_schedule(schedules: Sequence[RunSchedule], left: Callable[[], float], run: Run) -> list[LeftOut]:
    """Run setting by setting, always the one estimated to be cheapest, while ``left()`` seconds allow it.

    ``run(fidelity, setting)`` gives the seconds it took, None where stricter settings are of no use. A
    setting's estimate is the cost of the one before it times its ``growth``. Returns the runs left out.
    """
    heap = [(schedule.estimate, order, 0, schedule) for order, schedule in enumerate(schedules)]
    heapify(heap)
    out: list[LeftOut] = []
    while heap:
        estimate, order, index, schedule = heappop(heap)
        settings = schedule.series[index:]
        if estimate > left():
            out += _left_out(schedule.fidelity, settings, estimate, max(left(), 0.0))
            continue
        seconds = run(schedule.fidelity, settings[0])
        if seconds is None:
            why = f"{settings[0].label} broke down before it"
            out += [LeftOut(schedule.fidelity, setting.label, why) for setting in settings[1:]]
        elif len(settings) > 1:
            heappush(heap, (seconds * settings[1].growth, order, index + 1, schedule))
    return out


def _left_out(fidelity: str, settings: Series, estimate: float, left: float) -> list[LeftOut]:
    out = []
    for index, setting in enumerate(settings):
        estimate *= setting.growth if index else 1.0
        why = f"about {estimate:.2g} s, with {left:.2g} s of the budget left" if isfinite(estimate) else OVER
        out.append(LeftOut(fidelity, setting.label, why, estimate))
    return out
