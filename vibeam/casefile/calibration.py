"""Calibration of a case: keys that measured numbers chose ([chosen_by]), and those that a fit estimates ([fit]).

A measured number is one value of one source, whatever it is compared with. It is calibrated in every model that has the
key at the value that it chose; a model that leaves the key out, or has it at another value, predicts it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from vibeam.case.plans import FitKey, FitPlan
from vibeam.casefile.fidelity_changes import field_at
from vibeam.casefile.fields import Count, OneOrSeveral, Quantity, Several
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.quantities import with_unit
from vibeam.casefile.tables.studies import FitTable
from vibeam.casefile.tables.table import not_there
from vibeam.casefile.uncertain import number_of, value_at
from vibeam.casefile.validation import entry_of, units_of
from vibeam.exchange.faults import Complaint, as_shown_in_message

if TYPE_CHECKING:
    from vibeam.casefile.tables.cases import AnyCase


WRITE = "write its bounds as [lowest, highest]"
READ_OFF = ("amplitude", "maximum", "minimum", "reach", "impact_velocity")  # what a fit can read off a branch


def fit_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about [fit]: keys that are none or hold no number, bounds that are none, references not there."""
    if getattr(case, "fit", None) is None:
        return
    model = KINDS[case.kind].declaration()
    for name, bounds in (case.fit.keys or {}).items():
        try:
            read_key(name, bounds, model, case)
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


def plan_of(table: FitTable, case: Any) -> FitPlan:
    """The plan of a checked table."""
    names = table.references or tuple(
        name for name, each in case.reference.items() if each.quantity in (*READ_OFF, None)
    )
    keys = tuple(read_key(name, bounds, KINDS[case.kind].declaration(), case) for name, bounds in table.keys.items())
    return FitPlan(keys, tuple(names), table.unstable or ())


def read_key(name: str, bounds: Any, model: Any, case: Any) -> FitKey:
    """One estimated key with its bounds in SI; ValueError if it is none."""
    entry, own = _entry(name, model), value_at(case, name)
    if not isinstance(own, int | float) or isinstance(own, bool):
        raise ValueError("has no number in this case: write the key itself, with a value to start from")
    if not isinstance(bounds, list | tuple) or len(bounds) != 2:
        raise ValueError(f"must be [lowest, highest], not {as_shown_in_message(bounds)}")
    units = units_of(case.units)
    low, high = (float(entry.read(number_of(each) if isinstance(each, str) else each, units)) for each in bounds)
    if not low < high:
        raise ValueError(f"goes from {low:.6g} to {high:.6g}: {WRITE}")
    return FitKey(name, low, high, min(max(float(own), low), high))


def fit_in_si(case: Any) -> FitTable | None:
    """[fit] of a checked case, its numbers without a unit with that of SI."""
    if case.fit is None:
        return None
    units = units_of(case.units)
    kinds = {name: _entry(name, KINDS[case.kind].declaration()).kind for name in case.fit.keys}
    keys = {name: [with_unit(each, kinds[name], units) for each in bounds] for name, bounds in case.fit.keys.items()}
    settled: FitTable = case.fit.model_copy(update={"keys": keys})
    return settled


def _entry(name: str, model: Any) -> Quantity:
    field, fault = field_at(model, name)
    if fault:
        raise ValueError(fault.replace("a fidelity changes", "a fit changes"))
    entry = None if field is None else entry_of(field)
    if isinstance(entry, Several | OneOrSeveral):
        entry = entry.each
    if not isinstance(entry, Quantity) or isinstance(entry, Count):
        raise ValueError("holds no single number that could be estimated")
    return entry


Models = Mapping[str, Any]  # the cases of those fidelities that change the rig, as declared


def chosen_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about [chosen_by]: keys that are none of the rig, names of no measured number."""
    for key, names in (case.chosen_by or {}).items():
        if fault := field_at(KINDS[case.kind].declaration(), key)[1]:
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
