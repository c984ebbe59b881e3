"""Peaks of a case's fidelities with the other restitution held, by sweeps of the case that holds it."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite

from vibeam.case.case import Case
from vibeam.case.held import Held, held_of, other_choice
from vibeam.exchange.faults import reason_of
from vibeam.runs.comparison.beyond import response_of
from vibeam.runs.comparison.differences import BothChoices, HeldComparison
from vibeam.runs.comparison.kinds import UNKNOWN
from vibeam.runs.comparison.responses import Response
from vibeam.runs.comparison.work import Work
from vibeam.system.curves import NAN
from vibeam.system.response import Branches

WORK = 1.5  # seconds that the sweep of a fidelity may take, counted
ALONE = "a single degree of freedom given directly has no more modes"
ITS_OWN = "the fidelity sets stop.restitution_of itself"
DEAR = "its sweep takes longer than {:g} s"


@dataclass(frozen=True)
class _Peak:
    """Peak amplitude of a fidelity with the other choice held, m; ``why``: it is not known."""

    amplitude: float = NAN
    why: str = ""


def comparisons(
    case: Case, finest: Mapping[str, str], branches: Mapping[str, Branches]
) -> tuple[HeldComparison, ...]:  # fmt: skip
    """Comparisons of all fidelities with the ``finest`` of each, one for each of these that there is."""
    groups = {top: [name for name in finest if finest[name] == top != name] for top in dict.fromkeys(finest.values())}
    return tuple(_comparison(case, top, names, branches) for top, names in groups.items() if names)


def _comparison(case: Case, top: str, names: list[str], branches: Mapping[str, Branches]) -> HeldComparison:
    begun, held = time.thread_time(), held_of(case.scene_of(top))
    other, peaks = other_choice(held), dict[str, _Peak]()
    if other is not None:
        peaks[top] = _peak(case, top, other)
        unknown = peaks[top] if peaks[top].why else None
        peaks |= {name: unknown or _peak(case, name, other) for name in names}
    rows = tuple(_row(name, branches[name].off(branches[top]).peak, peaks, top) for name in names)
    return HeldComparison(top, held, other, rows, time.thread_time() - begun)


def _row(name: str, off: float, peaks: Mapping[str, _Peak], top: str) -> BothChoices:
    """Row of one fidelity; without the other choice there are no ``peaks``."""
    if not peaks:
        return BothChoices(name, off)
    own = peaks[name]
    return BothChoices(name, off, NAN if own.why else own.amplitude / peaks[top].amplitude - 1, own.why)


def _peak(case: Case, name: str, other: Held) -> _Peak:
    """Peak of one fidelity with the other choice held."""
    if case.scene_of(name).given_mode is not None:
        return _Peak(why=ALONE)
    try:
        changed = case.with_keys({"stop.restitution_of": other.restitution_of})
        if held_of(changed.scene_of(name)) != other:
            return _Peak(why=ITS_OWN)
        found = response_of(changed, name, changed.system(name), len(case.sweep.frequency), Work(WORK))
    except ValueError as refusal:
        return _Peak(why=reason_of(refusal).removeprefix("restitution: ").split(";")[0])
    return _Peak(why=DEAR.format(WORK)) if found is None else _Peak(_highest(found))


def _highest(found: Response) -> float:
    """Largest amplitude of all complete points, m; NaN without one."""
    places = [each for several in found.places.values() for each in several if each.kind.periods != UNKNOWN]
    return max((abs(each.amplitude) for each in places if isfinite(each.amplitude)), default=NAN)
