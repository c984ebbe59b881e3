"""Cost study (``vibeam verdict --only solvers``): accuracy against time of a case, over fidelities and solvers."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from vibeam.case.case import Case, require_one_harmonic
from vibeam.case.fidelity import gap_drift, gap_wear, system, with_first_mode_restitution
from vibeam.case.source import of_source
from vibeam.flight.engine.threads import Clock, OutOfTime, ending_at
from vibeam.runs.comparison.differences import HeldComparison
from vibeam.runs.comparison.held_comparison import compared_model, held_comparison
from vibeam.solvers import SOLVERS, solver
from vibeam.solvers.steady import warm_up_once
from vibeam.studies.cost.measure import Measurement, Plan, Setting, measure, series_of
from vibeam.studies.cost.planning import (
    CUT_SOLVERS,
    CostModel,
    LeftOut,
    Planning,
    RunSchedule,
    finest_model,
    first_mode_restitution_of,
    models,
    run_schedule,
)
from vibeam.studies.cost.reference import FLIGHT, Bound, bound, given
from vibeam.studies.cost.row import RunRow, Split, Work, compared, front, run_row, split, timed
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.progress import telling
from vibeam.system.response import FrequencyResponse
from vibeam_models.arrays import ValueRecord

PROBE = 2  # drive periods from which the cost of a first setting is estimated
SHARE = 0.01  # share of the budget for repeats of a run, and for a warm-up
STIFF = 1e-5  # seconds, at least, that scipy's solvers take for a radian of the fastest mode
FLIGHTS = 3  # of each model, all exact: settled, and two for the parts of its error
Tell = Callable[[str], None]
Progress = Callable[[int, int], None]


@dataclass(frozen=True, eq=False, repr=False)
class CostStudy(ValueRecord):
    """Result of ``vibeam.cost``.

    ``finest``: the reference fidelity, its solver error ``bound``; ``comparison``: with either restitution held, and
    the finest's distance from its own limit. ``reference``: the file that replaces the finest, None without one;
    ``same``: fidelities that are another's model; ``frequency`` in Hz, ``cpu``: seconds in all, ``budget``: those
    allowed.
    """

    title: str
    finest: str
    reference: str | None
    bound: Bound
    rows: tuple[RunRow, ...]
    splits: tuple[Split, ...]
    comparison: HeldComparison
    left_out: tuple[LeftOut, ...]
    refused: tuple[LeftOut, ...]
    same: dict[str, str]
    frequency: tuple[float, ...]
    settle: int
    hold: int
    cpu: float
    budget: float

    @property
    def truth(self) -> str:
        """Reference of the errors, in words."""
        return f"reference {self.reference}" if self.reference else f"{self.finest}, exact"

    @property
    def front(self) -> list[int]:
        """Pareto front: rows not beaten in both error and time, among those with a motion at every frequency."""
        whole = len(self.frequency)
        errors = [row.total.amplitude.rms if row.found == whole else np.nan for row in self.rows]
        seconds = [row.work.cpu_min if row.work else np.nan for row in self.rows]
        return front(list(zip(errors, seconds, strict=True)))


def _gap_changes(case: Case, name: str) -> bool:
    scene = case.scene_of(name)
    return gap_wear(scene) is not None or gap_drift(scene, 2 * np.pi * case.sweep.frequency) is not None


@of_source
def cost(
    case: Case,
    tell: Tell | None = None,
    progress: Progress | bool | None = None,
    clock: Clock = time.thread_time,
    budget: float | None = None,
) -> CostStudy:
    """Run all settings within the budget and compare them.

    ``tell`` is called with the time that it may take, ``progress`` with the runs done or left out, and all; True shows
    both. ``budget``: CPU seconds for all of it, in place of those that ``[cost]`` allows after the exact motions, which
    are flown then.
    ValueError for a fidelity that cannot be built, or whose gap changes during the sweep: no point then stands alone;
    and where the exact motions alone would take longer than ``budget``.

    >>> import vibeam
    >>> study = vibeam.cost("cases/sdof_nominal.toml", budget=0.3)
    >>> study.finest
    'sdof'
    """
    require_one_harmonic(case, "the cost study")
    moving = [name for name in case.fidelities if _gap_changes(case, name)]
    if moving:
        names = ", ".join(moving)
        raise ValueError(f"fidelity {names}: the gap changes along the sweep (drift or wear), no point stands alone")
    with telling(progress, "cost") as told:
        said: Any = told if progress is True else tell or (lambda line: None)
        return _CostRuns(case, said, told, clock, budget).study()


class _CostRuns:
    """State of a study in progress."""

    def __init__(self, case: Case, tell: Tell, progress: Progress, clock: Clock, budget: float | None) -> None:
        self.case, self.asked, self.clock = case, case.cost, clock
        self.tell, self.progress = tell, progress
        self.all_in, self.budget = budget is not None, case.cost.budget if budget is None else budget
        self.models, self.same = models(case, self.asked.modes)
        self.finest = finest_model(case, self.models)
        self.named = {model.name: model for model in self.models}
        names = self.asked.solvers or SOLVERS
        self.pairs = [(model, name) for model in self.models for name in names if not model.cut or name in CUT_SOLVERS]
        self.done, self.total = 0, len(self.models) + sum(_settings(name) for _, name in self.pairs)
        self.rows: list[RunRow] = []
        self.refused: list[LeftOut] = []
        self.planning = Planning(case, self.finest)
        self.warm()
        self.began = self.ready = clock()

    def warm(self) -> None:
        """Warm up flight, which all runs need, and all solvers, each on the smallest models that it takes."""
        plan = self.planning.first
        solvers = [series[0] for name in self.asked.solvers or SOLVERS for series in series_of(name, 1.0)]
        for model in sorted(self.models, key=lambda model: model.system.size):
            for each in (FLIGHT, *solvers):
                deadline = self.clock() + SHARE * self.budget
                with suppress(ValueError, OutOfTime), ending_at(self.clock, deadline):
                    place = float(plan.omega[0]), float(plan.amplitude[0])
                    warm_up_once(each.solver, model.system, *place, plan.output, each.options)

    def study(self) -> CostStudy:
        """Run in order: exact motions, their bound, the parts of modelling, then the settings."""
        self.progress(0, self.total)
        plan = self.planning.plan
        self._predict(self.clock() - self.began)
        self.exact = {model.name: self._exact(model) for model in self.models}
        top = self.exact[self.finest.name][0]
        hertz = plan.omega / (2 * np.pi)
        self.file = None if self.asked.reference is None else given(self.case, hertz)
        self.truth = top if self.file is None else Measurement(self.file)
        allowed = max(self._left() / 2, 0.0) if self.all_in else self.budget
        bounded = bound(self.finest.system, top, self.planning.long, self.clock, allowed)
        splits = tuple(self._split(model) for model in self.models)
        schedules = self._schedules()
        self.ready = self.began if self.all_in else self.clock()
        left_out = run_schedule(schedules, self._left, self._run_setting)
        self._count(self.total - self.done)
        order = {model.name: index for index, model in enumerate(self.models)}
        labels = [setting.label for name in SOLVERS for series in series_of(name, 1.0) for setting in series]
        rows = sorted(self.rows, key=lambda row: (order[row.fidelity], labels.index(row.label)))
        grid = tuple(float(each) for each in hertz)
        spent = self.clock() - self.began
        return CostStudy(
            self.case.title, self.finest.name, self.asked.reference, bounded, tuple(rows), splits, self._compared(),
            tuple(left_out), tuple(self.refused), self.same, grid, plan.settle, plan.hold, spent, self.budget,
        )  # fmt: skip

    def _predict(self, seconds: float) -> None:
        """Say how long the study may take; ``seconds``: of one flight of the finest model, as long as the runs."""
        exact, count = FLIGHTS * len(self.models) * seconds, len(self.models)
        models = f"{count} model{'s' * (count > 1)}"
        if self.all_in and exact > self.budget:
            raise ValueError(
                f"the exact motions of {models} alone take about {exact:.2g} s of CPU time, and {self.budget:g} s are "
                "allowed: allow more (--budget), or ask for fewer frequencies (cost.frequency)"
            )
        self.tell(f"Solvers: up to {self.total} runs of {models}")

    def _count(self, runs: int = 1) -> None:
        self.done += runs
        self.progress(self.done, self.total)

    def _compared(self) -> HeldComparison:
        """All models with the finest, with either restitution held."""
        made = [compared_model(self.case, each.name, each.system, like=each.like) for each in self.models]
        own = self.models.index(self.finest)
        return held_comparison(made[own], [*made[:own], *made[own + 1 :]])

    def _left(self) -> float:
        """Seconds left of the budget, which begins after the exact motions that every study needs, or with them."""
        return self.budget - (self.clock() - self.ready)

    def _exact(self, model: CostModel) -> tuple[Measurement, Work]:
        found = self._timed(model.system, FLIGHT, self.planning.of(model, long=True), np.inf)
        self._count()
        return found

    def _timed(self, system: ImpactSystem, setting: Setting, plan: Plan, deadline: float) -> tuple[Measurement, Work]:
        run = lambda: measure(system, setting, plan, self.clock, deadline)  # noqa: E731
        return timed(run, self.clock, self.asked.repeats, SHARE * self.budget)

    def _split(self, model: CostModel) -> Split:
        """Split of a model's error: its own motion, that with the finest's R₁, its reduction too, the finest's."""
        own, work = self.exact[model.name]
        chain, why, top = [own.response], "", self.exact[self.finest.name][0].response
        try:
            chain.append(own.response if model is self.finest else self._flown(model, self._as_finest(model.system)))
        except ValueError as refusal:
            chain, why = [own.response] * 2, str(refusal)
        chain += [self._reduced_alike(model, top), top, *([] if self.file is None else [self.file])]
        return split(model, chain, why, work.cpu_min)

    def _as_finest(self, system: ImpactSystem) -> ImpactSystem:
        """System with the R₁ of the finest model; ValueError where no R gives that."""
        return with_first_mode_restitution(system, first_mode_restitution_of(self.finest.system))

    def _flown(self, model: CostModel, system: ImpactSystem) -> FrequencyResponse:
        return measure(system, FLIGHT, replace(self.planning.of(model, long=True), window=0)).response

    def _reduced_alike(self, model: CostModel, top: FrequencyResponse) -> FrequencyResponse:
        """Response with the finest's reduction and R₁, the model's own effects; ``top``, the finest's, without such."""
        kept = {name: getattr(self.finest.fidelity, name) for name in ("reduction", "modes", "parameters")}
        alike, own = self.finest.system, self.finest.system.restitution
        if model is not self.finest:
            alike = system(self.case.scene_of(model.like), replace(model.fidelity, **kept))
        try:
            alike = self._as_finest(alike)
        except ValueError:
            alike = replace(alike, restitution=own)
        return top if replace(alike, restitution=own) == self.finest.system else self._flown(model, alike)

    def _schedules(self) -> list[RunSchedule]:
        """Series of settings of every fidelity and solver; refusals are noted."""
        schedules = []
        for model, name in self.pairs:
            try:
                for series in series_of(name, self.planning.plan.size):
                    schedules.append(RunSchedule(model.name, series, self._estimate(model, series[0])))
            except ValueError as refusal:
                self.refused.append(LeftOut(model.name, name, str(refusal)))
                self._count(_settings(name))
        return schedules

    def _estimate(self, model: CostModel, setting: Setting) -> float:
        """Estimated seconds of a run: known for flight, extrapolated from two periods for others.

        Infinite where these take so long that all cannot fit into the budget.
        """
        if setting.solver == "flight":
            return self.exact[model.name][1].cpu_min
        plan = self.planning.of(model)
        least = STIFF * float(np.max(model.system.omega)) * float(np.sum(2 * np.pi / plan.omega))
        if setting.solver == "direct" and least * (plan.settle + plan.hold) > self.budget:
            solver(setting.solver, model.system, float(np.min(plan.omega)), **setting.options)  # or its refusal
            return least * (plan.settle + plan.hold)  # two periods are too short to be measured
        short = replace(plan.at(len(plan.omega) // 2), settle=0, hold=PROBE, cloud=0, window=0)
        times = 1 if SOLVERS[setting.solver].stationary else (plan.settle + plan.hold) / PROBE
        times *= len(plan.omega)
        begun = self.clock()
        try:
            measure(model.system, setting, short, self.clock, begun + self.budget / times)
        except OutOfTime:
            return np.inf
        return (self.clock() - begun) * times

    def _run_setting(self, fidelity: str, setting: Setting) -> float | None:
        """Run one setting and add its row; return its seconds, or None where stricter settings are of no use."""
        model = self.named[fidelity]
        self._count()
        try:
            found, work = self._timed(model.system, setting, self.planning.of(model), self.ready + self.budget)
        except OutOfTime as up:
            self.rows.append(run_row(model, setting, why=str(up)))
            return None
        truths = self.exact[fidelity][0], self.truth
        self.rows.append(compared(model, setting, self.planning.plan, found, work, truths))
        return work.cpu_median


def _settings(solver: str) -> int:
    return sum(len(series) for series in series_of(solver, 1.0))
