"""Amounts of the tables that compare: the dimension of what each reads, what is wrong with it, and its value in SI."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

from vibeam.case.faults import Complaint
from vibeam.casefile.amounts import kind_of_reading
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.quantities import Dimension
from vibeam.casefile.tables.outputs import quantity_named
from vibeam.casefile.tables.table import EXTENTS
from vibeam.figures import LIMITS, OF_OUTPUT, READ
from vibeam.system.quantities import LAYOUT

AMOUNTS = {"expect": ("value",), "measured": ("value", "scatter"), "reference": ("offset", "uncertainty")}

SHARES = ("scatter", "uncertainty")  # which may be a percentage of the value


def amount_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about amounts whose unit is missing, or not one of the quantity that is read."""
    for table, keys in AMOUNTS.items():
        for name, reading in getattr(case, table).items():
            for key in keys if reading.quantity is not None else ():
                amount = getattr(reading, key)
                if amount is None or (amount.percent and key in SHARES):
                    continue
                if fault := amount.fault(reading.quantity, dimension_read(case, reading)):
                    yield (table, name, key), fault


def amounts_in_si(case: Any) -> dict[str, Any]:
    """The comparing tables of a checked case, by name, their amounts in SI."""
    return {
        table: {name: _in_si(case, reading, keys) for name, reading in getattr(case, table).items()}
        for table, keys in AMOUNTS.items()
    }


def _in_si(case: Any, reading: Any, keys: tuple[str, ...]) -> Any:
    kind = dimension_read(case, reading)
    amounts = {key: amount for key in keys if (amount := getattr(reading, key)) is not None}
    return reading.model_copy(update={key: amount.of(kind) for key, amount in amounts.items()})


def dimension_read(case: Any, reading: Any) -> Dimension:
    """Dimension of what a table reads, off the output of its figure, or of the sweep."""
    shown = case.show.get(getattr(reading, "show", None))
    of = quantity_named(case, (shown and shown.output) or case.sweep.output).name
    unit = unit_of_reading(reading.quantity, getattr(reading, "against", None))
    return kind_of_reading(unit, plain=KINDS[case.kind].plain, of=of)


def si_unit(case: Any, reading: Any) -> str:
    """SI unit of what a table reads; ``"1"`` of a plain number."""
    return dimension_read(case, reading).unit or "1"


def unit_of_reading(quantity: str, against: str | None) -> str:
    """Unit of a compared quantity: q and q/s of an output and its rate, c and c/s of the contact, Hz, 1/s, or 1."""
    if against is not None:
        return "1"
    if quantity in LIMITS + OF_OUTPUT:
        return "q" if quantity in OF_OUTPUT else "c"
    if quantity in EXTENTS:
        return "q" if quantity == "peak" else "Hz"
    return READ[quantity] if quantity in READ else LAYOUT[quantity].unit
