"""Influence of each effect, of a sweep or under a record: what the model without it gets wrong, and those that suffice.

A model suffices where its response is within ``[influence] tolerance`` and ``frequency_accuracy`` of that with all
effects, as two responses are compared anywhere (``vibeam.runs.comparison.responses``); under a record by its peaks.
Quantities that the case names must stay within these as well.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from math import inf, nan

from vibeam.case.case import Case
from vibeam.case.held import Held, held_of, other_choice
from vibeam.case.source import of_source
from vibeam.exchange.faults import reason_of
from vibeam.runs.comparison.errors import Asked, ResponseComparison
from vibeam.studies.changes import LEFT_OUT, ModelVariant, changes, compared_by, limits, limits_of_record
from vibeam.studies.effect_sets import Subsets, smallest, subsets
from vibeam.studies.recorded_numbers import AskedNumber
from vibeam.studies.variants import PEAK, DearSweep, Ensemble, ensembles, require_usual, usual_numbers, within
from vibeam.system.progress import telling
from vibeam_models.arrays import ValueRecord

OF_SWEEPS = ("quantities", "frequency", "frequency_accuracy", "points", "settle", "hold")  # keys of [influence]
FREQUENCIES = ("peak_frequency", "period_one_from", "period_one_to")
SURE = 1e-4  # changes smaller than this share have no sign
DEAREST, SHORT = 20.0, 1.0  # times the work of the whole, and seconds of it, that a sweep may take
Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class EffectsVariant(ModelVariant):
    """Model with the effects ``kept`` alone, beside the one with all."""

    kept: tuple[str, ...] = ()


@dataclass(frozen=True)
class EffectRow:
    """One effect: the model without it, the model with it alone; ``needed`` in the smallest sufficient set.

    ``other_peak``: change of the peak without it where the other restitution is prescribed, NaN where not known.
    """

    effect: str
    without: EffectsVariant
    alone: EffectsVariant
    needed: bool
    other_peak: float = nan

    @property
    def turns(self) -> bool:
        """True where the peak is too high with one restitution prescribed, and too low with the other."""
        own = self.without.change(AskedNumber(PEAK))
        return min(abs(own), abs(self.other_peak)) > SURE and own * self.other_peak < 0


@dataclass(frozen=True, eq=False, repr=False)
class Effects(ValueRecord):
    """``rows`` of the effects of a ``fidelity``, the most influential first; ``enough``: the smallest sufficient set.

    ``asked``: what is allowed; ``whole``: the model with all effects; ``exact``: all sets were tried; ``models``: how
    many were computed, ``left_out`` were not, for the time they take. ``held``: the restitution that is prescribed;
    ``other``: the other choice, None where there is none or it was not compared.
    """

    case: Case
    fidelity: str
    asked: Asked
    rows: tuple[EffectRow, ...]
    enough: EffectsVariant
    whole: Ensemble
    exact: bool
    models: int
    held: Held
    other: Held | None
    left_out: int = 0

    @property
    def realisations(self) -> int:
        """Number of realisations that were left out over the budget."""
        seeds = 0 if self.case.record is None else len(self.case.record.seeds)
        return seeds - self.whole.seconds.shape[1] if seeds else 0


@of_source
def influence(case: Case, progress: Progress | bool | None = None, budget: float = inf) -> Effects:
    """Take each effect away, leave each alone, and find the smallest set that suffices.

    ``progress`` is called with the models computed and all that are foreseen; True shows them. Models that do not fit
    into ``budget`` CPU seconds are left out, of a record realisations. ValueError where the case names no effect;
    CaseError where its complete model cannot be built.

    >>> import vibeam
    >>> case = vibeam.load("cases/dtu_neutral.toml", {"influence": {"points": 3}})
    >>> sorted(row.effect for row in vibeam.influence(case).rows)
    ['mass.rigid_half_width', 'mass.rotary_inertia']
    """
    if case.record is not None:
        require_usual("influence", case.influence, *OF_SWEEPS)
    sets = subsets(case)
    if case.record is not None:
        sets = replace(sets, whole=within(sets.whole, sets.fidelity, budget, 2 * len(sets.effects) + 1))
    with telling(progress, "effects") as told:
        return _EffectModels(case, sets, told, inf if case.record else budget).study()


def limits_of(case: Case, asked: Asked, whole: Ensemble) -> Mapping[AskedNumber, float]:
    """Limits of the numbers that decide: of a sweep those of its comparison, and those that the case names.

    Of a sweep without contact the peak and its frequency decide.
    """
    if whole.response is None:
        return limits_of_record(asked, whole.numbers)
    named, clear = case.influence.quantities or (), not whole.response.largest
    return limits(asked) | {
        each: asked.frequency if each.quantity in FREQUENCIES else asked.amplitude
        for each in whole.numbers
        if clear or each.quantity in named
    }


class _EffectModels:
    """State of a study in progress: every set of effects is computed once."""

    def __init__(self, case: Case, sets: Subsets, told: Progress, budget: float) -> None:
        self.case, self.sets, self.told, self.budget = case, sets, told, budget
        plan, named = case.influence, map(AskedNumber, case.influence.quantities or ())
        self.asked = Asked.of(plan.tolerance, plan.frequency_accuracy)
        self.numbers = tuple(dict.fromkeys([*usual_numbers(case), *(named if case.record is None else ())]))
        told(0, 2 * len(sets.effects) + 1)
        [self.whole] = ensembles([(sets.case(sets.effects), sets.fidelity)], self.numbers)
        self.limits = limits_of(case, self.asked, self.whole)
        self.limit = min(max(DEAREST * self.whole.work, SHORT), budget)
        same = None if self.whole.response is None else ResponseComparison()
        self.known = {frozenset(sets.effects): self._variant(sets.effects, self.whole, same)}

    def _variant(self, kept: tuple[str, ...], found: Ensemble, beside: ResponseComparison | None) -> EffectsVariant:
        changed = changes(self.whole, found, beside, self.limits)
        remarks = tuple(f"{number}: {why}" for number, why in found.why.items())
        return EffectsVariant(changed, beside, found.modes, float(found.seconds.sum()), remarks=remarks, kept=kept)

    def variant(self, kept: Collection[str]) -> EffectsVariant:
        """The model with some effects."""
        key = frozenset(kept)
        if key not in self.known:
            self.known[key] = self._made(tuple(name for name in self.sets.effects if name in key))
            self.told(len(self.known), max(len(self.known), 2 * len(self.sets.effects) + 1))
        return self.known[key]

    def _made(self, kept: tuple[str, ...]) -> EffectsVariant:
        spent = [each.seconds for each in self.known.values() if not each.why]
        if sum(spent) * (1 + 1 / len(spent)) > self.budget:
            return EffectsVariant(why=f"{LEFT_OUT}over the budget", kept=kept)
        try:
            [found] = ensembles([(self.sets.case(kept), self.sets.fidelity)], self.numbers, limit=self.limit)
        except DearSweep as dear:
            return EffectsVariant(why=f"{LEFT_OUT}{dear}", kept=kept)
        except ValueError as refusal:
            return EffectsVariant(why=reason_of(refusal), kept=kept)
        ours, whole, fine = found.response, self.whole.response, len(kept) == len(self.sets.effects) - 1
        beside = None if ours is None or whole is None else compared_by(self.asked, ours, whole, fine)
        return self._variant(kept, found, beside)

    def study(self) -> Effects:
        """The whole study."""
        names, held = self.sets.effects, held_of(self.sets.whole.scene)
        pairs = {name: (self.variant({*names} - {name}), self.variant({name})) for name in names}
        kept, exact = smallest(names, lambda chosen: self.variant(chosen).worst)
        left_out = sum(each.left_out for each in self.known.values())
        other = None if left_out or self.case.record else other_choice(held)
        peaks = {} if other is None else self._other_peaks(other.restitution_of)
        rows = [EffectRow(name, *pairs[name], name in kept, peaks.get(name, nan)) for name in names]
        rows.sort(key=lambda row: -row.without.worst)
        return Effects(
            self.case, self.sets.fidelity, self.asked, tuple(rows), self.variant(kept), self.whole,
            exact and not left_out, len(self.known) - left_out, held, other, left_out,
        )  # fmt: skip

    def _other_peaks(self, restitution_of: str) -> Mapping[str, float]:
        """Changes of the peak without each effect where the other restitution is prescribed, as far as they exist."""
        peak, found, names = AskedNumber(PEAK), dict[str, float](), self.sets.effects
        sets = {"": names} | {name: tuple(each for each in names if each != name) for name in names}
        for name, kept in sets.items():
            with suppress(ValueError):
                case = self.sets.case(kept).with_keys({"stop.restitution_of": restitution_of})
                [made] = ensembles([(case, self.sets.fidelity)], [peak], limit=self.limit)
                found[name] = float(made.of(peak)[0, 0])
        whole = found.pop("", nan)
        return {name: value / whole - 1 for name, value in found.items()}
