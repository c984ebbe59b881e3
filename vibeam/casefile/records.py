"""Record cases: what is wrong with [record], [start] and their input, and the plans of these."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path as File
from types import SimpleNamespace
from typing import Any, TypeVar, cast

from vibeam.case.fidelity import Model
from vibeam.case.input_plan import InputPlan
from vibeam.case.plans import RecordPlan, StartPlan, moving
from vibeam.casefile import quantities as units
from vibeam.casefile.fidelity_changes import entry_at
from vibeam.casefile.field_tables import flat
from vibeam.casefile.fields import Entry, Quantity
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.quantities import ANY, POSITIVE, with_unit
from vibeam.casefile.tables.input import input_checks, way_of
from vibeam.casefile.tables.outputs import quantity_named
from vibeam.casefile.tables.table import plan_of
from vibeam.casefile.validation import units_of
from vibeam.exchange.faults import CaseError, Complaint, as_shown_in_message
from vibeam.figures import FIGURES
from vibeam.solvers import SOLVERS
from vibeam_models.keys import keys_of
from vibeam_reductions.declaration import REDUCTIONS

T = TypeVar("T")
NUMBERS = ("expect", "measured")
SCALES = ("level", "speed")  # what may be varied of the input itself
#: tables that are about a sweep alone, and what answers in their place
OF_SWEEPS = {
    "reference": "[measured.NAME] compares a number of a history with a measured one",
    "cost": "vibeam run says the CPU time of every fidelity",
    "fit": "it reads frequency-response curves",
    "map": "vibeam map CASE --over KEY,KEY --quantity peak flies any keys",
    "modes_needed": "vibeam verdict --only modes says how many suffice",
}
OF_FREQUENCY = ("drift", "drift_frequency", "wear")  # keys of [stop] that go by the points of a sweep


def record_checks(case: SimpleNamespace, folder: File) -> Iterator[Complaint]:
    """Complaints about a case that has neither sweep nor record, or both; about record, start and input."""
    if case.record is None:
        if case.sweep is None:
            yield ("sweep",), "the table is missing: add [sweep], or [record] for an input over time"
        if case.start is not None:
            yield ("start",), "is of a [record]; a sweep goes on from point to point: take it away"
        yield from _of_record(case)
        return
    if case.sweep is not None:
        yield ("record",), "and [sweep] do not go together: a case has one of the two"
        return
    yield from input_checks(case, folder)
    yield from _start(case)
    yield from _plan(case)
    yield from _solvers(case)
    yield from _of_sweeps(case)
    yield from _numbers_at(case)


def varied_complaints(declared: Any, model: Callable[[str], Model]) -> Iterator[Complaint]:
    """Complaints of the rules between keys about the values of what a record varies, in the ``model`` of each fidelity.

    ``declared``: the case, in which nothing is wrong.
    """
    if declared.record is None or declared.record.over in SCALES:
        return
    entry, key = varied(declared)[0], declared.record.over
    for place, value in enumerate(declared.record.values):
        number = _read(entry, value, declared)
        for name in declared.fidelity:
            try:
                model(name).at({key: number or 0.0}).checked()
            except CaseError as error:
                fault = error.faults[0]
                said = f"{key} = {number:g} in fidelity {name}, {fault.key}: {fault.message}"
                yield ("record", "values", place), said
                break


def _numbers_at(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about numbers compared at values that are not run."""
    entry = varied(case)[0]
    values = [number for each in case.record.values or () if (number := _read(entry, each, case)) is not None]
    for kind in NUMBERS:
        for name, each in getattr(case, kind).items():
            if each.at is not None and entry is not None and _read(entry, each.at, case) not in values:
                yield (kind, name, "at"), f"{as_shown_in_message(each.at)} is none of record.values"


def _read(entry: Entry | None, value: Any, case: Any) -> float | None:
    try:
        return None if entry is None or value is None else float(entry.read(value, units_of(case.units)))
    except ValueError:
        return None


def _of_record(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about the keys of an input, and figures of one, in a case that sweeps a sine."""
    for name, show in case.show.items():
        if show.kind is not None and not FIGURES[show.kind].sweep:
            yield ("show", name, "kind"), f'"{show.kind}" is of a [record], and this case sweeps: name another'
    for name in keys_of(InputPlan):
        if getattr(case.drive, name, None) is not None:
            yield ("drive", name), "is of an input over time: write [record] in place of [sweep], or take it out"


def _start(case: SimpleNamespace) -> Iterator[Complaint]:
    start = case.start
    if start is None:
        return
    given = moving(start)
    for one, other in (("displacement", "force"), ("velocity", "height"), ("velocity", "base_velocity"),
                       ("height", "base_velocity")):  # fmt: skip
        if one in given and other in given:
            yield ("start", other), f"goes without {one}: keep one of the two"
    if not given:
        yield ("start",), 'says nothing: write displacement = "2 mm", velocity, force or base_velocity; or take it away'
    dropped = next((name for name in ("height", "base_velocity") if name in given), None)
    on_base = getattr(case.drive, "at", None) is None and getattr(case, "platform", None) is None
    if dropped and (not on_base or _forced(case)):
        yield ("start", dropped), "stops the base of a rig, and a force or a platform drives this one: write velocity"
    yield from KINDS[case.kind].output_complaints(case, ("start", "output"), start.output)
    wanted = quantity_named(case, start.output)
    if wanted.name != "displacement":
        yield ("start", "output"), f"is of the quantity {wanted.name}: name an output that is a displacement"


def _forced(case: SimpleNamespace) -> bool:
    return case.kind in ("matrices", "modes") and getattr(case, case.kind).force is not None


def _plan(case: SimpleNamespace) -> Iterator[Complaint]:
    record = case.record
    if record.duration is None and way_of(case.drive) != "file":
        yield ("record", "duration"), 'missing (how long the motion is followed): write duration = "0.5 s"'
    for name in record.outputs or ():
        yield from KINDS[case.kind].output_complaints(case, ("record", "outputs"), name)
    if record.realisations not in (1, None) and way_of(case.drive) != "density":
        yield ("record", "realisations"), "of a random input alone: write drive.density, or take it away"
    yield from _over(case)


def varied(case: Any) -> tuple[Entry | None, str]:
    """The entry that reads the values of what is varied, or what is wrong with it."""
    if case.record.over in SCALES:
        return Quantity(units.RATIO, POSITIVE if case.record.over == "speed" else ANY), ""
    entry, fault = entry_at(type(case), case.record.over)
    if fault:
        return None, f"{fault}; or level, speed"
    if not isinstance(entry, Quantity):
        return None, f"{as_shown_in_message(case.record.over)} holds no number that could be varied"
    return entry, ""


def _over(case: SimpleNamespace) -> Iterator[Complaint]:
    record = case.record
    if record.over is None or record.values is None:
        return
    for name, fidelity in case.fidelity.items():
        if record.over in dict(flat(fidelity.set or {})):
            yield ("fidelity", name, "set"), f"keeps {record.over} at one value, and record.over varies it: take it out"
    entry, fault = varied(case)
    if fault:
        yield ("record", "over"), fault.replace("a fidelity changes", "record.over may be")
        return
    if record.over not in SCALES and record.values == RecordPlan.values:
        yield ("record", "values"), f'missing: the values of {record.over}, write values = ["…", "…"]'
        return
    assert entry is not None
    found = []
    for place, value in enumerate(record.values):
        try:
            found.append(entry.read(value, units_of(case.units)))
        except ValueError as error:
            yield ("record", "values", place), f"{record.over}: {error}"
    if len(set(found)) < len(found):
        yield ("record", "values"), "has a value twice"


def _solvers(case: SimpleNamespace) -> Iterator[Complaint]:
    able = " or ".join(f'"{name}"' for name, declared in SOLVERS.items() if declared.records)
    for name, fidelity in case.fidelity.items():
        if fidelity.solver is not None and not SOLVERS[fidelity.solver].records:
            yield ("fidelity", name, "solver"), f'"{fidelity.solver}" knows sines alone: write {able}'
        if fidelity.reduction is not None and REDUCTIONS[fidelity.reduction].flown:
            said = f'"{fidelity.reduction}" is made of a motion under a sine: take another'
            yield ("fidelity", name, "reduction"), said


def _of_sweeps(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about tables and keys without a meaning for an input over time."""
    usual = case.KEYS
    for name, instead in OF_SWEEPS.items():
        asked = getattr(case, name, None)
        if asked not in (None, {}) and asked != usual[name].default:
            yield (name,), f"is of a [sweep]: take it away; {instead}"
    for name in OF_FREQUENCY:
        if getattr(case.stop, name, None) is not None:
            yield ("stop", name), "goes by the points of a [sweep]: take it out"
    if case.measurement is not None:
        yield ("measurement",), "is of the figures of a [sweep]: take it away; record.rate samples histories"
    for name, show in case.show.items():
        if show.kind is not None and not FIGURES[show.kind].record:
            kinds = ", ".join(f'"{each}"' for each in FIGURES if FIGURES[each].record) or "none yet"
            yield ("show", name, "kind"), f'"{show.kind}" is of a [sweep]; of a [record]: {kinds}'
        elif show.kind == "history" and show.output not in (None, *(case.record.outputs or ())):
            yield (
                ("show", name, "output"),
                f"is not kept: name {as_shown_in_message(show.output)} in record.outputs too",
            )


def record_plan(case: Any, inputs: InputPlan) -> RecordPlan:
    """The plan of [record] of a checked case; without a duration its file is read, CaseError for a faulty one."""
    entry, _ = varied(case)
    assert entry is not None
    values = tuple(float(entry.parse(value)) for value in case.record.values)
    first = inputs.seed or 0
    seeds = tuple(range(first, first + case.record.realisations)) if inputs.random else ()
    duration = inputs.measured().end if case.record.duration is None else case.record.duration
    return plan_of(RecordPlan, case.record, values=values, seeds=seeds, duration=duration)


def start_plan(case: Any) -> StartPlan:
    """The plan of [start] of a checked case."""
    return StartPlan(**vars(case.start) if case.start else {}, settled=_settled)


def _settled(system: Any) -> Any:
    from vibeam.flight.equilibrium import equilibrium

    return equilibrium(system)


def located(case: Any, numbers: Mapping[str, T]) -> dict[str, T]:
    """Numbers compared by name, with ``at`` in SI, of a checked case."""
    if case.record is None:
        return dict(numbers)
    entry = varied(case)[0]
    found: Any = {name: (each, _read(entry, each.at, case)) for name, each in cast(Any, numbers).items()}
    return {name: each if at is None else replace(each, at=at) for name, (each, at) in found.items()}


def record_in_si(case: Any, tables: dict[str, Any]) -> dict[str, Any]:
    """``tables`` and [record] of a checked case, the values of what is varied with their SI unit."""
    entry, system = varied(case)[0], units_of(case.units)
    kind = entry.kind if isinstance(entry, Quantity) else None

    def written(value: Any) -> Any:
        return with_unit(value, kind, system) if kind and value is not None else value

    values = tuple(written(value) for value in case.record.values)
    numbers = {part: {name: each.with_(at=written(each.at)) for name, each in tables[part].items()} for part in NUMBERS}
    return tables | numbers | {"record": case.record.with_(values=values)}
