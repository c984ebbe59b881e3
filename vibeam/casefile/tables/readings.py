"""Amounts of the tables that compare: measured values in a unit of what is read, their faults, their SI values."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal
from types import SimpleNamespace
from typing import Any

from vibeam.case.plans import EXTENTS
from vibeam.casefile import quantities as units
from vibeam.casefile.fields import NUMBER_WITH_UNIT, Entry, Range
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.quantities import Dimension
from vibeam.casefile.tables.outputs import quantity_named
from vibeam.casefile.unit_systems import SI, UnitSystem
from vibeam.exchange.faults import Complaint, as_shown_in_message
from vibeam.figures import LIMITS, OF_OUTPUT, READ
from vibeam.system.quantities import LAYOUT

RATE = units.dimension("1/s")
ANGLE, TURNING, JERK = (units.dimension(unit) for unit in ("rad", "rad/s", "m/s^3"))
COMPARED = (units.RATIO, units.FREQUENCY, units.LENGTH, units.SPEED, units.TIME, RATE, units.ACCELERATION, ANGLE)

#: dimension of an output's quantity, and of its rate
READ_AS = {
    "displacement": (units.LENGTH, units.SPEED),
    "velocity": (units.SPEED, units.ACCELERATION),
    "acceleration": (units.ACCELERATION, JERK),
    "slope": (ANGLE, TURNING),
    "strain": (units.RATIO, RATE),
}

#: dimension of a quantity by its unit, with a beam on the bench; q and q/s of a displacement
DIMENSIONS = {
    "1": units.RATIO,
    "Hz": units.FREQUENCY,
    "q": units.LENGTH,
    "q/s": units.SPEED,
    "c": units.LENGTH,
    "c/s": units.SPEED,
    "s": units.TIME,
    "1/s": RATE,
}


def kind_of_reading(unit: str, *, plain: bool, of: str = "displacement") -> units.Dimension:
    """Dimension of a compared quantity by its unit; ``plain``: outputs have none; ``of``: what the output reads."""
    if plain and unit[0] in "qc":
        return units.RATIO
    return READ_AS[of][unit.endswith("/s")] if unit.startswith("q") else DIMENSIONS[unit]


@dataclass(frozen=True)
class Amount:
    """Number in SI and its dimension; None: written without a unit, in those of ``system``. ``percent``: so written."""

    number: float
    kind: units.Dimension | None = None
    percent: bool = False
    system: UnitSystem | None = SI

    def of(self, wanted: units.Dimension) -> Amount:
        """The same in SI, as that of a quantity; UnitError where its unit is missing."""
        return self if self.kind else Amount(units.to_si(self.number, wanted, self.system), wanted)

    def fault(self, quantity: str, wanted: units.Dimension) -> str | None:
        """Reason why this cannot be a ``quantity``, which is of the dimension ``wanted``."""
        try:
            kind = self.of(wanted).kind
        except units.UnitError as missing:
            return str(missing)
        if kind is None or kind == wanted:
            return None
        written = "a percentage" if self.percent else kind.phrase
        return f'{written}, but "{quantity}" is {wanted.phrase}: write it as {as_shown_in_message(wanted.example)}'


@dataclass(frozen=True)
class AmountEntry(Entry):
    """A number with any unit that a compared quantity may have, or a percentage; a plain number where it has none."""

    range: Range

    def read(self, value: Any, system: UnitSystem | None) -> Amount:
        """As ``Entry.read``."""
        if not isinstance(value, str):
            units.to_si(value, units.RATIO)
            amount = Amount(value, system=system)
        else:
            kind = next((kind for kind in COMPARED if _suits(value, kind)), units.RATIO)
            amount = Amount(units.to_si(value, kind), kind, value.strip().endswith("%"))
        self.range.check(amount.number, value)
        return amount

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return " ".join(filter(None, ["number | % | Hz | m | m/s | s | 1/s | m/s^2 | rad", self.range.describe()]))

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        text = {"type": "string", "pattern": NUMBER_WITH_UNIT}
        return {"anyOf": [{"type": "number"} | self.range.schema(), text]}

    def canonical(self, value: Any) -> Any:
        """As ``Entry.canonical``."""
        if not isinstance(value, Amount):
            return value
        if value.percent:
            return f"{Decimal(repr(value.number)) * 100:f} %"
        return units.with_unit(value.number, value.kind or units.RATIO)


def _suits(text: str, kind: units.Dimension) -> bool:
    try:
        units.to_si(text, kind)
    except units.UnitError:
        return False
    return True


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
