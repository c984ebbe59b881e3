"""Tables of the sweep and the fidelities; rules between their keys."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path as File
from types import SimpleNamespace
from typing import Any

from vibeam.case.fidelity import Fidelity
from vibeam.case.plans import SweepPlan
from vibeam.case.reduced_structure import Flight
from vibeam.case.study_plans import MOST_POINTS
from vibeam.casefile.field_tables import OPTIONS, TableOr, settings
from vibeam.casefile.fields import TEXT, Count, Each, Several, Word
from vibeam.casefile.kinds import KINDS, MODELS
from vibeam.casefile.tables.declared import Field, Table, key, table
from vibeam.casefile.tables.outputs import OUTPUT_NAME
from vibeam.casefile.tables.table import Frequency, declared_key, plan_keys, plan_of
from vibeam.casefile.toml_writing import to_fill_in
from vibeam.exchange.faults import Complaint, KeyPath
from vibeam.solvers import SOLVERS
from vibeam_reductions.declaration import PARAMETERS, REDUCTIONS, ReductionDeclaration


def plan_checks(case: SimpleNamespace, folder: File) -> Iterator[Complaint]:
    """Complaints about the sweep's grid, its output and the modes that are asked for."""
    kind = KINDS[case.kind]
    if case.sweep is not None:
        yield from _grid(case.sweep.frequency)
        yield from kind.output_complaints(case, ("sweep", "output"), case.sweep.output)
    if not kind.one_mode:
        yield from _modes(case, *kind.most_modes_of(case, folder))


def _grid(grid: SimpleNamespace | tuple[float, ...] | None) -> Iterator[Complaint]:
    if grid is None or isinstance(grid, tuple) or grid.from_ is None or grid.to is None:
        return
    path = ("sweep", "frequency")
    if grid.from_ > grid.to:
        yield (*path, "to"), 'is below from; to sweep downwards write direction = "down"'
    elif grid.points == 1 and grid.from_ < grid.to:
        yield (*path, "points"), "1 point does not span from … to: make them equal, or take more points"
    elif grid.points is not None and grid.points > 1 and grid.from_ == grid.to:
        yield (*path, "points"), f"{grid.points} points from a frequency to itself: points = 1, or another to"


def _modes(case: SimpleNamespace, most: int, gives: str) -> Iterator[Complaint]:
    for name, fidelity in case.fidelity.items():
        path = ("fidelity", name, "modes")
        declared = REDUCTIONS[fidelity.reduction] if fidelity.reduction else None
        if declared and declared.counts and fidelity.modes is None:
            yield path, f'missing: reduction = "{declared.name}" needs how many; write modes = 8'
        elif declared and not declared.counts and fidelity.modes is not None:
            yield path, f'reduction = "{declared.name}" counts none: take it out, or write reduction = "modal"'
        elif fidelity.modes is not None and 0 < most < fidelity.modes and not model_named(fidelity):
            yield path, f"{fidelity.modes} are more than the model has: {gives} {most} at most"
        if declared:
            yield from _parameters(("fidelity", name), fidelity, declared)


def model_named(fidelity: Any) -> str:
    """Name of the model that a fidelity has in place of the beam; empty where it has the beam."""
    found = getattr(fidelity, "model", None)
    return "" if found in (None, "beam") else str(found)


def _parameters(path: KeyPath, fidelity: Any, declared: ReductionDeclaration) -> Iterator[Complaint]:
    """Complaints about the keys of a reduction."""
    for name in PARAMETERS:
        written = getattr(fidelity, name) is not None
        if written and name not in declared.takes:
            takers = " or ".join(f'"{each.name}"' for each in REDUCTIONS.values() if name in each.takes)
            yield (*path, name), f'goes with reduction = {takers} alone, not "{declared.name}"'
        elif not written and name in declared.needs:
            cure = f"write {name} = {to_fill_in(PARAMETERS[name].example)}"
            yield (*path, name), f'missing: reduction = "{declared.name}" needs it; {cure}'


class GridTable(Table):
    """Evenly spaced drive frequencies."""

    from_ = key(Frequency, "first frequency", "14 Hz")
    to = key(Frequency, "last frequency, itself included", "17 Hz")
    points = key(Count(1, MOST_POINTS), "how many", 121)


FrequencyGrid = TableOr(GridTable, Several(Frequency, limit=MOST_POINTS, ascending=True))


def sweep_table(name: str, meaning: str, **own: Field) -> Any:
    """The table of the sweep; ``own``: fields that are others in a kind of case."""
    told = "drive frequencies: from, to and points, or an ascending list of Hz"
    grid = key(FrequencyGrid, told, {"from": "14 Hz", "to": "17 Hz", "points": 121})
    keys = plan_keys(SweepPlan, output=OUTPUT_NAME)
    return table(name, meaning, {"frequency": grid} | keys | own)


SWEPT = "The sweep that every fidelity runs: drive frequencies and, at each, periods to settle and to hold."
SweepTable = sweep_table("SweepTable", SWEPT)
_MOTION = key(Word(("sensor", "contact")), "both are the one motion", "sensor", "sensor")
SdofSweepTable = sweep_table("SdofSweepTable", "The sweep of the single degree of freedom.", output=_MOTION)


_OWN = plan_keys(Fidelity, reduction=Word(REDUCTIONS), solver=Word(SOLVERS), options=OPTIONS)
_REDUCTION = {name: _OWN.pop(name) for name in ("reduction", "modes")}
_ENTRIES = {"boundary": Each(TEXT, called="names")}
_REDUCTION |= {name: declared_key(each, None, entry=_ENTRIES.get(name)) for name, each in PARAMETERS.items()}


class _Changes(Table):
    set = key(
        settings(), "physics that is this fidelity's own: dotted keys and their values", {"stop.restitution": 0.6}, None
    )
    without = key(
        Each(TEXT, called="dotted keys"),
        "optional keys, or whole optional tables, of the physics that it leaves out",
        ["mass.rotary_inertia"],
        None,
    )


_SOLUTION = {name: _OWN.pop(name) for name in ("solver", "options")}, _Changes, _OWN
FidelityTable = table(
    "FidelityTable", "A fidelity, one table each: which model of the rig is swept.", _REDUCTION, *_SOLUTION
)
_SAID = "".join(f", or {each.meaning}, as [{name}] says" for name, each in MODELS.items())
_MODEL = {
    "model": key(
        Word(("beam", *MODELS)),
        f"what is reduced: the beam{_SAID}",
        next(iter(MODELS), "beam"),
        None,
    )
}
BeamFidelityTable = table("BeamFidelityTable", FidelityTable.__doc__, _MODEL, _REDUCTION, *_SOLUTION)
_ONE_MODE = {"reduction": key(Word(("static_mode",)), "one mode", "static_mode", "static_mode")}
SdofFidelityTable = table(
    "SdofFidelityTable",
    "A fidelity of the single degree of freedom, which is one mode already; the table may be empty.",
    _ONE_MODE,
    *_SOLUTION,
)


APPLIED = frozenset({"set", "without"})  # of a fidelity: part of its scene already


def fidelity_of(name: str, said: Any) -> Fidelity:
    """Record of a fidelity; of its reduction's keys those that are written."""
    reduction = REDUCTIONS[said.reduction]
    taken = {key: value for key in reduction.takes if (value := getattr(said, key)) is not None}
    changed = {"changes": said.set or {}, "without": said.without or (), "parameters": taken}
    modes = {} if reduction.counts else {"modes": None}
    return plan_of(Fidelity, said, name=name, flight=_flight() if reduction.flown else None, **changed | modes)


def _flight() -> Flight:
    from vibeam.flight.trajectory import modal_snapshots

    return modal_snapshots
