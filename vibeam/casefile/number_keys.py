"""Keys that hold one number: uncertain ones, those that a fit estimates, and those that measured numbers chose.

An uncertain input is ``"± 0.1 mm"``, ``"0.2 kg ± 2 g"`` or ``"0.6 … 0.8"`` of any number of the rig ([uncertain]); a
fit has bounds of such numbers ([fit]). A measured number is one value of one source, whatever it is compared with
([chosen_by]). It is calibrated in every model that has the key at the value that it chose; a model that leaves the key
out, or has it at another value, predicts it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from types import SimpleNamespace
from typing import Any

from vibeam.case.study_plans import FitKey, FitPlan, Uncertain
from vibeam.casefile.fidelity_changes import entry_at, field_at
from vibeam.casefile.fields import Quantity
from vibeam.casefile.quantities import RATIO, Range, to_si, with_unit
from vibeam.casefile.tables.cases import AnyCase
from vibeam.casefile.tables.table import not_there
from vibeam.casefile.toml import key_parts
from vibeam.casefile.validation import units_of
from vibeam.exchange.faults import Complaint, as_shown_in_message

OF_UNCERTAIN, OF_FIT = ("uncertain may be", "uncertain"), ("a fit changes", "estimated")  # in words of faults


def number_entry(key: str, case: Any, words: tuple[str, str]) -> Quantity:
    """Entry of a key that holds one number; ValueError, in ``words``, where it holds none."""
    entry, fault = entry_at(type(case), key)
    if fault:
        raise ValueError(fault.replace("a fidelity changes", words[0]))
    if not isinstance(entry, Quantity):
        raise ValueError(f"holds no single number that could be {words[1]}")
    return entry


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


SPREAD = re.compile(r"\s*(?P<middle>.*?)\s*(?:±|\+/-|\+-)\s*(?P<spread>.+?)\s*", re.DOTALL)
INTERVAL = re.compile(r"\s*(?P<low>.+?)\s*(?:…|\.\.\.)\s*(?P<high>.+?)\s*", re.DOTALL)
WRITE_SPREAD = 'write "± 0.1 mm" (a standard deviation, about the case\'s own value), "± 2 %", or a range "0.6 … 0.8"'
FAR = 5.0  # standard deviations within which a normal distribution must be allowed
SAME = 1e-9  # relative difference of a middle and the case's own value that is round-off


def uncertain_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about [uncertain]: keys that hold no number or have no value; distributions that are none."""
    for key, text in (case.uncertain or {}).items():
        try:
            read_uncertain(key, text, case)
        except ValueError as fault:
            yield ("uncertain", key), str(fault)


def uncertain_inputs(case: AnyCase) -> tuple[Uncertain, ...]:
    """All uncertain inputs of a declared case."""
    return tuple(read_uncertain(key, text, case) for key, text in (case.uncertain or {}).items())


def read_uncertain(key: str, text: Any, case: Any) -> Uncertain:
    """One uncertain input; ``case``: the declared case, or what could be read of it. ValueError if it is none."""
    entry = number_entry(key, case, OF_UNCERTAIN)
    own = value_at(case, key)
    if not isinstance(own, int | float) or isinstance(own, bool):
        raise ValueError("has no number in this case: write the key itself first")
    if not isinstance(text, str):
        raise ValueError(f"must be text, not {as_shown_in_message(text)}: {WRITE_SPREAD}")
    if found := SPREAD.fullmatch(text):
        return _normal(key, _with_units(found, entry, case), entry, float(own))
    if found := INTERVAL.fullmatch(text):
        return _uniform(key, *(entry.parse(number_of(each)) for each in _with_units(found, entry, case).values()))
    raise ValueError(f"{as_shown_in_message(text)} is no distribution: {WRITE_SPREAD}")


def uncertain_in_si(case: Any) -> dict[str, str]:
    """[uncertain] of a checked case, its numbers without a unit with that of SI."""
    return {key: _in_si(text, number_entry(key, case, OF_UNCERTAIN), case) for key, text in case.uncertain.items()}


def _in_si(text: str, entry: Quantity, case: Any) -> str:
    found, sign = SPREAD.fullmatch(text), "±"
    if not found:
        found, sign = INTERVAL.fullmatch(text), "…"
    return text if not found else f" {sign} ".join(_with_units(found, entry, case).values()).strip()


def _with_units(found: re.Match[str], entry: Quantity, case: Any) -> dict[str, str]:
    """The parts of a distribution, a number without a unit with that of SI."""
    units = units_of(case.units)
    return {name: str(with_unit(number_of(part), entry.kind, units)) for name, part in found.groupdict().items()}


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


WRITE = "write its bounds as [lowest, highest]"
READ_OFF = ("amplitude", "maximum", "minimum", "reach", "impact_velocity")  # what a fit can read off a branch


def fit_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about [fit]: keys that are none or hold no number, bounds that are none, references not there."""
    if getattr(case, "fit", None) is None:
        return
    for name, bounds in (case.fit.keys or {}).items():
        try:
            read_key(name, bounds, case)
        except ValueError as fault:
            yield ("fit", "keys", name), str(fault)
    for part in ("references", "unstable"):
        for number, name in enumerate(getattr(case.fit, part) or ()):
            yield from _reference(case, ("fit", part, number), name)


def _reference(case: SimpleNamespace, path: Any, name: str) -> Iterator[Complaint]:
    if name not in (case.reference or {}):
        yield path, f"no reference {not_there(name, case.reference or {})}"
    elif case.reference[name].quantity not in (*READ_OFF, None):
        told = f"{as_shown_in_message(name)} gives {case.reference[name].quantity}"
        yield path, f"{told}: a fit takes {', '.join(READ_OFF)}"


def fit_plan(case: Any) -> FitPlan | None:
    """The plan of [fit] of a checked case; None where it has none."""
    if case.fit is None:
        return None
    usual = (name for name, each in case.reference.items() if each.quantity in (*READ_OFF, None))
    keys = tuple(read_key(name, bounds, case) for name, bounds in case.fit.keys.items())
    return FitPlan(keys, tuple(case.fit.references or usual), case.fit.unstable or ())


def read_key(name: str, bounds: Any, case: Any) -> FitKey:
    """One estimated key with its bounds in SI; ValueError if it is none."""
    entry, own = number_entry(name, case, OF_FIT), value_at(case, name)
    if not isinstance(own, int | float) or isinstance(own, bool):
        raise ValueError("has no number in this case: write the key itself, with a value to start from")
    if not isinstance(bounds, list | tuple) or len(bounds) != 2:
        raise ValueError(f"must be [lowest, highest], not {as_shown_in_message(bounds)}")
    units = units_of(case.units)
    low, high = (float(entry.read(number_of(each) if isinstance(each, str) else each, units)) for each in bounds)
    if not low < high:
        raise ValueError(f"goes from {low:.6g} to {high:.6g}: {WRITE}")
    return FitKey(name, low, high, min(max(float(own), low), high), entry.kind.unit)


def fit_in_si(case: Any) -> Any:
    """[fit] of a checked case, its numbers without a unit with that of SI."""
    units = units_of(case.units)
    kinds = {name: number_entry(name, case, OF_FIT).kind for name in case.fit.keys}
    keys = {name: [with_unit(each, kinds[name], units) for each in bounds] for name, bounds in case.fit.keys.items()}
    return case.fit.with_(keys=keys)


Models = Mapping[str, Any]  # the cases of those fidelities that change the rig, as declared


def chosen_checks(case: AnyCase) -> Iterator[Complaint]:
    """Complaints about [chosen_by]: keys that are none of the rig, names of no measured number."""
    for key, names in (case.chosen_by or {}).items():
        if fault := field_at(type(case), key)[1]:
            yield ("chosen_by", key), fault.replace("a fidelity changes", "a measured number chooses")
        elif not isinstance(names, list) or not names or not all(isinstance(each, str) for each in names):
            shown = "an empty list" if names == [] else as_shown_in_message(names)
            yield ("chosen_by", key), f'must be a list of names of [measured.NAME], not {shown}: write ["peak"]'
        else:
            for name in (each for each in names if each not in case.measured):
                yield ("chosen_by", key), f"no [measured.NAME] called {not_there(name, case.measured)}"


def absent_checks(case: AnyCase, models: Models) -> Iterator[Complaint]:
    """Complaints about keys that the model of a number that chose them does not have."""
    for key, names in (case.chosen_by or {}).items():
        for name in names:
            fidelity = case.measured[name].fidelity
            if value_at(models.get(fidelity, case), key) is None:
                told = f"measured.{name} is of fidelity {fidelity}, which has no {key}: name a number of one that has"
                yield ("chosen_by", key), told


def keys_chosen(name: str, case: AnyCase, models: Models) -> tuple[str, ...]:
    """Keys of the model that a measured number is compared with which this very number chose."""
    mine, keys = case.measured[name], case.chosen_by or {}

    def model(number: Any) -> Any:
        return models.get(number.fidelity, case)

    def same(other: Any) -> bool:
        return (other.value.number, other.against, other.source) == (mine.value.number, mine.against, mine.source)

    numbers = {key: filter(same, (case.measured[each] for each in names)) for key, names in keys.items()}
    return tuple(
        key
        for key, named in numbers.items()
        if any(value_at(model(each), key) == value_at(model(mine), key) for each in named)
    )
