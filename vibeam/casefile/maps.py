"""Maps of a case: what is wrong with a [map.NAME], and its plan."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.faults import Complaint, KeyPath, as_shown_in_message
from vibeam.case.grid_keys import DISPLACEMENT, FREQUENCY, STARTS, axis_faults
from vibeam.case.plans import AxisPlan, MapPlan, SweepPlan
from vibeam.casefile import quantities as units
from vibeam.casefile.fidelity_changes import field_at
from vibeam.casefile.field_lists import OneOrSeveral
from vibeam.casefile.fields import Count, Entry, Quantity
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.overrides import override
from vibeam.casefile.tables.maps import STROBES
from vibeam.casefile.tables.names import named_fidelity
from vibeam.casefile.tables.table import MOST_ELEMENTS, Frequency
from vibeam.casefile.validation import entry_of, physics_keys

if TYPE_CHECKING:
    from vibeam.casefile.tables.cases import AnyCase

Validate = Callable[[dict[str, Any]], tuple[Any, list[Complaint]]]

LARGEST = 10**9  # points of a map


@dataclass(frozen=True)
class _Key:
    """Key of an axis: the entry that reads its values and their unit, or what is wrong with it."""

    entry: Entry | None = None
    unit: str = ""
    fault: str = ""


def map_complaints(case: SimpleNamespace, model: type[AnyCase]) -> Iterator[Complaint]:
    """Complaints about every [map.NAME]; None in place of what could not be read."""
    for name, table in case.map.items():
        path: KeyPath = ("map", name)
        for index, fidelity in enumerate(table.fidelities or ()):
            yield from named_fidelity(case, (*path, "fidelities", index), fidelity)
        yield from KINDS[case.kind].output_complaints(case, (*path, "output"), table.output)
        yield from _axes(case, path, table, model)
        yield from _random(path, table)
        yield from _picture(case, path, table)
        if table.refine:
            yield from _refined(case, path, table)


def _axes(case: SimpleNamespace, path: KeyPath, table: SimpleNamespace, model: type[AnyCase]) -> Iterator[Complaint]:
    if not table.axes:
        yield (*path, "axes"), 'has no axis: write axes = [{ key = "sweep.frequency", from = …, to = …, points = … }]'
        return
    for index, axis in enumerate(table.axes):
        at: KeyPath = (*path, "axes", index)
        if axis.key_ is not None:
            key = key_of(axis.key_, case, model)
            if key.fault:
                yield (*at, "key"), key.fault
            else:
                yield from _values(at, axis, key)
    keys = [axis.key_ for axis in table.axes]
    if None in keys:
        return
    run = direction_of(table, keys, case.sweep.direction)
    for which, message in axis_faults(keys, run != "apart", _frequency(case, table, keys), table.starts is not None):
        yield (*path, "axes", keys.index(which)) if which in keys else (*path, which), message
    if (count := int(np.prod([_count(axis) for axis in table.axes], dtype=object))) > LARGEST:
        yield (*path, "axes"), f"{count} points are more than {LARGEST:.0e}: take fewer"


def _count(axis: SimpleNamespace) -> int:
    return len(axis.values) if axis.values else axis.points or 1


def key_of(name: str, case: Any, model: type[AnyCase]) -> _Key:
    """What reads the values of an axis."""
    if name == FREQUENCY:
        return _Key(Frequency, "Hz")
    if name in STARTS:
        kind = units.LENGTH if name == DISPLACEMENT else units.SPEED
        kind = units.RATIO if KINDS[case.kind].plain else kind
        return _Key(Quantity(kind), kind.unit)
    parts = name.split(".")
    if len(parts) == 3 and parts[0] == "fidelity" and parts[2] == "modes" and parts[1] in case.fidelity:
        return _Key(Count(1, 2 * MOST_ELEMENTS))
    field, fault = field_at(model, name)
    entry = None if field is None else entry_of(field)
    entry = entry.each if isinstance(entry, OneOrSeveral) else entry
    if fault:
        return _Key(fault=fault)
    if not isinstance(entry, Quantity | Count):
        return _Key(fault=f"{as_shown_in_message(name)} is no number that an axis could go through")
    return _Key(entry, entry.kind.unit if isinstance(entry, Quantity) else "")


def _values(at: KeyPath, axis: SimpleNamespace, key: _Key) -> Iterator[Complaint]:
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
                found[where] = key.entry.parse(value) if key.entry else value
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


def _random(path: KeyPath, table: SimpleNamespace) -> Iterator[Complaint]:
    if table.starts is not None and table.spread is None:
        yield (*path, "spread"), 'missing: says how far from 0 motions start; write spread = "1 mm"'
    elif table.starts is None and table.spread is not None:
        yield (*path, "spread"), "goes with starts: say how many, or leave it away"


def _picture(case: SimpleNamespace, path: KeyPath, table: SimpleNamespace) -> Iterator[Complaint]:
    axes, starts = len(table.axes or ()), [axis.key_ for axis in table.axes or () if axis.key_ in STARTS]
    if table.picture == "spectra" and any((axis.key_ or "").endswith(".modes") for axis in table.axes or ()):
        yield (*path, "picture"), '"spectra" is of one number of modes: take another axis'
    if table.quantity is not None and table.picture != "values":
        yield (*path, "quantity"), 'goes with picture = "values": leave it away'
    if table.picture in ("bifurcation", "spectra") and axes > 1:
        yield (*path, "axes"), f'picture = "{table.picture}" is of one axis, not {axes}'
    elif table.picture == "period" and axes == 1:
        yield (*path, "axes"), 'picture = "period" is of two axes or three: add one, or write picture = "values"'
    elif axes > 3:
        yield (*path, "axes"), f"{axes} axes cannot be drawn: three at most"
    if table.picture == "basins" and not starts and table.starts is None:
        said = "start.displacement and start.velocity as axes, or starts = 50"
        yield (*path, "picture"), f'"basins" is of motions with starts of their own: write {said}'
    elif table.picture == "basins" and starts and axes > 2:
        yield (*path, "axes"), 'picture = "basins" with starts as axes is of two axes at most'
    elif table.picture != "basins" and table.starts is not None:
        yield (*path, "picture"), f'"{table.picture}" shows one motion a point: with starts write "basins"'
    hold = case.sweep.hold if table.hold is None else table.hold
    if table.strobes is not None and hold is not None and table.strobes > hold:
        yield (*path, "strobes"), f"{table.strobes} values need as many periods held: hold is {hold}"


def _refined(case: SimpleNamespace, path: KeyPath, table: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about a refined map: of points that are independent, and of labels."""
    at, keys = (*path, "refine"), [axis.key_ for axis in table.axes or ()]
    if table.picture not in ("period", "basins"):
        yield at, f'"{table.picture}" shows numbers, and refining follows labels: leave it away'
        return
    if table.starts is not None:
        yield at, "is of one motion a point: leave starts or refine away"
        return
    if direction_of(table, keys, case.sweep.direction) != "apart":
        yield (
            at,
            'flies points by themselves, and here the state is carried along the last axis: write direction = "apart"',
        )
    if len(keys) < 2 or (table.picture == "basins" and not all(key in STARTS for key in keys[-2:])):
        said = "start.displacement and start.velocity" if table.picture == "basins" else "two axes or three"
        yield at, f"halves cells of a plane: the axes must be {said}"
        return
    fewest = min(_count(axis) for axis in table.axes[-2:])
    if 2**table.refine > fewest - 1:
        most = max(fewest - 1, 1).bit_length() - 1
        yield at, f"begins with every {2**table.refine}th point, and an axis has {fewest}: {most} at most"


def direction_of(table: Any, keys: list[str], swept: str | None) -> str:
    """Which way the last axis is swept: as said, else apart where motions have starts of their own, else the sweep's.

    Along a key that changes the modes nothing can be carried: also apart.
    """
    if table.direction is not None:
        return str(table.direction)
    return "apart" if table.starts is not None or any(key in STARTS for key in keys) else swept or "both"


def _frequency(case: Any, table: Any, keys: list[str]) -> float | None:
    """The drive frequency where it is no axis: as said, or the one of the sweep."""
    if table.frequency is not None or FREQUENCY in keys:
        return None if table.frequency is None else float(table.frequency)
    grid = case.sweep.frequency
    if isinstance(grid, tuple):
        return float(grid[0]) if len(grid) == 1 else None
    return None if grid is None or grid.points != 1 else grid.from_


def value_complaints(tables: dict[str, Any], declared: AnyCase, validate: Validate) -> Iterator[Complaint]:
    """Complaints of the rules between keys about the ends of each axis, in each fidelity of its map.

    ``declared``: the case, in which nothing is wrong; ``validate``: validates other tables of this kind.
    """
    for name, table in declared.map.items():
        for index, axis in enumerate(table.axes):
            if axis.key_ in (FREQUENCY, *STARTS):
                continue
            numbers = axis_values(axis, key_of(axis.key_, declared, type(declared)))
            for place, value in {0: numbers[0], len(numbers) - 1: numbers[-1]}.items():
                where = ("values", place) if axis.values else ("to" if place else "from",)
                found: dict[Complaint, str] = {}
                for fidelity in table.fidelities or tuple(declared.fidelity):
                    for complaint in _with_value(tables, declared, fidelity, axis.key_, value, validate):
                        found.setdefault(complaint, fidelity)
                for (path, message), fidelity in found.items():
                    said = f"{axis.key_} = {value:g} in fidelity {fidelity}, {'.'.join(map(str, path))}: {message}"
                    yield ("map", name, "axes", index, *where), said


def _with_value(
    tables: dict[str, Any], declared: AnyCase, fidelity: str, key: str, value: float, validate: Validate
) -> list[Complaint]:
    """Complaints about a case of one fidelity with a key set."""
    own = {name: deepcopy(tables[name]) for name in (*physics_keys(type(declared)), "sweep") if name in tables}
    model = deepcopy(tables["fidelity"][fidelity])
    own["fidelity"] = {fidelity: model}
    plain = int(value) if float(value).is_integer() else value
    if "set" in model and not key.startswith("fidelity."):
        model["set"] = {**model["set"], key: plain}
    else:
        override(own, key, plain, literal=True)
    return validate(own)[1]


def axis_values(axis: Any, key: _Key) -> tuple[float, ...]:
    """Values of an axis in SI, in the order given."""
    assert key.entry is not None
    if axis.values:
        return tuple(float(key.entry.parse(value)) for value in axis.values)
    ends = float(key.entry.parse(axis.from_)), float(key.entry.parse(axis.to))
    return tuple(np.linspace(*ends, axis.points).tolist())


def map_plans(declared: AnyCase, sweep: SweepPlan) -> Mapping[str, MapPlan]:
    """The plan of every [map.NAME]."""
    return {name: _plan(name, table, declared, sweep) for name, table in declared.map.items()}


def _plan(name: str, table: Any, declared: AnyCase, sweep: SweepPlan) -> MapPlan:
    keys = [axis.key_ for axis in table.axes]
    known = [key_of(each, declared, type(declared)) for each in keys]
    axes = [AxisPlan(axis.key_, axis_values(axis, key), key.unit) for axis, key in zip(table.axes, known, strict=True)]
    run: Any = direction_of(table, keys, sweep.direction)
    strobes = table.strobes or 0
    hold = sweep.hold if table.hold is None else table.hold
    if table.picture == "bifurcation" and not strobes:
        strobes = min(STROBES, hold)
    return MapPlan(
        name=name,
        fidelities=table.fidelities or tuple(declared.fidelity),
        axes=tuple(axes),
        direction=run,
        frequency=_frequency(declared, table, keys),
        settle=sweep.settle if table.settle is None else table.settle,
        hold=hold,
        output=table.output or sweep.output,
        quantities=_quantities(table, strobes),
        picture=table.picture,
        quantity=table.quantity or "amplitude",
        strobes=strobes,
        starts=table.starts,
        seed=table.seed,
        spread=table.spread,
        boundaries=table.boundaries,
        refine=table.refine,
    )


NEEDED = {
    "period": ("period", "rest"),
    "bifurcation": ("period",),
    "basins": ("period", "impacts_per_period", "maximum", "minimum", "impact_velocity"),
    "spectra": ("state", "resting"),
    "values": (),
}


def _quantities(table: Any, strobes: int) -> tuple[str, ...]:
    asked = table.quantities or ("amplitude", "period")
    shown = (table.quantity or "amplitude",) if table.picture == "values" else ()
    return tuple(dict.fromkeys((*asked, *NEEDED[table.picture], *shown, *(("strobes",) if strobes else ()))))
