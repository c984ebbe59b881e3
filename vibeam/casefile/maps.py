"""Maps of a case: what is wrong with a [map.NAME], and its plan."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np

from vibeam.case.fidelity import Model
from vibeam.case.grid_keys import (
    DISPLACEMENT,
    FREQUENCY,
    SHARE,
    STARTS,
    AxisPlan,
    MapPlan,
    axis_faults,
    planned,
    way_of,
)
from vibeam.case.plans import SweepPlan
from vibeam.case.study_plans import MOST_ELEMENTS
from vibeam.casefile import quantities as units
from vibeam.casefile.fidelity_changes import field_at
from vibeam.casefile.fields import Count, Entry, OneOrSeveral, Quantity
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.quantities import POSITIVE, SI, UnitSystem, with_unit
from vibeam.casefile.tables.cases import AnyCase
from vibeam.casefile.tables.maps import PLANES, count_of, picture_complaints, random_complaints
from vibeam.casefile.tables.table import Frequency, named_fidelity
from vibeam.casefile.validation import units_of
from vibeam.exchange.faults import CaseError, Complaint, KeyPath, as_shown_in_message
from vibeam_models.keys import keys_of

LARGEST = 10**9  # points of a map


@dataclass(frozen=True)
class _Key:
    """Key of an axis: the entry that reads its values and their unit, or what is wrong with it."""

    entry: Entry | None = None
    unit: str = ""
    fault: str = ""

    def written(self, value: Any, units: UnitSystem | None = SI) -> Any:
        """A value as a case has it whatever its units are: with its SI unit, a whole number as one."""
        if isinstance(self.entry, Quantity):
            return with_unit(value, self.entry.kind, units)
        return int(value) if isinstance(value, float) else value


def map_complaints(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about every [map.NAME]; None in place of what could not be read."""
    for name, table in case.map.items():
        path: KeyPath = ("map", name)
        for index, fidelity in enumerate(table.fidelities or ()):
            yield from named_fidelity(case, (*path, "fidelities", index), fidelity)
        yield from KINDS[case.kind].output_complaints(case, (*path, "output"), table.output)
        yield from _axes(case, path, table)
        yield from random_complaints(path, table)
        yield from picture_complaints(case, path, table)


def _axes(case: SimpleNamespace, path: KeyPath, table: SimpleNamespace) -> Iterator[Complaint]:
    if not table.axes:
        yield (*path, "axes"), 'has no axis: write axes = [{ key = "sweep.frequency", from = …, to = …, points = … }]'
        return
    for index, axis in enumerate(table.axes):
        at: KeyPath = (*path, "axes", index)
        if axis.key_ is not None:
            key = key_of(axis.key_, case)
            if key.fault:
                yield (*at, "key"), key.fault
            else:
                yield from _values(at, axis, key, units_of(case.units))
    keys = [axis.key_ for axis in table.axes]
    if None in keys:
        return
    axes = [AxisPlan(key, (), "") for key in keys]
    run = way_of(
        table.direction, table.picture, axes, table.starts is not None, getattr(case.sweep, "direction", None) or "both"
    )
    for which, message in axis_faults(keys, run != "apart", _frequency(case, table, keys), table.starts is not None):
        yield (*path, "axes", keys.index(which)) if which in keys else (*path, which), message
    if (count := int(np.prod([count_of(axis) for axis in table.axes], dtype=object))) > LARGEST:
        yield (*path, "axes"), f"{count} points are more than {LARGEST:.0e}: take fewer"


def key_of(name: str, case: Any) -> _Key:
    """Reading of the values of an axis."""
    if name == FREQUENCY:
        return _Key(Frequency, "Hz")
    if name == SHARE:
        return _Key(Quantity(units.RATIO, POSITIVE))
    if name in STARTS:
        kind = units.LENGTH if name == DISPLACEMENT else units.SPEED
        kind = units.RATIO if KINDS[case.kind].plain else kind
        return _Key(Quantity(kind), kind.unit)
    parts = name.split(".")
    if len(parts) == 3 and parts[0] == "fidelity" and parts[2] == "modes" and parts[1] in case.fidelity:
        return _Key(Count(1, 2 * MOST_ELEMENTS))
    field, fault = field_at(type(case), name)
    entry = None if field is None else field.entry
    entry = entry.each if isinstance(entry, OneOrSeveral) else entry
    if fault:
        return _Key(fault=fault)
    if not isinstance(entry, Quantity | Count):
        return _Key(fault=f"{as_shown_in_message(name)} is no number that an axis could go through")
    return _Key(entry, entry.kind.unit if isinstance(entry, Quantity) else "")


def _values(at: KeyPath, axis: SimpleNamespace, key: _Key, units: UnitSystem | None) -> Iterator[Complaint]:
    ranged = {"from": axis.from_, "to": axis.to, "points": axis.points}
    given = [name for name, value in ranged.items() if value is not None]
    if axis.values is not None and given:
        yield (*at, given[0]), "goes without values: keep these, or from, to and points"
    elif axis.values is None and len(given) < 3:
        lacking = next(name for name in ranged if name not in given)
        yield (*at, lacking), f"missing: write {lacking} = …, or values = […] in place of from, to and points"
    found = {}
    written: list[tuple[str | int, Any]] = [("from", axis.from_), ("to", axis.to), *enumerate(axis.values or ())]
    for where, value in written:
        if value is not None:
            place: KeyPath = (*at, where) if isinstance(where, str) else (*at, "values", where)
            try:
                found[where] = key.entry.read(value, units) if key.entry else value
            except ValueError as error:
                yield place, f"{axis.key_}: {error}"
    numbers = [value for where, value in found.items() if not isinstance(where, str)]
    if len(set(numbers)) < len(numbers):
        yield (*at, "values"), "has a value twice"
    if axis.points == 1 and found.get("from") != found.get("to"):
        yield (*at, "points"), "1 point does not span from … to: make them equal, or take more points"
    elif axis.points and axis.points > 1 and "to" in found and found.get("from") == found["to"]:
        yield (*at, "points"), f"{axis.points} points from a value to itself: points = 1, or another to"
    if isinstance(key.entry, Count) and axis.points is not None and axis.values is None:
        yield (*at, "points"), "the key takes whole numbers: list them, values = [1, 2, 4, 8]"


def _frequency(case: Any, table: Any, keys: list[str]) -> float | None:
    """The drive frequency where it is no axis: as said, or the one of the sweep."""
    if table.frequency is not None or FREQUENCY in keys:
        return None if table.frequency is None else float(table.frequency)
    grid = getattr(case.sweep, "frequency", None)
    if isinstance(grid, tuple):
        return float(grid[0]) if len(grid) == 1 else None
    return None if grid is None or grid.points != 1 else grid.from_


def value_complaints(declared: AnyCase, model: Callable[[str], Model]) -> Iterator[Complaint]:
    """Complaints of the rules between keys about the ends of each axis, in the ``model`` of each fidelity of its map.

    ``declared``: the case, in which nothing is wrong.
    """
    for name, table in declared.map.items():
        for index, axis in enumerate(table.axes):
            if axis.key_ in (FREQUENCY, SHARE, *STARTS):
                continue
            numbers = axis_values(axis, key_of(axis.key_, declared), units_of(declared.units))
            for place, value in {0: numbers[0], len(numbers) - 1: numbers[-1]}.items():
                where = ("values", place) if axis.values else ("to" if place else "from",)
                found: dict[tuple[str, str], str] = {}
                for fidelity in table.fidelities or tuple(declared.fidelity):
                    try:
                        model(fidelity).at({axis.key_: value}).checked()
                    except CaseError as error:
                        for fault in error.faults:
                            found.setdefault((fault.key, fault.message), fidelity)
                for (key, message), fidelity in found.items():
                    said = f"{axis.key_} = {value:g} in fidelity {fidelity}, {key}: {message}"
                    yield ("map", name, "axes", index, *where), said


def maps_in_si(case: Any) -> dict[str, Any]:
    """The tables [map.NAME] of a checked case, the numbers of their axes without a unit with that of SI."""
    return {
        name: table.with_(axes=tuple(_axis_in_si(axis, case) for axis in table.axes))
        for name, table in case.map.items()
    }


def _axis_in_si(axis: Any, case: Any) -> Any:
    key, units = key_of(axis.key_, case), units_of(case.units)
    if axis.values:
        return axis.with_(values=tuple(key.written(value, units) for value in axis.values))
    return axis.with_(**{name: key.written(getattr(axis, name), units) for name in ("from_", "to")})


def axis_values(axis: Any, key: _Key, units: UnitSystem | None = SI) -> tuple[float, ...]:
    """Values of an axis in SI, in the order given."""
    assert key.entry is not None
    if axis.values:
        return tuple(float(key.entry.read(value, units)) for value in axis.values)
    ends = float(key.entry.read(axis.from_, units)), float(key.entry.read(axis.to, units))
    return tuple(np.linspace(*ends, axis.points).tolist())


def map_plans(declared: AnyCase, sweep: SweepPlan) -> Mapping[str, MapPlan]:
    """The plan of every [map.NAME]."""
    return {name: _plan(name, table, declared, sweep) for name, table in declared.map.items()}


def _plan(name: str, table: Any, declared: AnyCase, sweep: SweepPlan) -> MapPlan:
    keys = [axis.key_ for axis in table.axes]
    known = [key_of(each, declared) for each in keys]
    axes = [AxisPlan(axis.key_, axis_values(axis, key), key.unit) for axis, key in zip(table.axes, known, strict=True)]
    given = {key: getattr(table, key) for key in keys_of(MapPlan) if key not in ("picture", "fidelities")}
    chosen = () if table.picture in PLANES else tuple(declared.fidelity)
    own = {"fidelities": table.fidelities or chosen, "frequency": _frequency(declared, table, keys)}
    return planned(name, axes, sweep, table.picture, **given | own)
