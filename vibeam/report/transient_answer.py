"""Answer of a run under a record: which fidelity suffices, what the others miss, and until when motions agree.

A fidelity suffices where its principal numbers, the peaks of the outputs and the hardest impact, are within the
accuracy of the finest's at every value, twice their standard errors added. Where single motions part because impacts
make them sensitive, the peaks before the horizon of agreement count in place of those after it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import isfinite, log

import numpy as np

from vibeam.runs.comparison.differences import listed
from vibeam.runs.transient.comparison import PairedDifference, TransientComparison
from vibeam.runs.transient.result import TransientResult
from vibeam.runs.transient.transient import Transient
from vibeam.system.number_text import TIMES, begun, percent, prefixed, signed

NAMED = 4  # quantities named of what a fidelity misses
ENSEMBLE = 4  # realisations from which on statistics are compared where single motions part
BEFORE = "peak_before"  # peak before the horizon
DUST = 1e-9  # share below which a standard error is round-off
TOLD = ("peak", "hardest_impact", "impacts", "lost_at_impacts", "energy_left")  # in the sentence
#: share of the finest's own horizon after which a model off by 1 % parts, where differences grow from 1e-6 to 5 % in it
SMALL_ERROR = log(0.05 / 0.01) / log(0.05 / 1e-6)
CALLED = {
    "hardest_impact": "hardest impact", "impact_velocity": "mean impact velocity", "impacts": "number of impacts",
    "lost_at_impacts": "energy lost to the stop", "lost_by_damping": "energy lost by damping",
    "energy_left": "energy left",
}  # fmt: skip


@dataclass(frozen=True)
class FidelityAnswer:
    """Judgement of one fidelity: the ``worst`` of each quantity over the values, those that are ``principal`` first.

    ``chaotic``: single motions part no earlier than impacts make them; ``until``: share of the time until those of the
    first seed part, at the worst value.
    """

    name: str
    worst: tuple[PairedDifference, ...]
    principal: tuple[PairedDifference, ...]
    chaotic: bool
    until: float

    def is_within(self, accuracy: float) -> bool:
        """Test whether all principal numbers are known and within the accuracy."""
        return bool(self.principal) and all(each.is_within(accuracy) for each in self.principal)


def answers(result: TransientResult) -> list[FidelityAnswer]:
    """Judgements of all fidelities but the finest, fewest modes first."""
    ordered = sorted(result.comparison, key=lambda name: result[name].modes)
    return [_judged(result, result.comparison[name]) for name in ordered]


def _judged(result: TransientResult, of: TransientComparison) -> FidelityAnswer:
    finest = result[of.finest]
    plain = {each.name for each in finest.signals if each.name == each.output}
    worst: dict[tuple[str, str], PairedDifference] = {}
    for each in of.differences:
        key = each.quantity, each.signal
        if each.quantity != "rms" and (key not in worst or abs(each.mean) > abs(worst[key].mean)):
            worst[key] = each
    chaotic = is_chaotic(of)
    principal = [worst[key] for key in worst if key[1] in plain or key[0] == "hardest_impact"]
    if chaotic and of.horizon.shape[1] < ENSEMBLE:
        principal = list(_before(of, finest, plain))
    first = of.horizon[:, 0] / of.duration
    until = float(np.nanmin(first)) if np.isfinite(first).any() else float("nan")
    return FidelityAnswer(of.fidelity, tuple(worst.values()), tuple(principal), chaotic, until)


def is_chaotic(of: TransientComparison) -> bool:
    """Test whether the finest parts from itself, and the motions no earlier than those of a model off by 1 % would."""
    own, first = of.own_horizon, of.horizon[:, 0]
    known = np.isfinite(own) & np.isfinite(first) & (first < of.duration)
    return bool(known.any() and np.all((own < of.duration)[known] & (first >= SMALL_ERROR * own)[known]))


def _before(of: TransientComparison, finest: Transient, plain: set[str]) -> Iterator[PairedDifference]:
    """Differences of the outputs' peaks before the horizon, the worst of all motions."""
    for number, signal in enumerate(finest.signals):
        known = of.off_before[..., number].ravel()
        known = known[np.isfinite(known)]
        if signal.name in plain and len(known):
            yield PairedDifference(
                BEFORE, signal.name, 0, float(known[np.abs(known).argmax()]), float("nan"), len(known)
            )


def enough_at(result: TransientResult, accuracy: float) -> list[tuple[float, str]]:
    """At each value of the factor the fidelity with the fewest modes that is within the accuracy, else the finest."""
    top = next(iter(result.comparison.values())).finest
    alike = sorted((each for each in result.comparison.values() if each.finest == top),
                   key=lambda each: result[each.fidelity].modes)  # fmt: skip
    found = []
    for at, value in enumerate(result.factors):
        rows = [_judged(result, _at_value(each, at)) for each in alike]
        found.append((value, next((row.name for row in rows if row.is_within(accuracy)), top)))
    return found


def _at_value(of: TransientComparison, at: int) -> TransientComparison:
    arrays = {name: getattr(of, name)[[at]] for name in ("horizon", "own_horizon", "off", "off_before")}
    return replace(of, **arrays, differences=tuple(each for each in of.differences if each.at == at))


def transient_answer(result: TransientResult, accuracy: float) -> str:
    """Answer of a result; of one fidelity what its motion does."""
    if not any(each.complete.any() for each in result.values()):
        return "No motion was completed."
    found = answers(result)
    if not found:
        return " ".join(_alone(result, name) for name in result)
    tops = {result.comparison[each.name].finest for each in found}
    alike = {top: [each for each in found if result.comparison[each.name].finest == top] for top in result}
    return " ".join(_group(result, alike[top], top, accuracy) for top in result if top in tops)


def _alone(result: TransientResult, name: str) -> str:
    found = result[name]
    many = float(np.nanmean(found.of("impacts")))
    hardest = np.nanmax(found.of("hardest_impact")) if np.isfinite(found.of("hardest_impact")).any() else float("nan")
    speed = " m/s" * (result.case.scene.natural_unit is None)
    met = f"{many:.4g} impacts, the hardest at {hardest:.3g}{speed}" if isfinite(hardest) else "no impact"
    return f"{name}, the only fidelity of its physics: {met}."


def _group(result: TransientResult, found: Sequence[FidelityAnswer], top: str, accuracy: float) -> str:
    """Sentences on the fidelities that are compared with one finest."""
    within, enough = percent(accuracy), [each for each in found if each.is_within(accuracy)]
    judged = "in the peaks of the outputs and the hardest impact"
    missed = [misses(each, accuracy) for each in found if each not in enough]
    if not any(result[name].impacts.any() for name in (top, *(each.name for each in found))):
        head = "Nothing touches the stop. "
        judged = "in the peaks of the outputs"
    else:
        head = ""
    if enough:
        first = enough[0]
        said = f"{begun(first.name)} is within {within} of {top}, the finest, {judged}"
        said += f" ({_several(first.principal)})" if first.principal else ""
        beside = [each for each in _beside(first, accuracy) if each not in first.principal]
        said += f", but not in {_several(beside[: NAMED - 1])}" if beside else ""
    else:
        said = f"No other fidelity is known to be within {within} of {top}, the finest, {judged}"
    return head + "; ".join([said, *missed]) + "." + _horizons(result, found, top)


def misses(of: FidelityAnswer, accuracy: float) -> str:
    """Clause on what a fidelity misses, the principal numbers first, and on what too few realisations leave open."""
    principal = [each for each in of.principal if not each.is_within(accuracy)]
    alone = any(each.quantity == BEFORE for each in of.principal)  # of single motions that part
    beside = [] if alone else [each for each in _beside(of, accuracy) if each not in principal]
    off = [*(each for each in principal if abs(each.mean) > accuracy), *beside][:NAMED]
    unsure = [each for each in principal if abs(each.mean) <= accuracy]
    open_ = f"{_several(unsure)} {'is' if len(unsure) == 1 else 'are'} not known well enough, by too few realisations"
    if not (off or unsure):
        return f"{of.name} is not compared: no motion of both is complete"
    if not off:
        return f"of {of.name} {open_}"
    return f"{of.name} misses {_several(off)}" + f"; of it {open_}" * bool(unsure)


def _beside(of: FidelityAnswer, accuracy: float) -> list[PairedDifference]:
    """Differences beyond the accuracy that are told, the largest first; the mean of many light impacts says little."""
    found = [each for each in of.worst if abs(each.mean) > accuracy and each.quantity in TOLD]
    return sorted(found, key=lambda each: -abs(each.mean))


def _several(differences: Sequence[PairedDifference]) -> str:
    return ", ".join(f"{called(each)} {difference_text(each)}" for each in differences)


def called(each: PairedDifference) -> str:
    """Quantity of a difference in words."""
    until = " until they part" if each.quantity == BEFORE else ""
    return CALLED.get(each.quantity) or f"peak {each.signal}{until}"


def difference_text(each: PairedDifference) -> str:
    """Share with its sign, and its standard error where it is known."""
    return signed(each.mean) + (f" ± {percent(each.error)}" if isfinite(each.error) and each.error > DUST else "")


def _horizons(result: TransientResult, found: Sequence[FidelityAnswer], top: str) -> str:
    """Sentence on the fidelities whose impacts part from the finest's, and whether that is chaos."""
    apart = [each for each in found if each.until < 1]
    if not apart:
        return ""
    several = [f"{each.name} until {time_text(each.until * result[top].duration)}" for each in apart]
    of = "of the first realisation " if len(result.seeds) > 1 else ""
    said = f" Impacts {of}pair with {top}'s: {listed(several)} of {time_text(result[top].duration)}"
    own = result.comparison[apart[0].name].own_horizon
    own = own[np.isfinite(own)]
    if not len(own):
        return f"{said}."
    least, self_said = float(own.min()), f"{top} itself, {_nudged(result)}"
    if not least < result[top].duration:
        return f"{said}; {self_said}, agrees to the end: the models are off."
    chaotic = [each.name for each in apart if each.chaotic]
    off = [each.name for each in apart if not each.chaotic]
    kinds = []
    if chaotic:
        kinds.append(f"{listed(chaotic)} part{'s' * (len(chaotic) == 1)} by chaos")
    if off:
        kinds.append(f"{listed(off)} {'is' if len(off) == 1 else 'are'} off before that")
    return f"{said}; {self_said}, until {time_text(least)}: {', '.join(kinds)}."


def _nudged(result: TransientResult) -> str:
    """Difference of the finest's twin, in words."""
    driven = not result.input or any(each.peak for each in result.input.values())
    return "under a load larger by 1e-6" if driven else "from a start smaller by 1e-6"


def time_text(value: float) -> str:
    """Time with the unit that suits it; a dash for NaN."""
    if not isfinite(value):
        return "–"
    unit, factor = prefixed(TIMES, value)
    return f"{value * factor:.3g} {unit}"
