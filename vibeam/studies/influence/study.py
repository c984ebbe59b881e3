"""Influence study (``vibeam verdict --only effects``): changes and cost of each effect, and the effects needed."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from math import inf, nan
from typing import Any

import numpy as np

from vibeam.case.case import Case, require_displacement
from vibeam.case.source import of_source
from vibeam.flight.engine.threads import Clock
from vibeam.runs.comparison.differences import HeldComparison
from vibeam.runs.comparison.held_comparison import ComparedModel, compared_model, held_comparison
from vibeam.solvers.steady import warm_up_once
from vibeam.studies.influence.curve import Change, Interest, change, quantities, swept
from vibeam.studies.influence.model import EffectModel, model
from vibeam.studies.influence.subsets import Subsets, smallest, subsets
from vibeam.system.progress import telling
from vibeam_models.arrays import ValueRecord

Tell = Callable[[str], None]
Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class Variant:
    """Model and its distance from the complete one; ``cpu``: s of its sweep, least of the repeats (NaN: not timed).

    ``why``: the reason where the model cannot be built.
    """

    kept: tuple[str, ...]
    changes: tuple[Change, ...]
    coordinates: int
    frequencies: tuple[float, ...]
    cpu: float = nan
    why: str = ""

    @property
    def modes(self) -> int:
        """Number of swept modes."""
        return len(self.frequencies)

    @property
    def worst(self) -> float:
        """Largest change in units of its tolerance; ∞ where the model cannot be built."""
        return float("inf") if self.why else max((each.share for each in self.changes), default=0.0)


@dataclass(frozen=True)
class EffectRow:
    """One effect: the models without it alone and with it alone; its CPU cost in s (negative: it saves)."""

    effect: str
    without: Variant
    alone: Variant
    coordinates: int
    modes: int
    cpu: float
    needed: bool

    @property
    def influence(self) -> float:
        """Largest change on removing the effect, in units of its tolerance."""
        return self.without.worst


@dataclass(frozen=True, eq=False, repr=False)
class InfluenceStudy(ValueRecord):
    """Result of ``vibeam.influence``; ``rows`` sorted by influence, the largest first.

    ``comparison``: of the complete model with those without one effect, with either restitution held, and its distance
    from its own limit. ``whole``, ``bare`` and ``enough``: the models with all effects, with none and with the smallest
    set; ``exact``: True where all sets were tried; ``models``: number of sweeps; ``scatter``: s by which repeats of a
    sweep's CPU time differed at most, below which a difference means nothing (NaN: none repeated); ``seconds``: CPU
    time in all, ``budget``: those allowed, by which ``left_out`` sets and repeats were not swept.
    """

    title: str
    fidelity: str
    quantities: tuple[Interest, ...]
    whole: Variant
    bare: Variant
    enough: Variant
    rows: tuple[EffectRow, ...]
    comparison: HeldComparison
    exact: bool
    models: int
    scatter: float
    frequency: tuple[float, float, int]
    settle: int
    hold: int
    seconds: float
    budget: float = inf
    left_out: int = 0


@of_source
def influence(
    case: Case,
    tell: Tell | None = None,
    progress: Progress | bool | None = None,
    clock: Clock = time.thread_time,
    budget: float = inf,
) -> Any:
    """Remove each effect alone, keep each alone, and find the smallest set within the tolerances.

    An ``InfluenceStudy``; of a case under a record, whose peaks are to stay within ``tolerance``, ``RecordEffects``.

    ``tell`` is called with the time that it takes where that is long, ``progress`` with the sweeps made and all that
    are foreseen; True shows both. Sets that do not fit into ``budget`` CPU seconds are not swept. ValueError where the
    case names no effect, its sweep reads no displacement, its complete model cannot be built, or the models without one
    effect alone would take longer than the budget.

    >>> import vibeam
    >>> case = vibeam.load("cases/dtu_neutral.toml", {"influence": {"points": 3, "repeats": 1, "quantities": ["peak"]}})
    >>> sorted(row.effect for row in vibeam.influence(case).rows)
    ['mass.rigid_half_width', 'mass.rotary_inertia']
    """
    if case.record is not None:
        from vibeam.studies.influence.recorded_effects import record_effects

        with telling(progress, "influence") as counting:
            return record_effects(case, case.influence.tolerance, counting)
    require_displacement(case, "influence")
    sets = subsets(case)
    _warm_up(case, sets.fidelity)
    with telling(progress, "influence") as told:
        said: Any = told if progress is True else tell or (lambda line: None)
        return _EffectSweeps(case, sets, said, told, clock, budget).study()


def _warm_up(case: Case, name: str) -> None:
    """Run one short point of the fidelity, unmeasured."""
    fidelity, omega = case.fidelities[name], 2 * np.pi * float(case.sweep.frequency[0])
    base = float(np.ravel(case.amplitude_of(name, np.array([omega])))[0])
    warm_up_once(fidelity.solver, case.system(name), omega, base, case.sweep.output, fidelity.options)


LEFT_OUT = "left out: over the budget"
LONG = 10.0  # CPU seconds from which on a prediction is told


class _EffectSweeps:
    """State of a study in progress: every set of effects is swept once."""

    def __init__(self, case: Case, sets: Subsets, tell: Tell, progress: Progress, clock: Clock, budget: float) -> None:
        self.case, self.sets, self.tell, self.progress = case, sets, tell, progress
        self.clock, self.budget, self.began = clock, budget, clock()
        self.asked = quantities(case.influence)
        self.all = frozenset(sets.effects)
        lacking = [self.all - {name} for name in sets.effects]
        self.compared = list(dict.fromkeys([self.all, *lacking, frozenset[str]()]))
        self.single = list(dict.fromkeys([*self.compared, *(frozenset({name}) for name in sets.effects)]))
        self.needed = {self.all, *lacking}
        self.models: dict[frozenset[str], EffectModel] = {}
        self.cpu: dict[frozenset[str], list[float]] = {}
        self.done, self.total = 0, len(self.single) + case.influence.repeats * len(self.compared)
        self.each, self.left_out = 0.0, 0
        progress(0, self.total)
        if self._model(self.all).why:
            raise ValueError(self._model(self.all).why)
        self.each = clock() - self.began
        self._predict()

    def _predict(self) -> None:
        """Say how long it may take, by the time of the first model; ValueError for what cannot fit into the budget."""
        if not self._fits(len(self.needed) - 1):
            raise ValueError(
                f"{len(self.needed)} models, all effects and each without one, take about "
                f"{len(self.needed) * self.each:.2g} s of CPU time, and {self.budget:g} s are allowed: "
                "allow more (--budget), or sweep fewer points (influence.points)"
            )
        if self.total * self.each > LONG:
            self.tell(f"{self.total} sweeps and more, of about {self.each:.2g} s of CPU time each")

    def _fits(self, sweeps: int) -> bool:
        """Test whether so many sweeps can be expected within the budget."""
        return sweeps * self.each <= self.budget - (self.clock() - self.began)

    def study(self) -> InfluenceStudy:
        """Run single effects first, then the search, then time them, and make the rows."""
        for kept in self.single:
            self._model(kept)
        all_sets = self._fits(2 ** len(self.sets.effects) - len(self.models))
        needed, exact = smallest(self.sets.effects, lambda kept: self._variant(kept).worst, all_sets)
        self._time()
        rows = sorted((self._row(name, needed) for name in self.sets.effects), key=lambda row: -row.influence)
        plan = self.sets.whole.sweep
        return InfluenceStudy(
            title=self.case.title,
            fidelity=self.sets.fidelity,
            quantities=self.asked,
            whole=self._variant(self.all),
            bare=self._variant(frozenset()),
            enough=self._variant(needed),
            rows=tuple(rows),
            comparison=self._compared(),
            exact=exact and all(each.why != LEFT_OUT for each in self.models.values()),
            models=sum(each.why != LEFT_OUT for each in self.models.values()),
            scatter=max((max(each) - min(each) for each in self.cpu.values() if len(each) > 1), default=nan),
            frequency=(float(plan.frequency.min()), float(plan.frequency.max()), len(plan.frequency)),
            settle=plan.settle,
            hold=plan.hold,
            seconds=self.clock() - self.began,
            budget=self.budget,
            left_out=self.left_out,
        )

    def _compared(self) -> HeldComparison:
        """The complete model with those that lack one effect, with either restitution held."""
        lacking = {name: self._model(self.all - {name}) for name in self.sets.effects}
        built = {name: each for name, each in lacking.items() if not each.why}
        return held_comparison(
            self._compared_model(self.sets.fidelity, self._model(self.all)),
            [self._compared_model(name, each) for name, each in built.items()],
            other_physics=True,
        )

    def _compared_model(self, name: str, each: EffectModel) -> ComparedModel:
        curve = each.swept
        return replace(compared_model(curve.case, self.sets.fidelity, curve.system), name=name)

    def _model(self, kept: frozenset[str]) -> EffectModel:
        if kept not in self.models:
            self.total += kept not in self.single
            self.models[kept] = self._swept_model(kept)
        return self.models[kept]

    def _swept_model(self, kept: frozenset[str]) -> EffectModel:
        if kept not in self.needed and not self._fits(1):
            self.left_out += 1
            return EffectModel(tuple(name for name in self.sets.effects if name in kept), why=LEFT_OUT)
        wanted = [quantity.name for quantity in self.asked]
        found = model(self.sets, kept, wanted, self.case.influence.frequency)
        self._count()
        return found

    def _count(self) -> None:
        self.done += 1
        self.progress(self.done, self.total)

    def _time(self) -> None:
        """Sweep the compared models once more, in turns, so that a slow moment of the machine affects all of them.

        The first sweep of each, which read the quantities, was the warm-up and does not count.
        """
        timed = [kept for kept in self.compared if not self._model(kept).why]
        for _ in range(self.case.influence.repeats):
            if not self._fits(len(timed)):
                self.left_out += len(timed)
                continue
            for kept in timed:
                curve = self._model(kept).swept
                self.cpu.setdefault(kept, []).append(swept(curve.case, self.sets.fidelity, curve.system).cpu)
                self._count()

    def _variant(self, kept: frozenset[str]) -> Variant:
        found, whole = self._model(kept), self._model(self.all)
        changes = tuple(change(each, found.value(each.name), whole.value(each.name)) for each in self.asked)
        return Variant(
            found.kept, changes, found.coordinates, found.frequencies, min(self.cpu.get(kept, [nan])), found.why
        )

    def _row(self, name: str, needed: frozenset[str]) -> EffectRow:
        whole, without = self._variant(self.all), self._variant(self.all - {name})
        added = (0, 0) if without.why else (whole.coordinates - without.coordinates, whole.modes - without.modes)
        alone = self._variant(frozenset({name}))
        return EffectRow(name, without, alone, *added, whole.cpu - without.cpu, name in needed)
