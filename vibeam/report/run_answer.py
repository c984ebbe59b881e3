"""Answer of a run: which fidelity suffices for an accuracy, what the others miss, and what is held fixed in that.

Nothing is called enough beyond what is known: a fidelity suffices where its peak and its rms distance from the finest
of the same physics are within the accuracy, and the finest one's own distance from its limit is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

from vibeam.case.held import held_of
from vibeam.figures.units import units_for
from vibeam.runs.comparison.differences import listed
from vibeam.runs.estimate.records import summary
from vibeam.runs.summary import compare, stays_clear
from vibeam.system.number_text import percent
from vibeam_models.arguments import counted

if TYPE_CHECKING:
    from vibeam.case.held import Held
    from vibeam.runs.comparison.differences import BothChoices, HeldComparison
    from vibeam.runs.result import Result
    from vibeam.runs.summary import Summary

USUAL = 0.05  # accuracy where none is asked for
FEW = 3  # fidelities named in one list
LEAST = 1e-4  # differences below are called less than this
NUMBERS = ["No", "One", "Two", "Three", "Four", "Five", "Six", "Seven", "Eight", "Nine", "Ten", "Eleven", "Twelve"]


@dataclass(frozen=True)
class PhysicsGroup:
    """Fidelities of one physics: the ``finest`` and the ``others``, fewest modes first.

    ``compared``: with either restitution held, None where that was not asked for; ``exact``: the finest is flown, and
    the case gives its one mode, so that there is no fuller model.
    """

    finest: Summary
    others: tuple[Summary, ...]
    compared: HeldComparison | None
    exact: bool

    @property
    def of_finest(self) -> float:
        """Distance of the finest from its own limit at the peak, of its rms without one; NaN where it is not known."""
        if self.exact:
            return 0.0
        if self.compared is None or self.compared.limit.why:
            return float("nan")
        held = self.compared.limit.held
        return held.peak if isfinite(held.peak) else held.rms

    @property
    def settled(self) -> bool:
        """Test whether the distance of the finest is known, and small against every difference."""
        rows = () if self.exact or self.compared is None else self.compared.rows
        return isfinite(self.of_finest) and all(row.small and not row.why for row in rows)

    def both(self, name: str) -> BothChoices | None:
        """Comparison of one of the others with the finest."""
        rows = () if self.compared is None else self.compared.rows
        return next((row for row in rows if row.fidelity == name), None)

    def is_within(self, row: Summary, accuracy: float) -> bool:
        """Test whether one of the others is within the accuracy of the finest one, or of its limit where known."""
        both, distance = self.both(row.fidelity), row.distance
        margin = both.uncertainty[0] if both and isfinite(both.uncertainty[0]) else 0.0
        assert distance is not None
        if 2 * distance.points < distance.total:
            return False  # at most points one of the two does not repeat
        known = [abs(each) + margin for each in (distance.peak, distance.rms) if isfinite(each)]
        return bool(known) and max(known) <= accuracy


def run_answer(result: Result, accuracy: float = USUAL) -> str:
    """Answer of a result whose comparisons and estimates were made, as far as they are known."""
    rows = {row.fidelity: row for row in compare(result)}
    groups = groups_of(result, rows)
    if result.accuracy is not None:
        return " ".join([next(result.accuracy.sentences()), *map(_held, groups[:1])])
    if not groups:
        return f"{_apart(result, list(rows.values()), accuracy)} {_fixed(held_of(result.case.scene))}"
    said = [_verdict(each, accuracy, len(groups) == 1) for each in groups]
    if all(map(stays_clear, result.values())):
        return " ".join(["Nothing touches the stop.", *said])
    return " ".join([*said, *filter(None, dict.fromkeys(map(_held, groups)))])


def groups_of(result: Result, rows: dict[str, Summary]) -> list[PhysicsGroup]:
    """Groups of fidelities that are compared with one another."""
    finest, compared = result.finest, {each.finest: each for each in result.comparisons}
    case, groups = result.case, []
    for top in dict.fromkeys(finest.values()):
        others = [row for name, row in rows.items() if finest[name] == top != name]
        if others:
            ordered = tuple(sorted(others, key=lambda row: row.modes))
            exact = case.scene_of(top).given_mode is not None and case.fidelities[top].solver == "flight"
            groups.append(PhysicsGroup(rows[top], ordered, compared.get(top), exact))
    return groups


def _verdict(group: PhysicsGroup, accuracy: float, modes: bool) -> str:
    """Sentence on one group; ``modes``: numbers of modes name its fidelities."""
    finest, own, within = group.finest, group.of_finest, percent(accuracy)
    modes = modes and len({row.modes for row in (finest, *group.others)}) == 1 + len(group.others)
    misses = [row for row in group.others if not group.is_within(row, accuracy)]
    tail = "".join(f"; {each}" for each in _missed(misses, accuracy))
    if isfinite(own) and abs(own) > accuracy:
        side = "above" if own > 0 else "below"
        head = (
            f"No fidelity is known to be within {within}: {finest.fidelity}, the finest, is {_size(own)} {side} its own"
        )
        return f"{head} limit at the peak; beside it {'; '.join(_missed(group.others, 0.0))}."
    unknown = f"how far {finest.fidelity} itself is off is not known"
    enough = [row for row in group.others if row not in misses]
    if not enough and isfinite(own):
        where = [finest.fidelity] * modes + [f"{_size(own)} off its own limit"]
        return f"{_name(finest, modes)} suffice{_s(finest, modes)} for {within} ({', '.join(where)}){tail}."
    if not enough:
        return f"No other fidelity is known to be within {within} of {finest.fidelity}, and {unknown}{tail}."
    first = [row for row in enough if row.modes == enough[0].modes]
    said = listed([f"{_name(row, modes)} ({_detail(row, accuracy, modes)})" for row in first])
    one = len(first) == 1
    if isfinite(own) and modes:
        said, why = _name(first[0], True), _detail(first[0], accuracy, True)
        return f"{said} suffice{_s(first[0], True)} for {within} ({why}){tail}."
    if isfinite(own):
        return f"{said} suffice{'s' * one} for {within}{tail}."
    verb = "is" if one and _s(first[0], modes) else "are"
    return f"{said} {verb} within {within} of {finest.fidelity}; {unknown}{tail}."


def _s(row: Summary, modes: bool) -> str:
    """Ending of a verb whose subject ``_name`` gives."""
    return "s" * (not modes or row.modes == 1)


def _detail(row: Summary, accuracy: float, modes: bool) -> str:
    """Name of a fidelity that is called by its modes, its peak, and its largest difference where that is more."""
    assert row.distance is not None
    apart = abs(row.distance.worst) > accuracy
    more = [f"up to {_size(row.distance.worst)} off at single frequencies"] * apart
    return ", ".join([*[row.fidelity] * modes, _peak(row), *more])


def _name(row: Summary, modes: bool) -> str:
    if not modes:
        return row.fidelity
    number = NUMBERS[row.modes] if row.modes < len(NUMBERS) else str(row.modes)
    return f"{number} mode{'s' * (row.modes != 1)}"


def _missed(rows: Sequence[Summary], accuracy: float) -> list[str]:
    """What the given fidelities miss, a clause for those of a kind."""
    sparse = [row for row in rows if row.distance and 2 * row.distance.points < row.distance.total]
    said = [_miss(row, accuracy) for row in rows if row not in sparse]
    if len(said) > FEW:
        said = [*said[: FEW - 1], f"{len(said) - FEW + 1} more are off by more than that as well"]
    clauses = [listed(said)] if said else []
    if sparse:
        few = listed([f"{row.fidelity} ({_peak(row)})" for row in sparse])
        clauses.append(f"{few} repeat{'s' * (len(sparse) == 1)} beside it at less than half of the points")
    return clauses


def _miss(row: Summary, accuracy: float) -> str:
    distance = row.distance
    assert distance is not None
    if isfinite(distance.peak) and (abs(distance.peak) > accuracy or not isfinite(distance.rms)):
        return f"{row.fidelity} is {_signed(distance.peak)}"
    beside = f" ({_signed(distance.peak)} at the peak)" if isfinite(distance.peak) else ""
    return f"{row.fidelity} is {_size(distance.rms)} off rms{beside}"


def _peak(row: Summary) -> str:
    assert row.distance is not None
    if isfinite(row.distance.peak):
        return f"{_signed(row.distance.peak)} at the peak"
    return f"{_size(row.distance.rms)} off rms"


def _signed(value: float) -> str:
    if abs(value) < LEAST:
        return f"off by {_size(value)}"
    return f"{_size(value)} too {'high' if value > 0 else 'low'}"


def _size(value: float) -> str:
    """Size of a difference, to a tenth of a percent; two digits of a small one."""
    size = 100 * abs(value)
    if size < 100 * LEAST:
        return f"less than {100 * LEAST:g} %"
    if size > 1000:
        return "more than 1000 %"
    return f"{round(size, 1):g} %" if size >= 1 else f"{size:.1g} %"


def _held(group: PhysicsGroup) -> str:
    """Sentence on what is held in a comparison, and what the other choice would give."""
    found = group.compared
    if found is None:
        return ""
    if found.other is None:
        return _fixed(found.held)
    known = [row for row in found.rows if isfinite(row.other.peak)]
    named = [row for row in known if row.turns] or known
    if not named:
        return f"{found.held.label} is held; what {found.other.label} would give is not known."
    first, *rest = named[:FEW]
    said = [f"{first.fidelity} would be {_signed(first.other.peak)}"]
    said += [f"{row.fidelity} {_signed(row.other.peak)}" for row in rest]
    place = " at the contact"
    there = found.other.label.removesuffix(place)
    there += f" held{place}" if there != found.other.label else " held"
    return f"{found.held.label} is held; with {there} {listed(said)}."


def _fixed(held: Held) -> str:
    return f"The {held.label} is held." if held.coefficient is None else f"{held.label} is held."


def _apart(result: Result, rows: Sequence[Summary], accuracy: float) -> str:
    """Sentence on fidelities none of which is compared with another."""
    if not rows:
        return "Nothing was swept."
    if len(rows) > 1:
        known = [row for row in rows if isfinite(row.peak.amplitude)]
        if not known:
            return "No point of any fidelity was completed."
        units = units_for(result)
        low, high = (pick(known, key=lambda row: row.peak.amplitude) for pick in (min, max))
        ends = (f"{units.lengths(row.peak.amplitude)} ({row.fidelity})" for row in (low, high))
        each = "are of the same physics, so that none is another's measure"
        return f"No two of the {len(rows)} fidelities {each}; peaks from {' to '.join(ends)}."
    return _alone(result, rows[0], accuracy)


def _alone(result: Result, row: Summary, accuracy: float) -> str:
    own = result.estimates.get(row.fidelity)
    found = None if own is None else summary(row.fidelity, own)
    if found and isfinite(found.worst) and found.points:
        off = f"at most {_size(found.worst)} off the full model of {found.modes} modes"
        where = f"at {found.points} of {found.total} points with impacts"
        if found.worst <= accuracy:
            return (
                f"{_name(row, True)} suffice{_s(row, True)} for {percent(accuracy)} ({row.fidelity}, {off}, {where})."
            )
        return f"{row.fidelity} ({counted(row.modes, 'mode')}) is not within {percent(accuracy)}: {off}, {where}."
    if not isfinite(row.peak.amplitude):
        return f"No point of {row.fidelity} was completed."
    units = units_for(result)
    at = f"peak of {units.lengths(row.peak.amplitude)} at {units.frequencies(row.peak.frequency)}"
    return (
        f"{row.fidelity} ({counted(row.modes, 'mode')}) is the only fidelity, and how far it is off is not known; {at}."
    )
