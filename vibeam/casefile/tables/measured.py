"""What was measured: numbers of an experiment that the model is compared with, and never judged by."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Annotated

from vibeam.case.faults import Complaint, KeyPath
from vibeam.case.plans import Direction, Measured
from vibeam.casefile.amounts import Amount, AmountEntry
from vibeam.casefile.fields import ANY, POSITIVE, Flag, Text
from vibeam.casefile.tables.expectations import ReadingTable, reading_checks
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
        if fault := amount.fault(measured.quantity, unit, plain=not case.with_beam):
            yield (*path, name), fault


def unit_of_reading(quantity: str, against: str | None) -> str:
    """Unit of a compared quantity: q and q/s of an output and its rate, Hz, 1/s, or 1."""
    if against is not None:
        return "1"
    if quantity in LIMITS + OF_OUTPUT:
        return "q"
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


def record(name: str, table: MeasuredTable, swept: Direction, *, plain: bool) -> Measured:
    """Record of a table; ``plain``: outputs have no dimension."""
    unit = unit_of_reading(table.quantity, table.against)
    values = table.model_dump() | {"value": table.value.number, "scatter": _absolute_scatter(table)}
    values |= {"direction": table.direction or swept, "unit": "1" if plain and unit in _SI else _SI.get(unit, unit)}
    return Measured(name=name, **values)


_SI = {"q": "m", "q/s": "m/s"}


def _absolute_scatter(table: MeasuredTable) -> float | None:
    """Scatter in the unit of the value; a percentage is of the value, of a difference by itself."""
    if table.scatter is None:
        return None
    relative = table.scatter.percent and table.against is None and table.value.number != 0
    return table.scatter.number * (abs(table.value.number) if relative else 1.0)
