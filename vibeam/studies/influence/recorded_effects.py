"""Influence of each effect under a record: the numbers of the motions without it, and the effects that suffice."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from math import inf
from typing import Any

from vibeam.case.case import Case, plan_of_record
from vibeam.exchange.faults import reason_of
from vibeam.studies.influence.subsets import Subsets, smallest, subsets_of_record
from vibeam.studies.record.ensembles import (
    Ensemble,
    NumberChange,
    Told,
    changes,
    ensembles,
    plain_finest,
    require_usual,
    usual_numbers,
    within,
    worst,
)
from vibeam.studies.record.readings import AskedNumber
from vibeam_models.arrays import ValueRecord


@dataclass(frozen=True)
class EffectsVariant:
    """Model with the effects ``kept`` alone, its changes from the whole; ``why`` it cannot be built, else empty."""

    kept: tuple[str, ...]
    changes: tuple[NumberChange, ...] = ()
    why: str = ""

    @property
    def worst(self) -> float:
        """Largest change of the peaks, as a share, its error counted twice; ∞ where it is not known."""
        found = inf if self.why else worst(self.changes)
        return found if found == found else inf


@dataclass(frozen=True)
class RecordEffect:
    """One effect: the model without it alone, the model with it alone; ``needed`` in the smallest sufficient set."""

    effect: str
    without: EffectsVariant
    alone: EffectsVariant
    needed: bool


@dataclass(frozen=True, eq=False, repr=False)
class RecordEffects(ValueRecord):
    """``rows`` of the effects of a ``fidelity``, the most influential first; ``enough``: the smallest sufficient set.

    ``tolerance``: largest change allowed; ``exact``: all sets were tried; ``models``: how many were flown;
    ``left_out``: of the case's seeds, over the budget.
    """

    case: Case
    fidelity: str
    tolerance: float
    rows: tuple[RecordEffect, ...]
    enough: EffectsVariant
    reference: Ensemble
    exact: bool
    models: int
    left_out: int = 0


def record_effects(case: Case, tolerance: float, told: Told | None = None, budget: float = inf) -> RecordEffects:
    """Take each effect away, leave each alone, and find the smallest set within the ``tolerance``, a share.

    ``budget``: CPU seconds, about, by which realisations are left out. ValueError where the case names no effect, or
    has no rig that could have one.
    """
    of_sweeps = ("quantities", "frequency", "frequency_accuracy", "restitution_tolerance", "points", "settle", "hold")
    require_usual("influence", case.influence, *of_sweeps, "repeats")
    name = plain_finest(case, case.influence.fidelity)
    sets = subsets_of_record(case.alone(name), name)
    sets = replace(sets, whole=within(sets.whole, name, budget, 2 * len(sets.effects) + 1))
    left_out = len(plan_of_record(case).seeds) - len(plan_of_record(sets.whole).seeds)
    return replace(_EffectMotions(case, sets, tolerance, told).study(), left_out=left_out)


class _EffectMotions:
    """State of a study in progress: every set of effects is flown once."""

    def __init__(self, case: Case, sets: Subsets, tolerance: float, told: Told | None) -> None:
        self.case, self.sets, self.tolerance, self.told = case, sets, tolerance, told
        self.asked: tuple[AskedNumber, ...] = usual_numbers(case)
        [self.reference] = ensembles([(sets.case(sets.effects), sets.fidelity)], self.asked)
        self.known: dict[frozenset[str], EffectsVariant] = {
            frozenset(sets.effects): EffectsVariant(sets.effects, changes(self.reference, self.reference))
        }

    def variant(self, kept: Collection[str]) -> EffectsVariant:
        """The model with some effects."""
        key = frozenset(kept)
        if key not in self.known:
            self.known[key] = self._flown(tuple(name for name in self.sets.effects if name in key))
            if self.told is not None:
                self.told(len(self.known), max(len(self.known), 2 * len(self.sets.effects) + 1))
        return self.known[key]

    def _flown(self, kept: tuple[str, ...]) -> EffectsVariant:
        try:
            [found] = ensembles([(self.sets.case(kept), self.sets.fidelity)], self.asked)
        except ValueError as refusal:
            return EffectsVariant(kept, why=reason_of(refusal))
        return EffectsVariant(kept, changes(self.reference, found))

    def study(self) -> RecordEffects:
        """The whole study."""
        effects = self.sets.effects
        if self.told is not None:
            self.told(0, 2 * len(effects) + 1)
        pairs: dict[str, tuple[EffectsVariant, EffectsVariant]] = {
            name: (self.variant([other for other in effects if other != name]), self.variant([name]))
            for name in effects
        }
        kept, exact = smallest(effects, lambda chosen: self.variant(chosen).worst / self.tolerance)
        rows = [RecordEffect(name, *pairs[name], needed=name in kept) for name in effects]
        rows.sort(key=lambda row: -row.without.worst)
        found: Any = self.variant(kept)
        return RecordEffects(
            self.case, self.sets.fidelity, self.tolerance, tuple(rows), found, self.reference, exact, len(self.known)
        )
