"""Table of a map and of each of its axes; rules between its keys: random starts, what a picture needs."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Annotated, Any

from pydantic import Field

from vibeam.case.grid_keys import STARTS
from vibeam.casefile import quantities as units
from vibeam.casefile.fields import FLAG, POSITIVE, TEXT, Count, Each, Quantity, ValueEntry, Word, names
from vibeam.casefile.tables.outputs import OUTPUT_NAME
from vibeam.casefile.tables.table import MOST_POINTS, Frequency, Periods, Table, key
from vibeam.exchange.faults import Complaint, KeyPath

RUNS = ("up", "down", "both", "apart")

READ = (
    "amplitude", "reach", "maximum", "minimum", "impacts_per_period", "impact_velocity", "period", "rest", "energy",
    "lyapunov",
)  # fmt: skip

PICTURES = {
    "period": "class of the motion over two axes, a panel for each value of a third",
    "bifurcation": "the output at the end of each period over one axis, with periodic motions in closed form",
    "basins": "which of the coexisting motions a start leads to, or how many are found, or their shares",
    "spectra": "spectra of the output along one axis, one behind the other",
    "values": "a quantity over one or two axes",
}

STROBES = 32  # of a bifurcation diagram that does not say


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

    key_: Annotated[str, TEXT] = Field(
        alias="key",
        description="a dotted key of the rig, sweep.frequency, fidelity.NAME.modes, start.displacement or .velocity",
        examples=["stop.gap"],
    )
    from_: Annotated[Any, LEVEL] = Field(None, alias="from", description="first value", examples=["-0.1 mm"])
    to: Annotated[Any, LEVEL] = key("last value, itself included", "0.1 mm", None)
    points: Annotated[int | None, Count(1, MOST_POINTS)] = key("how many, evenly spaced", 61, None)
    values: Annotated[tuple[Any, ...] | None, LEVELS] = key(
        "the values themselves, in place of from, to and points", ["-0.1 mm", "0 mm", "0.1 mm"], None, written=False
    )


class MapTable(Table):
    """A map over any keys of the case, one table each, [map] where there is one: what vibeam map computes and draws."""

    axes: tuple[AxisTable, ...] = key(
        "the last is swept and lies across, the one before upward, of one more each value has a panel",
        [{"key": "stop.gap", "values": ["0 mm", "0.1 mm"]}, {"key": "sweep.frequency", "values": ["15 Hz", "16 Hz"]}],
    )
    picture: Annotated[str, Word(PICTURES)] = key(
        "; ".join(f"{name}: {meaning}" for name, meaning in PICTURES.items()), "period", "period"
    )
    fidelities: Annotated[tuple[str, ...] | None, names("fidelities", alone=True)] = key(
        "whose; absent = all", ["sdof"], None, written=False
    )
    direction: Annotated[str | None, Word(RUNS)] = key(
        "which way the last axis is swept, the state carried; apart = every point from its own start; absent = the "
        "sweep's, or apart where starts are given",
        "up",
        None,
    )
    frequency: Annotated[float | None, Frequency] = key(
        "of the drive, where sweep.frequency is no axis", "15.3 Hz", None, written=False
    )
    settle: Annotated[int | None, Periods] = key("drive periods left out; absent = the sweep's", 350, None)
    hold: Annotated[int | None, Count(1, MOST_POINTS)] = key("drive periods read; absent = the sweep's", 50, None)
    output: Annotated[str | None, OUTPUT_NAME] = key(
        "the output that is read; absent = the sweep's", "contact", None, written=False
    )
    quantities: Annotated[tuple[str, ...] | None, Each(Word(READ))] = key(
        "what is stored; absent = amplitude and period, and what the picture needs", ["amplitude", "period"], None,
        written=False,
    )  # fmt: skip
    quantity: Annotated[str | None, Word(READ)] = key(
        'what picture = "values" shows; absent = amplitude', "impact_velocity", None, written=False
    )
    strobes: Annotated[int | None, Count(1, 10_000)] = key(
        f"values at the end of a period that are stored; absent = {STROBES} of a bifurcation diagram, else none", 64,
        None, written=False,
    )  # fmt: skip
    starts: Annotated[int | None, Count(1, 100_000)] = key(
        "random starts of every point: what coexists is counted", 50, None, written=False
    )
    seed: Annotated[int, Count(0, 2**31 - 1)] = key("of the random starts", 1, 1, written=False)
    spread: Annotated[float | None, Quantity(units.LENGTH, POSITIVE)] = key(
        "how far from 0 the contact starts at random, its velocity within Ω times that", "1 mm", None, written=False
    )
    boundaries: Annotated[bool, FLAG] = key(
        "whether exact boundaries of motions with one impact a period are laid over, where there are any", False, True,
        written=False,
    )  # fmt: skip


class SdofMapTable(MapTable):
    """A map over any keys of the case, one table each, [map] where there is one: what vibeam map computes and draws."""

    spread: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "how far from 0 the contact starts at random, its velocity within Ω times that", 0.01, None, written=False
    )


def random_complaints(path: KeyPath, table: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about random starts."""
    if table.starts is not None and table.spread is None:
        yield (*path, "spread"), 'missing: says how far from 0 motions start; write spread = "1 mm"'
    elif table.starts is None and table.spread is not None:
        yield (*path, "spread"), "goes with starts: say how many, or leave it away"


def picture_complaints(case: SimpleNamespace, path: KeyPath, table: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about what the picture needs and the axes give."""
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


def direction_of(table: Any, keys: list[str], swept: str | None) -> str:
    """Which way the last axis is swept: as said, else apart where motions have starts of their own, else the sweep's.

    Along a key that changes the modes nothing can be carried: also apart.
    """
    if table.direction is not None:
        return str(table.direction)
    return "apart" if table.starts is not None or any(key in STARTS for key in keys) else swept or "both"


def count_of(axis: SimpleNamespace) -> int:
    """Number of values of an axis."""
    return len(axis.values) if axis.values else axis.points or 1
