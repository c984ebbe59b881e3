"""What was measured: numbers of an experiment that the model is compared with, and never judged by."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Annotated, Any

from vibeam.case.faults import Complaint
from vibeam.case.plans import Direction, Measured
from vibeam.casefile.amounts import Amount, AmountEntry
from vibeam.casefile.fields import ANY, POSITIVE, Text
from vibeam.casefile.tables.expectations import ReadingTable, reading_checks
from vibeam.casefile.tables.readings import si_unit
from vibeam.casefile.tables.table import key


def measured_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about every [measured.NAME]."""
    for name, measured in case.measured.items():
        yield from reading_checks(case, ("measured", name), measured)


class MeasuredTable(ReadingTable):
    """A number that was measured, which the model is compared with and never judged by, one table each."""

    value: Annotated[Amount, AmountEntry(ANY)] = key("the number measured, with its unit", "0.39 mm")
    scatter: Annotated[Amount | None, AmountEntry(POSITIVE)] = key(
        "scatter of the measurement, in its unit or as a percentage; absent = not given", "5 %", None
    )
    source: Annotated[str, Text()] = key("figure, table or section that gives it", "Fig. 31(b)")


def record(name: str, case: Any, swept: Direction, chose: tuple[str, ...]) -> Measured:
    """Record of a table of a case; ``chose``: the keys that the number chose."""
    table = case.measured[name]
    values = table.model_dump() | {"value": table.value.number, "scatter": _absolute_scatter(table)}
    values |= {"direction": table.direction or swept, "unit": si_unit(case, table)}
    return Measured(name=name, chose=chose, **values)


def _absolute_scatter(table: MeasuredTable) -> float | None:
    """Scatter in the unit of the value; a percentage is of the value, of a difference by itself."""
    if table.scatter is None:
        return None
    relative = table.scatter.percent and table.against is None and table.value.number != 0
    return table.scatter.number * (abs(table.value.number) if relative else 1.0)
