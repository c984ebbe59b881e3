"""What was measured: numbers of an experiment that the model is compared with, and never judged by."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Annotated, Any

from vibeam.case.faults import Complaint, KeyPath
from vibeam.case.plans import Direction, Measured
from vibeam.casefile.amounts import Amount, AmountEntry
from vibeam.casefile.fields import ANY, POSITIVE, Flag, Text
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.tables.expectations import ReadingTable, reading_checks
from vibeam.casefile.tables.outputs import quantity_named
from vibeam.casefile.tables.table import EXTENTS, key
from vibeam.figures import LIMITS, OF_OUTPUT, READ
from vibeam.system.quantities import LAYOUT


def measured_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about every [measured.NAME]."""
    for name, measured in case.measured.items():
        path: KeyPath = ("measured", name)
        yield from reading_checks(case, path, measured)
        if measured.quantity is not None:
            yield from _unit_checks(case, path, measured)


def _unit_checks(case: SimpleNamespace, path: KeyPath, measured: SimpleNamespace) -> Iterator[Complaint]:
    unit = unit_of_reading(measured.quantity, measured.against)
    for name in ("value", "scatter"):
        amount: Amount | None = getattr(measured, name)
        if amount is None or (name == "scatter" and amount.percent):
            continue
        of = _read_of(case, measured)
        if fault := amount.fault(measured.quantity, unit, plain=KINDS[case.kind].plain, of=of):
            yield (*path, name), fault


def unit_of_reading(quantity: str, against: str | None) -> str:
    """Unit of a compared quantity: q and q/s of an output and its rate, c and c/s of the contact, Hz, 1/s, or 1."""
    if against is not None:
        return "1"
    if quantity in LIMITS + OF_OUTPUT:
        return "q" if quantity in OF_OUTPUT else "c"
    if quantity in EXTENTS:
        return "q" if quantity == "peak" else "Hz"
    return READ[quantity] if quantity in READ else LAYOUT[quantity].unit


class MeasuredTable(ReadingTable):
    """A number that was measured, which the model is compared with and never judged by, one table each."""

    value: Annotated[Amount, AmountEntry(ANY)] = key("the number measured, with its unit", "0.39 mm")
    scatter: Annotated[Amount | None, AmountEntry(POSITIVE)] = key(
        "scatter of the measurement, in its unit or as a percentage; absent = not given", "5 %", None
    )
    calibrated: Annotated[bool, Flag()] = key(
        "whether the model was fitted to this number; if not, the model predicts it", False, False
    )
    source: Annotated[str, Text()] = key("figure, table or section that gives it", "Fig. 31(b)")


def _read_of(case: Any, reading: Any) -> str:
    """What the output is that a number is read of: the figure's where it names one, or the sweep's."""
    shown = case.show.get(reading.show)
    return quantity_named(case, (shown and shown.output) or case.sweep.output).name


def record(name: str, table: MeasuredTable, case: Any, swept: Direction) -> Measured:
    """Record of a table of a case."""
    plain, unit = KINDS[case.kind].plain, unit_of_reading(table.quantity, table.against)
    si = {"c": "m", "c/s": "m/s"} | dict(zip(("q", "q/s"), _SI[_read_of(case, table)], strict=True))
    values = table.model_dump() | {"value": table.value.number, "scatter": _absolute_scatter(table)}
    values |= {"direction": table.direction or swept, "unit": "1" if plain and unit in si else si.get(unit, unit)}
    return Measured(name=name, **values)


_SI = {
    "displacement": ("m", "m/s"),
    "velocity": ("m/s", "m/s^2"),
    "acceleration": ("m/s^2", "m/s^3"),
    "slope": ("rad", "rad/s"),
    "strain": ("1", "1/s"),
}


def _absolute_scatter(table: MeasuredTable) -> float | None:
    """Scatter in the unit of the value; a percentage is of the value, of a difference by itself."""
    if table.scatter is None:
        return None
    relative = table.scatter.percent and table.against is None and table.value.number != 0
    return table.scatter.number * (abs(table.value.number) if relative else 1.0)
