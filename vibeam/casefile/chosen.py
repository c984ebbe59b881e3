"""Provenance of keys: [chosen_by] names the measured numbers that chose a key, which the model then cannot predict.

A measured number is one value of one source, whatever it is compared with. It is calibrated in every model that has the
key at the value that it chose; a model that leaves the key out, or has it at another value, predicts it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from vibeam.case.faults import Complaint, as_shown_in_message
from vibeam.casefile.fidelity_changes import field_at
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.tables.names import not_there
from vibeam.casefile.uncertain import value_at

if TYPE_CHECKING:
    from types import SimpleNamespace

    from vibeam.casefile.tables.cases import AnyCase

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
