"""What the keys of the studies, of cost, influence and an accuracy, say together with the rest of a case."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace

from vibeam.checks.names import named_fidelity, not_there
from vibeam.faults import shown
from vibeam.reading import Complaint


def study_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about the studies that a case asks for."""
    yield from _cost(case)
    if getattr(case, "influence", None) is not None:
        yield from named_fidelity(case, ("influence", "fidelity"), case.influence.fidelity)
    yield from _accuracy(case)


def _cost(case: SimpleNamespace) -> Iterator[Complaint]:
    if case.cost is None:
        return
    if case.cost.modes and not hasattr(case, "beam"):
        yield ("cost", "modes"), "a single degree of freedom has one mode: leave this out"
    name, path = case.cost.reference, ("cost", "reference")
    if name is None:
        return
    if name not in case.reference:
        yield path, f"no reference {not_there(name, case.reference)}"
    elif case.reference[name].quantity not in ("amplitude", None):
        yield path, f"{shown(name)} gives {case.reference[name].quantity}: accuracy is that of the amplitude"


def _accuracy(case: SimpleNamespace) -> Iterator[Complaint]:
    if case.accuracy is None:
        if case.accuracy_of is not None:
            yield ("accuracy_of",), 'goes with an accuracy: write accuracy = "1 %" beside it'
    elif "accuracy" in case.fidelity:
        yield ("fidelity", "accuracy"), "the name is that of the result where an accuracy is asked for: choose another"
