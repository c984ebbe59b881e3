"""Peaks of a case's fidelities with the other restitution held, by sweeps of the case that holds it."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite

from vibeam.case.case import Case
from vibeam.case.held import Held, held_of, other_choice
from vibeam.exchange.faults import reason_of
from vibeam.periodic.motion_kind import UNKNOWN
from vibeam.runs.comparison.beyond import WORK, response_of
from vibeam.runs.comparison.differences import BothChoices, HeldComparison
from vibeam.runs.comparison.work import Work
from vibeam.system.curves import NAN
from vibeam.system.response import Branches

ALONE = "a single degree of freedom given directly has no more modes"
ITS_OWN = "the fidelity sets stop.restitution_of itself"
DEAR = "its sweep takes longer than {:g} s"


def comparisons(case: Case, finest: Mapping[str, str], branches: Mapping[str, Branches]) -> tuple[HeldComparison, ...]:
    """Comparisons of all fidelities with the ``finest`` of each, one for each of these that there is."""
    groups = {top: [name for name in finest if finest[name] == top != name] for top in dict.fromkeys(finest.values())}
    return tuple(_comparison(case, top, names, branches) for top, names in groups.items() if names)


def _comparison(case: Case, top: str, names: list[str], branches: Mapping[str, Branches]) -> HeldComparison:
    held = held_of(case.scene_of(top))
    other = other_choice(held)
    highest = None if other is None else _peak(case, top, other)
    rows = list[BothChoices]()
    for name in names:
        own = highest if other is None or isinstance(highest, str) else _peak(case, name, other)
        off = branches[name].off(branches[top]).peak
        share = own / highest - 1 if isinstance(own, float) and isinstance(highest, float) else NAN
        rows.append(BothChoices(name, off, share, own if isinstance(own, str) else ""))
    return HeldComparison(top, held, other, tuple(rows))


def _peak(case: Case, name: str, other: Held) -> float | str:
    """Peak amplitude of one fidelity with the other choice held, m, or the reason why it is not known."""
    if case.scene_of(name).given_mode is not None:
        return ALONE
    try:
        changed = case.with_keys({"stop.restitution_of": other.restitution_of})
        if held_of(changed.scene_of(name)) != other:
            return ITS_OWN
        found = response_of(changed, name, changed.system(name), len(case.sweep.frequency), Work(WORK))
    except ValueError as refusal:
        return reason_of(refusal).removeprefix("restitution: ").split(";")[0]
    if found is None:
        return DEAR.format(WORK)
    places = [each for several in found.places.values() for each in several if each.kind.periods != UNKNOWN]
    return max((abs(each.amplitude) for each in places if isfinite(each.amplitude)), default=NAN)
