"""Study of solvers (``vibeam verdict --only solvers``): error against CPU time of every fidelity and every solver."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from vibeam.case.case import Case, require_one_harmonic
from vibeam.case.fidelity import gap_drift, gap_wear
from vibeam.case.source import of_source
from vibeam.flight.engine.threads import Clock, OutOfTime, ending_at
from vibeam.solvers import SOLVERS
from vibeam.solvers.steady import warm_up_once
from vibeam.studies.cost.measure import FLIGHT, measured, settings_of
from vibeam.studies.cost.planning import (
    LeftOut,
    Outcome,
    SettingSeries,
    finest_model,
    frequencies,
    models,
    plan_of,
    run_in_turn,
)
from vibeam.studies.cost.row import RunRow, compared, front
from vibeam.system.curves import evenly
from vibeam.system.progress import telling
from vibeam.system.response import FrequencyResponse
from vibeam_models.arrays import Array, ValueRecord

SHARE = 0.01  # of the budget for a warm-up
EXACT = 0.5  # of the budget for the exact motions
Tell = Callable[[str], None]
Progress = Callable[[int, int], None]


@dataclass(frozen=True, eq=False, repr=False)
class CostStudy(ValueRecord):
    """Result of ``vibeam.cost``.

    ``finest``: the reference fidelity; ``same``: fidelities that are another's model; ``frequency`` in Hz, ``asked``:
    how many there would be with time for all; ``cpu``: seconds in all, ``budget``: those allowed.
    """

    title: str
    finest: str
    rows: tuple[RunRow, ...]
    left_out: tuple[LeftOut, ...]
    refused: tuple[LeftOut, ...]
    same: dict[str, str]
    frequency: tuple[float, ...]
    asked: int
    settle: int
    hold: int
    cpu: float
    budget: float

    @property
    def front(self) -> list[int]:
        """Pareto front: rows not beaten in both error and time, among those with a motion at every frequency."""
        whole = len(self.frequency)
        errors = [row.total.rms if row.found == whole else np.nan for row in self.rows]
        return front(list(zip(errors, [row.seconds for row in self.rows], strict=True)))


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
    """Error against CPU time: every fidelity by flight, the smallest and the finest by every solver, loose ones first.

    ``tell`` is called with the number of runs, ``progress`` with the runs done or left out, and all; True shows both.
    ``budget``: CPU seconds for all of it, None: those of ``[cost]``. A run that would take more than its share is given
    up; its row has the time that it used. Where the exact motions alone would take more than half of it, they are of
    fewer frequencies.
    ValueError for a fidelity that cannot be built, or whose gap changes during the sweep: no point then stands alone;
    and where the case's own frequencies (``cost.frequency``) take longer.

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
        return _CostRuns(case, said, told, clock, case.cost.budget if budget is None else budget).study()


class _CostRuns:
    """State of a study in progress."""

    def __init__(self, case: Case, tell: Tell, progress: Progress, clock: Clock, budget: float) -> None:
        self.case, self.clock, self.budget, self.progress = case, clock, budget, progress
        self.models, self.same = models(case)
        self.finest = finest_model(case, self.models)
        self.names = case.cost.solvers or tuple(SOLVERS)
        ordered = sorted(self.models, key=lambda model: model.system.size)  # solvers but flight: of the two ends alone
        every = [(model, name) for model in ordered for name in self.names]
        self.pairs = [each for each in every if each[1] == "flight" or each[0] in (ordered[0], self.finest)]
        runs = sum(len(settings_of(name, 1.0)) for _, name in self.pairs)
        self.done, self.total, count = 0, runs, len(self.models)
        tell(f"Solvers: up to {self.total} runs of {count} model{'s' * (count > 1)}")
        progress(0, self.total)

    def study(self) -> CostStudy:
        """Compute the exact motions, then all runs in turn."""
        begun, every = self.clock(), frequencies(self.case)
        self._warm(every)
        hertz = self._affordable(every)
        exact = self._exact(hertz, begun + self.budget)
        rows, left = list[RunRow](), list[LeftOut]()
        for outcome in run_in_turn(self._series(hertz, exact), begun + self.budget, self.clock):
            self._count(outcome)
            if isinstance(outcome, LeftOut):
                left.append(outcome)
            else:
                model, run = outcome
                rows.append(compared(model, run, exact))
        plan = plan_of(self.case, self.finest, hertz)
        refused, late = (tuple(each for each in left if each.refused is no) for no in (True, False))
        return CostStudy(
            self.case.title, self.finest.name, tuple(sorted(rows, key=self._order)), late, refused, self.same,
            tuple(hertz.tolist()), len(every), plan.settle, plan.hold, self.clock() - begun, self.budget,
        )  # fmt: skip

    def _count(self, outcome: Outcome) -> None:
        self.done += len(settings_of(outcome.run, 1.0)) if isinstance(outcome, LeftOut) and outcome.refused else 1
        self.progress(self.done, self.total)

    def _order(self, row: RunRow) -> tuple[int, int]:
        labels = [setting.label for name in SOLVERS for setting in settings_of(name, 1.0)]
        return [model.name for model in self.models].index(row.fidelity), labels.index(row.label)

    def _warm(self, hertz: Array) -> None:
        """Warm up flight, which all runs need, and all solvers, each on the smallest models that it takes."""
        settings = [FLIGHT, *(each for name in self.names for each in settings_of(name, 1.0))]
        for model in sorted(self.models, key=lambda model: model.system.size):
            plan = plan_of(self.case, model, hertz)
            place = float(plan.omega[0]), float(plan.amplitude[0])
            for each in settings:
                with suppress(ValueError, OutOfTime), ending_at(self.clock, self.clock() + SHARE * self.budget):
                    warm_up_once(each.solver, model.system, *place, plan.output, each.options)

    def _affordable(self, hertz: Array) -> Array:
        """Frequencies of which the exact motions take about half of the budget, by one of the finest fidelity."""
        if self.case.cost.frequency is not None:
            return hertz
        plan = plan_of(self.case, self.finest, hertz[len(hertz) // 2 :][:1], exact=True)
        one = measured(self.finest.system, FLIGHT, plan, self.clock)
        many = EXACT * self.budget / max(one.used, 1e-9)
        return hertz[evenly(0, len(hertz) - 1, max(int(min(many, len(hertz))), 1))]

    def _exact(self, hertz: Array, end: float) -> FrequencyResponse:
        """Exact motions of the finest model; ValueError where they take longer than the case's frequencies allow."""
        plan = plan_of(self.case, self.finest, hertz, exact=True)
        allowed = np.inf if self.case.cost.frequency is None else end - self.clock()
        run = measured(self.finest.system, FLIGHT, plan, self.clock, allowed)
        if not run.done:
            raise ValueError(
                f"the exact motions of {self.finest.name} at {len(hertz)} frequencies take more than {self.budget:g} s "
                "of CPU time: allow more (--budget), or ask for fewer (cost.frequency)"
            )
        return run.response

    def _series(self, hertz: Array, exact: FrequencyResponse) -> list[SettingSeries]:
        """Settings of every model and solver, the smallest model first: ``self.pairs``."""
        reach = exact.reach
        known = reach[np.isfinite(reach) & (reach > 0)]
        size = float(np.median(known)) if len(known) else 1.0
        plans = {model.name: plan_of(self.case, model, hertz) for model in self.models}
        return [SettingSeries(model, plans[model.name], tuple(settings_of(name, size))) for model, name in self.pairs]
