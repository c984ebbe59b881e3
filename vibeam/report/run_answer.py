"""Answer of a run: which fidelity suffices for an accuracy, what the others miss, and what is held fixed in that.

Nothing is called enough beyond what is known: a fidelity suffices where its peak and its rms distance from the finest
of the same physics are within the accuracy, and the finest one's own distance from its limit is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from math import isfinite
from typing import TYPE_CHECKING, Any

from vibeam.case.held import Held, held_of
from vibeam.casefile.toml_writing import to_toml
from vibeam.figures.units import units_for
from vibeam.runs.comparison.differences import HeldComparison, listed
from vibeam.runs.comparison.limit import GIVEN
from vibeam.runs.estimate.records import WHOLE, EstimateSummary, summary
from vibeam.runs.summary import Summary, compare, stays_clear
from vibeam.system.number_text import begun, modes_in_words, percent
from vibeam_models.arguments import counted
from vibeam_models.scene import line_of

if TYPE_CHECKING:
    from vibeam.runs.result import Result
    from vibeam.system.curves import Difference

USUAL = 0.05  # accuracy where none is asked for
FEW = 3  # fidelities named in one list
LEAST, MOST = 1e-4, 10.0  # differences that are not told in numbers: below, above


@dataclass(frozen=True)
class PhysicsGroup:
    """Fidelities of one physics: the ``finest`` and the ``others``, fewest modes first.

    ``compared``: with either restitution held, None where that was not asked for. ``own``: distance of the finest from
    its limit, at the peak, of the rms without one; NaN where it is not known, 0 where the case gives its one mode and
    it is flown. ``estimates`` against the full model. ``solids``: those in three dimensions; a beam is less than each.
    """

    finest: Summary
    others: tuple[Summary, ...]
    compared: HeldComparison | None
    own: float
    estimates: Mapping[str, EstimateSummary]
    solids: frozenset[str] = frozenset()

    def is_less(self, row: Summary) -> bool:
        """Test whether one of the others is less of a model than the finest, not another solver of it."""
        return row.modes < self.finest.modes or (
            self.finest.fidelity in self.solids and row.fidelity not in self.solids
        )

    def is_within(self, row: Summary, accuracy: float) -> bool:
        """Test whether one of the others is within the accuracy of the finest one, or of its limit where known."""
        rows = () if self.compared is None else self.compared.rows
        margin = next((each.uncertainty[0] for each in rows if each.fidelity == row.fidelity), 0.0)
        off = _off(row)
        known = [abs(each) + (margin if isfinite(margin) else 0.0) for each in (off.peak, off.rms) if isfinite(each)]
        return not _sparse(off) and bool(known) and max(known) <= accuracy

    def worst(self, row: Summary) -> float:
        """Largest difference of a fidelity at one frequency, from the finest or, estimated, from the full model."""
        known = [_off(row).worst, self.estimates[row.fidelity].worst if row.fidelity in self.estimates else 0.0]
        return max((abs(each) for each in known if isfinite(each)), default=0.0)


def _off(row: Summary) -> Difference:
    assert row.distance is not None  # of what is not the finest
    return row.distance


def _sparse(off: Difference) -> bool:
    """Test whether both motions repeat at less than half of the points."""
    return 2 * off.points < off.total


def run_answer(result: Result, accuracy: float = USUAL) -> str:
    """Answer of a result whose comparisons and estimates were made, as far as they are known."""
    rows = compare(result)
    groups = groups_of(result, rows)
    if not any(isfinite(row.peak.amplitude) for row in rows):
        return "No point was completed."
    if not groups:
        return f"{_apart(result, rows, accuracy)} {_fixed(held_of(result.case.scene))}"
    said = [_rig(result, each) * (len(groups) > 1) + _verdict(each, accuracy, len(groups) == 1) for each in groups]
    if all(map(stays_clear, result.values())):
        return " ".join(["Nothing touches the stop.", *said])
    alike = groupby((each.compared for each in groups if each.compared), lambda each: (each.held, each.other))
    return " ".join([*said, *(_held(list(each)) for _, each in alike)])


def _rig(result: Result, group: PhysicsGroup) -> str:
    """Begin of a sentence on one group of several: what its fidelities change of the rig."""
    changes = result.case.fidelities[group.finest.fidelity].rig
    keys = listed([f"{key} = {to_toml(value)}" for key, value in changes.items()])
    return f"With {keys}: " if keys else "Of the case's own rig: "


def groups_of(result: Result, rows: Sequence[Summary]) -> list[PhysicsGroup]:
    """Groups of fidelities that are compared with one another."""
    finest, groups = result.finest, []
    compared = {each.finest: each for each in result.comparisons}
    estimates = {name: summary(name, each) for name, each in result.estimates.items()}
    for top in (row for row in rows if row.fidelity in finest.values()):
        others = [row for row in rows if finest[row.fidelity] == top.fidelity != row.fidelity]
        if others:
            ordered = tuple(sorted(others, key=lambda row: row.modes))
            found = compared.get(top.fidelity)
            names = [each.fidelity for each in (top, *others)]
            solids = frozenset(name for name in names if result.case.scene_of(name).in_three_dimensions)
            groups.append(PhysicsGroup(top, ordered, found, _own(result, top, found), estimates, solids))
    return groups


def _own(result: Result, finest: Summary, found: HeldComparison | None) -> float:
    case, name = result.case, finest.fidelity
    scene: Any = case.scene_of(name)
    whole = scene.given_mode or (_is_whole(result, name) and line_of(scene) is None)
    if finest.peak.point >= 0 and whole and case.fidelities[name].solver == "flight":
        return 0.0
    if finest.peak.point < 0 or found is None or found.limit.why:
        return float("nan")
    return found.limit.held.peak if isfinite(found.limit.held.peak) else found.limit.held.rms


def _is_whole(result: Result, name: str) -> bool:
    """Test whether a fidelity is the full model of its scene."""
    return name in result.estimates and result.estimates[name].whole


def _verdict(group: PhysicsGroup, accuracy: float, modes: bool) -> str:
    """Sentence on one group; ``modes``: numbers of modes name its fidelities."""
    finest, known, within = group.finest, isfinite(group.own), percent(accuracy)
    modes = modes and not group.solids and len({row.modes for row in (finest, *group.others)}) == 1 + len(group.others)
    enough = [row for row in group.others if group.is_within(row, accuracy)]
    misses = "".join(f"; {each}" for each in _missed([row for row in group.others if row not in enough], accuracy))
    if any(map(group.is_less, group.others)):  # else they are solvers of one model
        enough = [row for row in enough if group.is_less(row)]
    if known and abs(group.own) > accuracy:
        top = f"{finest.fidelity}, the finest, is {_from_limit(group)}"
        beside = "; ".join(_missed(group.others, 0.0))
        return f"No fidelity is known to be within {within}: {top}; beside it {beside}."
    unknown = _from_full(group)
    if not enough and _gives_few(group):
        said = "; ".join(_missed(group.others, accuracy, modes))
        return f"{begun(said) if modes else said}. {unknown}."
    if not enough and not known:
        return f"No other fidelity is known to be within {within} of {finest.fidelity}:{misses[1:]}. {unknown}."
    if not enough:
        where = ", ".join([finest.fidelity] * modes + [_from_limit(group)])
        return f"{_name(finest, modes)} suffice{_s([finest], modes)} for {within} ({where}){misses}."
    named = [row for row in enough if row.modes == enough[0].modes]
    said = listed([f"{_name(row, modes)} ({_detail(group, row, accuracy, modes)})" for row in named])
    if known and modes:
        detail = _detail(group, named[0], accuracy, modes)
        return f"{_name(named[0], modes)} suffice{_s(named, modes)} for {within} ({detail}){misses}."
    if known:
        return f"{said} suffice{_s(named, modes)} for {within}{misses}."
    return f"{said} {'is' if _s(named, modes) else 'are'} within {within} of {finest.fidelity}{misses}. {unknown}."


def _s(rows: Sequence[Summary], modes: bool) -> str:
    """Ending of a verb whose subjects are fidelities."""
    return "s" * (len(rows) == 1 and (not modes or rows[0].modes == 1))


def _name(row: Summary, modes: bool) -> str:
    return begun(modes_in_words(row.modes)) if modes else row.fidelity


def _detail(group: PhysicsGroup, row: Summary, accuracy: float, modes: bool) -> str:
    """Name of a fidelity that is called by its modes, its peak, and its largest difference where that is more."""
    apart = [f"up to {_size(group.worst(row))} off at single frequencies"] * (group.worst(row) > accuracy)
    return ", ".join([*[row.fidelity] * modes, _peak(row), *apart])


def _from_limit(group: PhysicsGroup) -> str:
    if group.own == 0.0:
        return "computed exactly"
    side = "above" if group.own > 0 else "below"
    peak = group.compared is not None and isfinite(group.compared.limit.held.peak)
    return f"{_size(group.own)} {f'{side} its own limit at the peak' if peak else 'rms off its own limit'}"


def _from_full(group: PhysicsGroup) -> str:
    """Sentence on the finest whose limit is not known: what is known of its error."""
    name = group.finest.fidelity
    found = group.estimates.get(name)
    if _gives_few(group):
        return f"No reference beyond {modes_in_words(group.finest.modes)}: {GIVEN}"
    reason = f" ({group.compared.limit.why})" if group.compared and group.compared.limit.why else ""
    what = f"{name}, the full model, is off by its mesh" if found and found.why == WHOLE else f"{name} itself is off"
    if found is None or not isfinite(found.worst) or not found.total:
        return f"How far {what} is not known{reason}"
    where = f"known at {found.points} of {found.total} points with impacts"
    return f"The full model of {found.modes} modes is up to {_size(found.worst)} off {name} ({where})"


def _gives_few(group: PhysicsGroup) -> bool:
    """Test whether the case gives the finest one's modes and no more."""
    return group.compared is not None and group.compared.limit.why == GIVEN


def _missed(rows: Sequence[Summary], accuracy: float, modes: bool = False) -> list[str]:
    """Clauses on what the given fidelities miss, one for those of a kind; ``modes``: these name them."""
    sparse = [row for row in rows if _off(row).points and _sparse(_off(row))]
    said = [_miss(row, accuracy, modes) for row in rows if row not in sparse]
    if len(said) > FEW:
        said = [*said[: FEW - 1], f"{len(said) - FEW + 1} more are off as well"]
    clauses = [listed(said)] if said else []
    if sparse:
        few = listed([f"{row.fidelity} ({_peak(row)})" for row in sparse])
        clauses.append(f"{few} repeat{_s(sparse, False)} beside it at less than half of the points")
    return clauses


def _miss(row: Summary, accuracy: float, modes: bool) -> str:
    off, name = _off(row), modes_in_words(row.modes) if modes else row.fidelity
    name += " are" if modes and row.modes > 1 else " is"
    if not isfinite(off.rms):
        return f"{row.fidelity} has no point to compare"
    if isfinite(off.peak) and abs(off.peak) > accuracy and off.rms <= 2 * abs(off.peak):
        return f"{name} {_signed(off.peak)}" + " at the peak" * modes
    beside = f", {_signed(off.peak)} at the peak" if isfinite(off.peak) else ""
    return f"{name} {_size(off.rms)} off (rms){beside}"


def _peak(row: Summary) -> str:
    off = _off(row)
    return f"{_signed(off.peak)} at the peak" if isfinite(off.peak) else f"{_size(off.rms)} off (rms)"


def _signed(value: float) -> str:
    if abs(value) < LEAST:
        return f"off by {_size(value)}"
    return f"{_size(value)} too {'high' if value > 0 else 'low'}"


def _size(value: float) -> str:
    """Size of a difference, to a tenth of a percent; one digit of a small one."""
    if abs(value) < LEAST:
        return f"less than {100 * LEAST:g} %"
    size = 100 * min(abs(value), MOST)
    return "more than " * (abs(value) > MOST) + (f"{round(size, 1):g} %" if size >= 1 else f"{size:.1g} %")


def _held(compared: Sequence[HeldComparison]) -> str:
    """Sentence on what is held alike in comparisons, and what the other choice would give."""
    found = compared[0]
    if found.other is None:
        return _fixed(found.held)
    known = [row for each in compared for row in each.rows if isfinite(row.other.peak)]
    named = ([row for row in known if row.turns] or known)[:FEW]
    if not named:
        return f"{found.held.label} is held; what {found.other.label} would give is not known."
    said = [f"{row.fidelity} {'would be ' * (row is named[0])}{_signed(row.other.peak)}" for row in named]
    symbol, place = found.other.label.partition(" at ")[::2]
    there = f"{symbol} held at {place}" if place else f"{symbol} held"
    return f"{found.held.label} is held; with {there} {listed(said)}."


def _fixed(held: Held) -> str:
    return f"The {held.label} is held." if held.coefficient is None else f"{held.label} is held."


def _apart(result: Result, rows: Sequence[Summary], accuracy: float) -> str:
    """Sentence on fidelities none of which is compared with another."""
    units = units_for(result)
    if len(rows) == 1:
        of = f"{rows[0].fidelity} ({counted(rows[0].modes, 'mode')})"
        peak = f"{units.lengths(rows[0].peak.amplitude)} at {units.frequencies(rows[0].peak.frequency)}"
        exact, whole = _own(result, rows[0], None) == 0.0, _is_whole(result, rows[0].fidelity)
        said = "the full model" if whole else "the mode that the case gives, computed exactly"
        known = said if whole or exact else "alone, and how far it is off is not known"
        return _estimated(result, rows[0], accuracy) or f"{of} is {known}; its peak is {peak}."
    swept = [row for row in rows if isfinite(row.peak.amplitude)]
    low, high = (pick(swept, key=lambda row: row.peak.amplitude) for pick in (min, max))
    ends = " to ".join(f"{units.lengths(row.peak.amplitude)} ({row.fidelity})" for row in (low, high))
    alone = f"No two of the {len(rows)} fidelities are of the same physics, so that none is another's measure"
    return f"{alone}; their peaks are from {ends}."


def _estimated(result: Result, row: Summary, accuracy: float) -> str:
    """Sentence on a single fidelity whose error against the full model is known; else empty."""
    found = summary(row.fidelity, result.estimates[row.fidelity]) if row.fidelity in result.estimates else None
    if found is None or not (found.points and isfinite(found.worst)):
        return ""
    off = f"at most {_size(found.worst)} off the full model of {found.modes} modes"
    where = f"at {found.points} of {found.total} points with impacts"
    if found.worst <= accuracy and found.points == found.total:
        return f"{_name(row, True)} suffice{_s([row], True)} for {percent(accuracy)} ({row.fidelity}, {off}, {where})."
    verdict = "not " * (found.worst > accuracy) + f"within {percent(accuracy)}"
    return f"{row.fidelity} ({counted(row.modes, 'mode')}) is {verdict} where that is known: {off}, {where}."
