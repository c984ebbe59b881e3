"""Answer of a run: which fidelity suffices, what the others miss, and what is held fixed in that.

A fidelity suffices where its response is within what is asked of that of the finest of the same physics: amplitudes,
ends of branches, kinds of motion (``vibeam.runs.comparison.responses``). Nothing is called enough against a reference
that is itself further off, or of which that is not known.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from math import isfinite
from typing import TYPE_CHECKING, Any

from vibeam.case.held import Held, held_of
from vibeam.casefile.toml_writing import to_toml
from vibeam.figures.units import DisplayUnits, units_for
from vibeam.report.comparison_words import Subject, both_numbers, gravest, open_points, signed
from vibeam.runs.comparison.differences import HeldComparison, listed
from vibeam.runs.comparison.errors import FIFTH, GIVEN, Asked, ComparedFidelity
from vibeam.runs.summary import Summary, compare, stays_clear
from vibeam.system.number_text import begun, modes_in_words, percent
from vibeam_models.arguments import counted

if TYPE_CHECKING:
    from vibeam.runs.result import Result

FEW = 3  # fidelities named in one list


@dataclass(frozen=True)
class PhysicsGroup:
    """Fidelities of one physics: the ``finest`` and the ``others``, fewest modes first.

    ``compared``: each of them, by name; ``held``: with either restitution held, None where that was not asked for.
    ``solids``: those in three dimensions; a beam is less than each. ``modes``: numbers of modes name them.
    """

    finest: Summary
    others: tuple[Summary, ...]
    compared: Mapping[str, ComparedFidelity]
    held: HeldComparison | None
    solids: frozenset[str] = frozenset()
    modes: bool = False

    def is_less(self, row: Summary) -> bool:
        """Test whether one of the others is less of a model than the finest, not another solver of it."""
        return row.modes < self.finest.modes or (
            self.finest.fidelity in self.solids and row.fidelity not in self.solids
        )

    @property
    def own(self) -> ComparedFidelity:
        """The finest beside a fuller model."""
        return self.compared[self.finest.fidelity]

    def begun(self, text: str) -> str:
        """Begin of a sentence: names of fidelities stay as they are."""
        return begun(text) if self.modes else text

    def subject(self, row: Summary) -> Subject:
        """A fidelity in a sentence."""
        return Subject(modes_in_words(row.modes), row.modes > 1) if self.modes else Subject(row.fidelity)


def run_answer(result: Result) -> str:
    """Answer of a result by its comparisons."""
    rows = compare(result)
    if not any(isfinite(row.peak.amplitude) for row in rows):
        return "No point was completed."
    groups = groups_of(result, rows)
    if not groups:
        return f"{_apart(result, rows)} {_fixed(held_of(result.case.scene))}"
    units = units_for(result)
    said = [_rig(result, each) * (len(groups) > 1) + _verdict(each, result.asked, units) for each in groups]
    if all(map(stays_clear, result.values())):
        return " ".join(["Nothing touches the stop.", *said])
    alike = groupby((each.held for each in groups if each.held), lambda each: (each.held, each.other))
    return " ".join([*said, *(_held(list(each)) for _, each in alike)])


def _rig(result: Result, group: PhysicsGroup) -> str:
    """Begin of a sentence on one group of several: what its fidelities change of the rig."""
    changes = result.case.fidelities[group.finest.fidelity].rig
    keys = listed([f"{key} = {to_toml(value)}" for key, value in changes.items()])
    return f"With {keys}: " if keys else "Of the case's own rig: "


def groups_of(result: Result, rows: Sequence[Summary]) -> list[PhysicsGroup]:
    """Groups of fidelities that are compared with one another."""
    finest, groups = result.finest, []
    held = {each.finest: each for each in result.comparisons}
    compared = {each.fidelity: each for each in result.compare()}
    tops = [row for row in rows if row.fidelity in finest.values()]
    for top in tops:
        others = [row for row in rows if finest[row.fidelity] == top.fidelity != row.fidelity]
        if others:
            names = [each.fidelity for each in (top, *others)]
            solids = frozenset(name for name in names if result.case.scene_of(name).in_three_dimensions)
            distinct = not solids and len({row.modes for row in (top, *others)}) == len(names)
            ordered = tuple(sorted(others, key=lambda row: row.modes))
            groups.append(PhysicsGroup(top, ordered, compared, held.get(top.fidelity), solids, distinct))
    if len(groups) > 1:
        return [PhysicsGroup(each.finest, each.others, compared, each.held, each.solids) for each in groups]
    return groups


def _verdict(group: PhysicsGroup, asked: Asked, units: DisplayUnits) -> str:
    """Sentences on one group."""
    within, own = percent(asked.amplitude), group.own.suffices(asked)
    known = {row.fidelity: group.compared[row.fidelity].suffices(asked) for row in group.others}
    less = [row for row in group.others if group.is_less(row)] or list(group.others)
    enough = [row for row in less if known[row.fidelity]]
    rest = [row for row in group.others if row not in enough[:1]]
    misses = _missed(group, [row for row in rest if known[row.fidelity] is False], asked, units)
    may = [f"{group.subject(row).name} may suffice ({_open(group, row, asked, units)})"
           for row in less if known[row.fidelity] is None and not enough]  # fmt: skip
    top = group.subject(group.finest)
    reference = group.begun(own_words(top, group.own, asked, units))
    if own is False:
        finest = Subject(f"{top.name}, the finest,", top.plural)
        said = f"No fidelity suffices for {within}: {own_miss(finest, group.own, asked, units)}."
        return " ".join(filter(None, [said, _ended(group, [*may, *misses])]))
    if enough:
        who, numbers = group.subject(enough[0]), _numbers(group, enough[0], units)
        if own:
            said = f"{group.begun(who.name)} {who.does('suffice')} for {within}: {numbers}."
        else:
            said = f"{group.begun(who.name)} {who.is_} within {within} of {top.name}: {numbers}."
        return " ".join(filter(None, [said, reference, _ended(group, misses)]))
    if own:
        said = f"{group.begun(top.name)} {top.does('suffice')} for {within}{_own_numbers(group, units)}."
    else:
        said = f"No other fidelity is known to be within {within} of {top.name}. {reference}"
    return " ".join(filter(None, [said, _ended(group, [*may, *misses])]))


def _ended(group: PhysicsGroup, clauses: Sequence[str]) -> str:
    """Clauses as a sentence, which names of fidelities begin as they are."""
    return f"{group.begun('; '.join(clauses))}." if clauses else ""


def _numbers(group: PhysicsGroup, row: Summary, units: DisplayUnits) -> str:
    found = group.compared[row.fidelity].comparison
    return "the same" if found is None else both_numbers(found, units)


def _open(group: PhysicsGroup, row: Summary, asked: Asked, units: DisplayUnits) -> str:
    found = group.compared[row.fidelity].comparison
    return "not compared" if found is None else open_points(found, asked, units)


def _missed(group: PhysicsGroup, rows: Sequence[Summary], asked: Asked, units: DisplayUnits) -> list[str]:
    """Clauses on what the given fidelities miss."""
    top = group.subject(group.finest)
    said = [
        gravest(group.subject(row), top, found, asked, units)
        for row in rows if (found := group.compared[row.fidelity].comparison) is not None
    ]  # fmt: skip
    return said if len(said) <= FEW else [*said[: FEW - 1], f"{len(said) - FEW + 1} more are off as well"]


def beyond(own: ComparedFidelity) -> Subject:
    """A fuller model, or the limit that it leads to, in a sentence."""
    if own.limit:
        return Subject(f"infinitely many modes (by {modes_in_words(own.modes)})", plural=True)
    mesh = f" on {own.elements} elements" if own.elements else ""
    return Subject(f"{modes_in_words(own.modes)}{mesh}", own.modes > 1)


def own_miss(who: Subject, own: ComparedFidelity, asked: Asked, units: DisplayUnits) -> str:
    """Clause on a model that is itself further off a fuller one than is asked."""
    assert own.comparison is not None  # it does not suffice
    clause, fuller = gravest(who, beyond(own), own.comparison, asked, units), beyond(own).name
    return clause if fuller in clause else f"{clause} beside {fuller}"


def own_words(who: Subject, own: ComparedFidelity, asked: Asked, units: DisplayUnits) -> str:
    """Sentence on the own error of a reference that is more than a fifth of what is asked, or not known; else empty."""
    found, enough = own.comparison, own.suffices(asked)
    if own.why == GIVEN:
        return f"What further modes would change is not known: {GIVEN}."
    if found is None:
        return "" if own.whole else f"How far {who.name} {who.is_} off is not known{f' ({own.why})' * bool(own.why)}."
    if enough is None:
        fuller = beyond(own).name
        return f"Whether {who.name} {who.does('suffice')} is open beside {fuller}: {open_points(found, asked, units)}."
    if not enough or found.worst(asked) <= FIFTH:
        return ""
    return f"{who.name}, the reference, {who.is_} off as well: {both_numbers(found, units)}, beside {beyond(own).name}."


def _own_numbers(group: PhysicsGroup, units: DisplayUnits) -> str:
    """Error of the finest in brackets, as far as it is known."""
    found = group.own.comparison
    if found is None:
        return " (all that the case gives)"
    return f" ({both_numbers(found, units)}, beside {beyond(group.own).name})"


def _held(compared: Sequence[HeldComparison]) -> str:
    """Sentence on what is held alike in comparisons, and what the other choice would give."""
    found = compared[0]
    if found.other is None:
        return _fixed(found.held)
    known = [row for each in compared for row in each.rows if isfinite(row.other)]
    named = ([row for row in known if row.turns] or known)[:FEW]
    if not named:
        return f"{found.held.label} is held; what {found.other.label} would give is not known."
    said = [f"{row.fidelity} {'would be ' * (row is named[0])}{signed(row.other)}" for row in named]
    symbol, place = found.other.label.partition(" at ")[::2]
    there = f"{symbol} held at {place}" if place else f"{symbol} held"
    return f"{found.held.label} is held; with {there} {listed(said)} at the peak."


def _fixed(held: Held) -> str:
    return f"The {held.label} is held." if held.coefficient is None else f"{held.label} is held."


def _apart(result: Result, rows: Sequence[Summary]) -> str:
    """Sentence on fidelities none of which is compared with another."""
    units = units_for(result)
    if len(rows) == 1:
        return _alone(result, rows[0], units)
    swept = [row for row in rows if isfinite(row.peak.amplitude)]
    low, high = (pick(swept, key=lambda row: row.peak.amplitude) for pick in (min, max))
    ends = " to ".join(f"{units.lengths(row.peak.amplitude)} ({row.fidelity})" for row in (low, high))
    alone = f"No two of the {len(rows)} fidelities are of the same physics, so that none is another's measure"
    return f"{alone}; their peaks are from {ends}."


def _alone(result: Result, row: Summary, units: DisplayUnits) -> str:
    """Sentence on a single fidelity."""
    [own] = result.compare()
    of = f"{row.fidelity} ({counted(row.modes, 'mode')})"
    asked: Any = result.asked
    within, who = percent(asked.amplitude), Subject(of)
    if own.comparison is not None:
        found, state = own.comparison, own.suffices(asked)
        if state is None:
            return f"{of} may suffice for {within}: {open_points(found, asked, units)}, beside {beyond(own).name}."
        if state:
            return f"{of} suffices for {within}: {both_numbers(found, units)}, beside {beyond(own).name}."
        return f"{own_miss(who, own, asked, units)}: it does not suffice for {within}."
    peak = f"{units.lengths(row.peak.amplitude)} at {units.frequencies(row.peak.frequency)}"
    known = "all that the case gives, computed exactly" if own.whole else "alone, and how far it is off is not known"
    return f"{of} is {known}; its peak is {peak}."
