"""Influence study (``vibeam influence``): changes and cost of each effect of a case, and the effects that it needs."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.case import require_displacement
from vibeam.case.source import of_source
from vibeam.runs.comparison.differences import HeldComparison
from vibeam.runs.comparison.held_comparison import ComparedModel, compared_model, held_comparison
from vibeam.solvers.steady import warm_up_once
from vibeam.studies.influence.curve import Change, Interest, change, quantities, swept
from vibeam.studies.influence.model import EffectModel, model
from vibeam.studies.influence.subsets import Subsets, smallest, subsets
from vibeam.system.progress import telling
from vibeam_models.arrays import ValueRecord

if TYPE_CHECKING:
    from vibeam.case.case import Case


Progress = Callable[[str], None]
NAN = float("nan")


@dataclass(frozen=True)
class Variant:
    """Model and its distance from the complete one; ``cpu``: s of its sweep, least of the repeats (NaN: not timed).

    ``why``: the reason where the model cannot be built.
    """

    kept: tuple[str, ...]
    changes: tuple[Change, ...]
    coordinates: int
    frequencies: tuple[float, ...]
    cpu: float = NAN
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
    """Result of ``vibeam influence``; ``rows`` sorted by influence, the largest first.

    ``comparison``: of the complete model with those without one effect, with either restitution held, and its distance
    from its own limit. ``whole``, ``bare`` and ``enough``: the models with all effects, with none and with the smallest
    set; ``exact``: True where all sets were tried; ``models``: number of sweeps; ``scatter``: s by which repeats of a
    sweep's CPU time differed at most, below which a difference means nothing; ``seconds``: CPU time in all.
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


@of_source
def influence(case: Case, progress: Progress | bool | None = None) -> InfluenceStudy:
    """Remove each effect alone, keep each alone, and find the smallest set within the tolerances.

    ``progress``: True shows it, a function is told in lines.
    ValueError where the case names no effect, its sweep reads no displacement, or its complete model cannot be built.
    """
    require_displacement(case, "influence")
    sets = subsets(case)
    _warm_up(case, sets.fidelity)
    begun = time.thread_time()
    with telling(progress, "influence") as told:
        return _EffectSweeps(case, sets, told).study(begun)


def _warm_up(case: Case, name: str) -> None:
    """Run one short point of the fidelity, unmeasured."""
    fidelity, omega = case.fidelities[name], 2 * np.pi * float(case.sweep.frequency[0])
    base = float(np.ravel(case.amplitude_of(name, np.array([omega])))[0])
    warm_up_once(fidelity.solver, case.system(name), omega, base, case.sweep.output, fidelity.options)


class _EffectSweeps:
    """State of a study in progress: every set of effects is swept once."""

    def __init__(self, case: Case, sets: Subsets, progress: Progress) -> None:
        self.case, self.sets, self.say = case, sets, progress
        self.asked = quantities(case.influence)
        self.all = frozenset(sets.effects)
        self.models: dict[frozenset[str], EffectModel] = {}
        self.cpu: dict[frozenset[str], list[float]] = {}
        if self._model(self.all).why:
            raise ValueError(self._model(self.all).why)

    def study(self, begun: float) -> InfluenceStudy:
        """Run single effects first, then the search, then make the rows."""
        self._time()
        needed, exact = smallest(self.sets.effects, lambda kept: self._variant(kept).worst)
        rows = sorted((self._row(name, needed) for name in self.sets.effects), key=lambda row: -row.influence)
        plan = self._case(self.all).sweep
        return InfluenceStudy(
            title=self.case.title,
            fidelity=self.sets.fidelity,
            quantities=self.asked,
            whole=self._variant(self.all),
            bare=self._variant(frozenset()),
            enough=self._variant(needed),
            rows=tuple(rows),
            comparison=self._compared(),
            exact=exact,
            models=len(self.models),
            scatter=max(max(seconds) - min(seconds) for seconds in self.cpu.values()),
            frequency=(float(plan.frequency.min()), float(plan.frequency.max()), len(plan.frequency)),
            settle=plan.settle,
            hold=plan.hold,
            seconds=time.thread_time() - begun,
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
        assert each.case is not None
        assert each.system is not None
        return replace(compared_model(each.case, self.sets.fidelity, each.system), name=name)

    def _model(self, kept: frozenset[str]) -> EffectModel:
        if kept not in self.models:
            self.say(f"with {', '.join(name for name in self.sets.effects if name in kept) or 'no effect'}")
            wanted = [quantity.name for quantity in self.asked]
            self.models[kept] = model(self.sets, kept, wanted, self.case.influence.frequency)
        return self.models[kept]

    def _case(self, kept: frozenset[str]) -> Case:
        found = self._model(kept).case
        assert found is not None
        return found

    def _time(self) -> None:
        """Sweep the compared models once more, in turns, so that a slow moment of the machine affects all of them.

        The first sweep of each, which read the quantities, was the warm-up and does not count.
        """
        single = [self.all, frozenset[str](), *(self.all - {name} for name in self.sets.effects)]
        timed = [kept for kept in single if not self._model(kept).why]
        self.say(f"timing {len(timed)} models")
        for _ in range(self.case.influence.repeats):
            for kept in timed:
                self.cpu.setdefault(kept, []).append(self._swept(kept))

    def _swept(self, kept: frozenset[str]) -> float:
        """CPU seconds of one sweep."""
        found = self._model(kept)
        assert found.case is not None
        assert found.system is not None
        return swept(found.case, self.sets.fidelity, found.system).cpu

    def _variant(self, kept: frozenset[str]) -> Variant:
        found, whole = self._model(kept), self._model(self.all)
        changes = tuple(change(each, found.value(each.name), whole.value(each.name)) for each in self.asked)
        return Variant(
            found.kept, changes, found.coordinates, found.frequencies, min(self.cpu.get(kept, [NAN])), found.why
        )

    def _row(self, name: str, needed: frozenset[str]) -> EffectRow:
        whole, without = self._variant(self.all), self._variant(self.all - {name})
        added = (0, 0) if without.why else (whole.coordinates - without.coordinates, whole.modes - without.modes)
        alone = self._variant(frozenset({name}))
        return EffectRow(name, without, alone, *added, whole.cpu - without.cpu, name in needed)
