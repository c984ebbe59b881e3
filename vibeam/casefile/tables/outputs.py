"""Tables of further outputs, sensors along the beam; rules of them and of whoever asks for an output by its name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import SimpleNamespace
from typing import Any

from vibeam.casefile.fields import TEXT, ValueEntry, Word
from vibeam.casefile.tables.declared import table
from vibeam.casefile.tables.effects import platform_output
from vibeam.casefile.tables.table import NAME, OUTPUTS, declared_key, plan_keys
from vibeam.exchange.faults import Complaint, KeyPath, as_shown_in_message, suggestion
from vibeam.figures import OF_OUTPUT
from vibeam.figures.declaration import FigureKind
from vibeam.solvers import SOLVERS
from vibeam_models.keys import keys_of
from vibeam_models.laws import CONSTANT, LAWS
from vibeam_models.outputs import DISPLACEMENT, OUTPUT_QUANTITIES, Output, OutputQuantity

OF_OPPOSITE = ("opposite", "opposite_tip")  # outputs of a case with a second beam
RESERVED = (*OUTPUTS, *OF_OPPOSITE)


#: name of an output that every case of the kind has (the words are for completion), or of one of its [output.NAME]
OUTPUT_NAME = ValueEntry(
    TEXT.parse,
    f"{Word(OUTPUTS).describe()} | one of [output.NAME] | with [opposite] {Word(OF_OPPOSITE).describe()}",
    {"anyOf": [{"enum": list(OUTPUTS)}, TEXT.schema()]},
)


OutputTable = table(
    "OutputTable",
    "A further output, one table each: what a sensor reads at a place, relative to the base but for absolute.",
    plan_keys(Output) | {"absolute": declared_key(keys_of(Output)["absolute"], None)},
)


def output_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about every [output.NAME]."""
    for name, each in (case.output or {}).items():
        path: KeyPath = ("output", name)
        if name in RESERVED:
            yield path, f'the name "{name}" is that of an output that cases have of themselves: choose another'
        elif not NAME.fullmatch(name):
            yield path, f"the name {as_shown_in_message(name)} must be 1 to 64 letters, digits, - or _"
        length = case.beam.length
        if None not in (length, each.position) and each.position > length:
            yield (*path, "position"), f"{each.position:g} m is beyond the tip: beam.length is {length:g} m"
        yield from _keys(case, path, each)


def _keys(case: SimpleNamespace, path: KeyPath, said: SimpleNamespace) -> Iterator[Complaint]:
    if said.quantity == "strain":
        unknown = "" if said.distance is not None or said.position is None else _unknown(case, said.position)
        if unknown:
            yield (*path, "distance"), f'missing ({unknown}): write distance = "0.5 mm"'
        if said.distance == 0:
            yield (*path, "distance"), "is 0: the neutral axis is not strained by bending"
    elif said.distance is not None:
        yield (*path, "distance"), 'is of a strain gauge: write quantity = "strain", or leave it away'
    if said.absolute is not None and said.quantity != "acceleration":
        yield (*path, "absolute"), 'goes with quantity = "acceleration" alone: all else is relative to the base'


def _unknown(case: SimpleNamespace, x: float) -> str:
    """Why the distance of the surface from the neutral axis is not known at ``x``; empty where it is."""
    if any(plate.stiffens is not False for plate in _over(case.plate, x)):
        return "a plate is bonded there"
    shape = next((each.shape for each in _over(case.section, x)), None) or case.beam.shape
    return 'shape = "general" has no height' if shape == "general" else ""


def _over(tables: Any, x: float) -> list[Any]:
    """Those of the beam's stretches that are over ``x``."""
    return [
        each
        for each in tables or ()
        if getattr(each, "on", None) != "opposite"
        and None not in (each.start, each.end)
        and each.start <= x <= each.end
    ]


def beam_output(case: SimpleNamespace, path: KeyPath, output: str | None) -> Iterator[Complaint]:
    """A complaint where an output is asked for that the case does not have, or that cannot be read there."""
    own: Mapping[str, Any] = case.output or {}
    usual = OUTPUTS if case.opposite is None else RESERVED
    if output is not None and output not in (*usual, *own):
        words = (*usual, *filter(NAME.fullmatch, own))
        near = suggestion(output, words)
        meant = f"; did you mean {near!r}?" if near else ""
        yield path, f"{as_shown_in_message(output)} is not one of {Word(words).describe()}{meant}"
    yield from platform_output(case, path, output)
    if path == ("sweep", "output"):
        yield from _swept(case, path, output)


def quantity_named(case: Any, output: str | None) -> OutputQuantity:
    """Quantity that an output of a case reads, by its name; a displacement where it is none of [output.NAME]."""
    said = (getattr(case, "output", None) or {}).get(output)
    return OUTPUT_QUANTITIES[(said and said.quantity) or DISPLACEMENT.name]


def main_output(case: Any) -> str | None:
    """The output that a sweep reads, or the first that a record keeps; None where it could not be read."""
    if case.sweep is not None:
        return None if case.sweep.output is None else str(case.sweep.output)
    return next(iter((case.record and case.record.outputs) or ()), None)


def shown_output(case: SimpleNamespace, path: KeyPath, show: SimpleNamespace, kind: FigureKind) -> Iterator[Complaint]:
    """Complaints about a figure of a velocity or acceleration that it does not show."""
    asked = "output" in kind.needs + kind.takes
    output = show.output or main_output(case)
    wanted = quantity_named(case, output)
    if show.quantity in OF_OUTPUT:
        yield from of_displacement(case, (*path, "quantity"), show.quantity)
    if asked and wanted.rate and not kind.derivatives:
        said = f'kind = "{kind.name}" shows no {wanted.name}, which "{output}" is'
        yield (*path, "output"), f'{said}: write output = "sensor"'
    elif asked and wanted.rate and case.measurement is not None and kind.name in ("history", "portrait"):
        said = f'[measurement] samples displacements, "{output}" is of the quantity {wanted.name}'
        yield (*path, "output"), f'{said}: write output = "sensor", or take [measurement] out'


def of_displacement(case: SimpleNamespace, path: KeyPath, quantity: str) -> Iterator[Complaint]:
    """A complaint about a ``quantity`` that no velocity or acceleration has, where the sweep's output is one."""
    wanted = quantity_named(case, main_output(case))
    if wanted.rate:
        said = f'"{quantity}" is of a displacement, sweep.output "{main_output(case)}" is of the quantity {wanted.name}'
        yield path, f'{said}: write quantity = "amplitude"'


def _swept(case: SimpleNamespace, path: KeyPath, output: str | None) -> Iterator[Complaint]:
    """Complaints about the fidelities that cannot read the sweep's output."""
    wanted = quantity_named(case, output)
    if not wanted.rate:
        return
    able = " or ".join(f'"{name}"' for name, declared in SOLVERS.items() if declared.derivatives)
    for name, fidelity in case.fidelity.items():
        if fidelity.solver is not None and not SOLVERS[fidelity.solver].derivatives:
            said = f'"{fidelity.solver}" reads no {wanted.name}, which sweep.output "{output}" is'
            yield ("fidelity", name, "solver"), f"{said}: write {able}"
    if LAWS[case.stop.law or CONSTANT].load().integrated:
        said = f'the {wanted.name} in the contacts of stop.law = "{case.stop.law}" is not read'
        yield path, f'{said}: take another output, or law = "linear"'
