"""Table of a map and of each of its axes; rules between its keys: random starts, what a picture needs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

from vibeam.case.grid_keys import FREQUENCY, STARTS, MapPlan
from vibeam.case.study_plans import MOST_POINTS
from vibeam.casefile.fields import TEXT, Count, Each, ValueEntry
from vibeam.casefile.tables.declared import Field, Table, key, table
from vibeam.casefile.tables.outputs import OUTPUT_NAME
from vibeam.casefile.tables.table import declared_key, plan_keys
from vibeam.exchange.faults import Complaint, KeyPath
from vibeam_models.keys import keys_of


def _level(value: Any) -> float | str | None:
    return None if isinstance(value, bool) or not isinstance(value, int | float | str) else value


def _levels(value: Any) -> tuple[float | str, ...]:
    if not isinstance(value, list) or not 0 < len(value) <= MOST_POINTS:
        raise LEVELS.refusal(value, "a ")
    return tuple(LEVEL.parse(each) for each in value)


#: a value of whatever key an axis is of, read by that key's own rules later; a list of them
LEVEL = ValueEntry(_level, "value of the key", {"type": ["number", "string"]})
LEVELS = ValueEntry(_levels, "list of values of the key", {"type": "array", "items": LEVEL.schema(), "minItems": 1})


class AxisTable(Table):
    """Axis of a map: a key of the case and its values."""

    key_ = key(
        TEXT,
        "a dotted key of the rig, sweep.frequency, fidelity.NAME.modes, start.displacement or .velocity",
        "stop.gap",
    )
    from_ = key(LEVEL, "first value", "-0.1 mm", None)
    to = key(LEVEL, "last value, itself included", "0.1 mm", None)
    points = key(Count(1, MOST_POINTS), "how many, evenly spaced", 61, None)
    values = key(LEVELS, "the values themselves, in place of from, to and points", ["-0.1 mm", "0 mm", "0.1 mm"], None)


def _map_table(name: str, **own: Field) -> Any:
    """The table of a map; ``own``: fields that are others in a kind of case."""
    axes = key(
        AxisTable,
        "the last is swept and lies across, the one before upward, of one more each value has a panel",
        [{"key": "stop.gap", "values": ["0 mm", "0.1 mm"]}, {"key": "sweep.frequency", "values": ["15 Hz", "16 Hz"]}],
        many=tuple,
    )
    keys = plan_keys(MapPlan, fidelities=Each(TEXT, alone=True, called="fidelities"), output=OUTPUT_NAME)
    return table(name, MEANING, {"axes": axes} | keys | own)


MEANING = (
    "A map over any keys of the case, one table each, [map] where there is one: what vibeam map computes and draws."
)
MapTable: Any = _map_table("MapTable")
_SPREAD = declared_key(replace(keys_of(MapPlan)["spread"], unit="", example=0.01), None)
SdofMapTable: Any = _map_table("SdofMapTable", spread=_SPREAD)


def random_complaints(path: KeyPath, table: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about random starts."""
    if table.starts is not None and table.spread is None:
        yield (*path, "spread"), 'missing: says how far from 0 motions start; write spread = "1 mm"'
    elif table.starts is None and table.spread is not None:
        yield (*path, "spread"), "goes with starts: say how many, or leave it away"


PLANES = ("stability", "verdict")
#: pictures that a key goes with
OF_PICTURE = {"accuracy": ("verdict",), "frequency_accuracy": ("verdict",), "periods": ("stability",),
              "quantity": ("values", "verdict")}  # fmt: skip
APART = ("direction", "quantities", "strobes")  # keys without a meaning for ``PLANES``


def _own_keys(path: KeyPath, table: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about keys that do not go with the picture."""
    for name, pictures in OF_PICTURE.items():
        if getattr(table, name) is not None and table.picture not in (*pictures, None):
            yield (*path, name), f"goes with picture = {' or '.join(map(repr, pictures))}: omit it".replace("'", '"')
    if table.picture in PLANES:
        for name in APART:
            if getattr(table, name) is not None:
                yield (*path, name), f'does not go with picture = "{table.picture}": omit it'
    if table.picture == "verdict" and table.quantity not in (None, "amplitude", "reach"):
        yield (*path, "quantity"), 'of picture = "verdict" is "amplitude" or "reach"'


def picture_complaints(case: SimpleNamespace, path: KeyPath, table: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about what the picture needs and the axes give."""
    axes, starts = len(table.axes or ()), [axis.key_ for axis in table.axes or () if axis.key_ in STARTS]
    yield from _own_keys(path, table)
    if table.picture == "bifurcation" and axes > 1:
        yield (*path, "axes"), f'picture = "bifurcation" is of one axis, not {axes}'
    elif table.picture == "period" and axes == 1:
        yield (*path, "axes"), 'picture = "period" is of two axes or three: add one, or write picture = "values"'
    elif table.picture in PLANES and (axes != 2 or table.axes[-1].key_ not in (FREQUENCY, None)):
        yield (*path, "axes"), f'picture = "{table.picture}" is of two axes, the last of them {FREQUENCY}'
    elif axes > 3:
        yield (*path, "axes"), f"{axes} axes cannot be drawn: three at most"
    if table.picture == "basins" and not starts and table.starts is None:
        said = "start.displacement and start.velocity as axes, or starts = 50"
        yield (*path, "picture"), f'"basins" is of motions with starts of their own: write {said}'
    elif table.picture == "basins" and starts and axes > 2:
        yield (*path, "axes"), 'picture = "basins" with starts as axes is of two axes at most'
    elif table.picture != "basins" and table.starts is not None:
        yield (*path, "picture"), f'"{table.picture}" shows one motion a point: with starts write "basins"'
    hold = getattr(case.sweep, "hold", None) if table.hold is None else table.hold
    if table.strobes is not None and hold is not None and table.strobes > hold:
        yield (*path, "strobes"), f"{table.strobes} values need as many periods held: hold is {hold}"


def count_of(axis: SimpleNamespace) -> int:
    """Number of values of an axis."""
    return len(axis.values) if axis.values else axis.points or 1
