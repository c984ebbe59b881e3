"""Uncertain inputs of a case: ``"± 0.1 mm"``, ``"0.2 kg ± 2 g"``, ``"0.6 … 0.8"`` of any number of the rig."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from vibeam.case.plans import Uncertain
from vibeam.casefile.fidelity_changes import field_at
from vibeam.casefile.fields import OneOrSeveral, Quantity, Range, Several
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.quantities import RATIO, to_si, with_unit
from vibeam.casefile.toml import key_parts
from vibeam.casefile.validation import entry_of, units_of
from vibeam.exchange.faults import Complaint, as_shown_in_message

if TYPE_CHECKING:
    from types import SimpleNamespace

    from vibeam.casefile.tables.cases import AnyCase

SPREAD = re.compile(r"\s*(?P<middle>.*?)\s*(?:±|\+/-|\+-)\s*(?P<spread>.+?)\s*", re.DOTALL)
INTERVAL = re.compile(r"\s*(?P<low>.+?)\s*(?:…|\.\.\.)\s*(?P<high>.+?)\s*", re.DOTALL)
WRITE = 'write "± 0.1 mm" (a standard deviation, about the case\'s own value), "± 2 %", or a range "0.6 … 0.8"'
FAR = 5.0  # standard deviations within which a normal distribution must be allowed
SAME = 1e-9  # relative difference of a middle and the case's own value that is round-off


def uncertain_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about [uncertain]: keys that hold no number or have no value; distributions that are none."""
    for key, text in (case.uncertain or {}).items():
        try:
            read_uncertain(key, text, KINDS[case.kind].declaration(), case)
        except ValueError as fault:
            yield ("uncertain", key), str(fault)


def uncertain_inputs(case: AnyCase) -> tuple[Uncertain, ...]:
    """All uncertain inputs of a declared case."""
    return tuple(read_uncertain(key, text, type(case), case) for key, text in (case.uncertain or {}).items())


def read_uncertain(key: str, text: Any, model: Any, case: Any) -> Uncertain:
    """One uncertain input; ``case``: the declared case, or what could be read of it. ValueError if it is none."""
    entry = _entry(key, model)
    own = value_at(case, key)
    if not isinstance(own, int | float) or isinstance(own, bool):
        raise ValueError("has no number in this case: write the key itself first")
    if not isinstance(text, str):
        raise ValueError(f"must be text, not {as_shown_in_message(text)}: {WRITE}")
    if found := SPREAD.fullmatch(text):
        return _normal(key, _with_units(found, entry, case), entry, float(own))
    if found := INTERVAL.fullmatch(text):
        return _uniform(key, *(entry.parse(number_of(each)) for each in _with_units(found, entry, case).values()))
    raise ValueError(f"{as_shown_in_message(text)} is no distribution: {WRITE}")


def uncertain_in_si(case: Any) -> dict[str, str]:
    """[uncertain] of a checked case, its numbers without a unit with that of SI."""
    return {key: _in_si(text, _entry(key, type(case)), case) for key, text in (case.uncertain or {}).items()}


def _in_si(text: str, entry: Quantity, case: Any) -> str:
    found, sign = SPREAD.fullmatch(text), "±"
    if not found:
        found, sign = INTERVAL.fullmatch(text), "…"
    return text if not found else f" {sign} ".join(_with_units(found, entry, case).values()).strip()


def _with_units(found: re.Match[str], entry: Quantity, case: Any) -> dict[str, str]:
    """The parts of a distribution, a number without a unit with that of SI."""
    units = units_of(case.units)
    return {name: str(with_unit(number_of(part), entry.kind, units)) for name, part in found.groupdict().items()}


def _entry(key: str, model: Any) -> Quantity:
    field, fault = field_at(model, key)
    entry = None if field is None else entry_of(field)
    if fault:
        raise ValueError(fault.replace("a fidelity changes", "uncertain may be"))
    if isinstance(entry, Several | OneOrSeveral):
        entry = entry.each
    if not isinstance(entry, Quantity):
        raise ValueError("holds no single number that could be uncertain")
    return entry


def _normal(key: str, parts: Mapping[str, str], entry: Quantity, own: float) -> Uncertain:
    middle, spread = parts["middle"], parts["spread"]
    if middle and abs(entry.parse(number_of(middle)) - own) > SAME * abs(own):
        raise ValueError(
            f"{as_shown_in_message(middle)} is not the value of the case itself, {own:.9g} in SI units: "
            "make the two the same, or leave it away"
        )
    share = spread.endswith("%")
    deviation = abs(own) * to_si(spread, RATIO) if share else Quantity(entry.kind, Range(0)).parse(number_of(spread))
    if not deviation > 0:
        raise ValueError(f"{as_shown_in_message(spread)}: a standard deviation is above 0, of a value that is not 0")
    for end in (own - FAR * deviation, own + FAR * deviation):
        try:
            entry.range.check(end, f"{end:.6g}")
        except ValueError as fault:
            raise ValueError(f"{FAR:g} standard deviations from {own:.6g}, {fault}: write a range instead") from None
    return Uncertain(key, "normal", own, deviation)


def _uniform(key: str, low: float, high: float) -> Uncertain:
    if not low < high:
        raise ValueError(f"a range goes from the lower value to the higher one, not from {low:.6g} to {high:.6g}")
    return Uncertain(key, "uniform", low, high)


def number_of(text: str) -> float | str:
    """A number without a unit as such, so that it is in SI; else the text."""
    try:
        return float(text)
    except ValueError:
        return text


def value_at(case: Any, key: str) -> Any:
    """Value at a dotted key of tables, records or lists; None where there is none."""
    found = case
    for part in key_parts(key):
        if isinstance(found, Mapping):
            found = found.get(part)
        elif isinstance(found, list | tuple):
            found = found[int(part)] if part.isdigit() and int(part) < len(found) else None
        else:
            found = getattr(found, part, None)
    return found[0] if isinstance(found, tuple) and len(found) == 1 else found
