"""Errors of one response against another in words: both numbers, the gravest of them, what is not known."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil, floor, inf, log10

from vibeam.figures.units import DisplayUnits
from vibeam.periodic.motion_kind import IRREGULAR, SteadyKind
from vibeam.runs.comparison.ends import SweptEnd
from vibeam.runs.comparison.errors import AmplitudeError, Asked, EndError, KindDifference, ResponseComparison

LEAST, MOST = 1e-4, 10.0  # differences that are not written as numbers: below, above
SDOF = "sdof"  # mark of one degree of freedom along the static deflection
NOUNS = {
    "contact begins": "first contact", "contact is lost": "loss of contact", "jump": "jump",
    "motion stops repeating": "end of repetition", "motion repeats": "return of repetition",
    "period doubles": "doubling of the period", "period changes": "change of period",
    "impacts a period change": "change of impacts a period",
}  # fmt: skip
VERBS = {
    "contact begins": ("touch", "the stop"), "contact is lost": ("leave", "the stop"), "jump": ("jump", ""),
    "motion stops repeating": ("stop", "repeating"), "motion repeats": ("repeat", "again"),
    "period doubles": ("double", "the period"), "period changes": ("change", "the period"),
    "impacts a period change": ("change", "the impacts a period"),
}  # fmt: skip


def size(value: float) -> str:
    """Size of a difference, to a tenth of a percent; one digit of a small one."""
    if abs(value) < LEAST:
        return f"less than {100 * LEAST:g} %"
    share = 100 * min(abs(value), MOST)
    return "more than " * (abs(value) > MOST) + (f"{round(share, 1):g} %" if share >= 1 else f"{share:.1g} %")


def bound(value: float) -> str:
    """Bound of a size to one digit, rounded up."""
    step = 10.0 ** floor(log10(max(value, LEAST)))
    return size(ceil(round(value / step, 6)) * step)


def signed(value: float) -> str:
    """Difference with its direction."""
    if abs(value) < LEAST:
        return f"off by {size(value)}"
    return f"{size(value)} too {'high' if value > 0 else 'low'}"


@dataclass(frozen=True)
class Subject:
    """Subject of a sentence: the ``name`` of a model or its modes, in the ``plural`` or not."""

    name: str
    plural: bool = False

    def does(self, verb: str) -> str:
        """Verb in the third person."""
        return verb if self.plural else f"{verb}es" if verb.endswith("ch") else f"{verb}s"

    @property
    def is_(self) -> str:
        """To be, in its number."""
        return "are" if self.plural else "is"

    @property
    def has(self) -> str:
        """To have, in its number."""
        return "have" if self.plural else "has"


def both_numbers(found: ResponseComparison, units: DisplayUnits) -> str:
    """Both errors: ``amplitudes within 3.3 %, the jump down 0.4 % late (184.1 for 183.4 Hz)``."""
    parts = [] if found.amplitude is None else [f"amplitudes within {spread(found.amplitude)}"]
    if found.ends:
        first = found.ends[0]
        parts.append(
            f"the {_noun(first.ours)} {_moved(first, units)}" if _is_known(first)
            else f"ends of branches within {bound(abs(first.error) + first.open)}"
        )  # fmt: skip
    return ", ".join(parts) or "no contact in either"


def spread(found: AmplitudeError) -> str:
    """Size of an error of amplitudes, with two standard errors where motions do not repeat."""
    return size(found.error) + (f" ± {size(2 * found.scatter)}" if 0 < found.scatter < inf else "")


def gravest(who: Subject, other: Subject, found: ResponseComparison, asked: Asked, units: DisplayUnits) -> str:
    """Clause on the largest of the errors, in units of what is asked."""
    amplitude, frequency, kind = found.shares(asked)
    if found.kinds and kind >= max(amplitude, frequency):
        return _difference(who, other, found.kinds[0], units)
    if found.ends and frequency >= amplitude and _is_known(found.ends[0]):
        verb, rest = VERBS[found.ends[0].ours.event]
        verb, rest = ("jump", _way(found.ends[0].ours)) if found.ends[0].ours.jumps else (verb, rest)
        return " ".join(filter(None, [who.name, who.does(verb), rest, _moved(found.ends[0], units)]))
    if found.amplitude is None:
        return f"{who.name} {who.has} no motion to compare"
    return f"{who.name} {who.is_} {signed(found.amplitude.error)} at {units.frequencies(found.amplitude.frequency)}"


def open_points(found: ResponseComparison, asked: Asked, units: DisplayUnits) -> str:
    """Clause on a comparison that leaves open whether a model suffices."""
    return "; ".join(_open(found, asked, units))


def _open(found: ResponseComparison, asked: Asked, units: DisplayUnits) -> Iterator[str]:
    for way, low, high in found.unknown[:1]:
        yield f"points failed from {_range(low, high, units)} on the way {way}"
    for each in (each for each in found.ends if abs(each.error) <= asked.frequency < abs(each.error) + each.open):
        yield f"the {_noun(each.ours)} at {units.frequencies(each.reference.frequency)} is known to ± {size(each.open)}"
        return
    for other in found.kinds:
        yield f"{other.ours} or {other.reference} at {_range(other.low, other.high, units)}"
        return
    if found.scattered is not None and found.scattered.scatter:
        said = f"scatter by {size(2 * error)}" if (error := found.scattered.scatter) < inf else "were read but once"
        yield f"motions that do not repeat {said} at {units.frequencies(found.scattered.frequency)}"


def _is_known(end: EndError) -> bool:
    """Test whether an end is surely at another place."""
    return abs(end.error) > max(end.open, LEAST)


def _noun(end: SweptEnd) -> str:
    return f"jump {_way(end)}" if end.jumps else NOUNS[end.event]


def _way(end: SweptEnd) -> str:
    return "up" if end.step > 0 else "down"


def _moved(end: EndError, units: DisplayUnits) -> str:
    ours, theirs = (units.frequencies(each.frequency) for each in (end.ours, end.reference))
    unit = f" {units.frequency}" if units.frequency else ""
    return f"{size(end.error)} {'late' if end.late else 'early'} ({ours.removesuffix(unit)} for {theirs})"


def _range(low: float, high: float, units: DisplayUnits) -> str:
    unit = f" {units.frequency}" if units.frequency else ""
    return f"{units.frequencies(low).removesuffix(unit)} to {units.frequencies(high)}"


def _difference(who: Subject, other: Subject, found: KindDifference, units: DisplayUnits) -> str:
    """Clause on a difference in kind."""
    ours, theirs = _makes(who, found.ours), _makes(other, found.reference)
    way = "" if found.direction == "up" else " swept down"
    return f"{who.name} {ours} from {_range(found.low, found.high, units)}{way}, where {other.name} {theirs}"


def _makes(who: Subject, kind: SteadyKind) -> str:
    if kind.repeats:
        return f"{who.has} {kind}"
    return f"{'do' if who.plural else 'does'} not repeat" if kind.periods == IRREGULAR else f"{who.has} no contact"


def cells(found: ResponseComparison | None) -> tuple[str, str, str]:
    """Both errors and the width of the widest difference in kind, for a table."""
    if found is None:
        return "–", "–", "–"
    amplitude = "–" if found.amplitude is None else _short(found.amplitude_error)
    ends = _short(found.frequency_error) if found.ends else "–"
    return amplitude, ends, _short(found.kind_width) if found.kinds else "–"


def _short(value: float) -> str:
    return size(value).replace("less than", "<").replace("more than", ">")
