"""Amounts: measured values in case files, numbers whose unit is checked against the quantity they belong to."""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal
from typing import Any

from vibeam.case.faults import as_shown_in_message
from vibeam.casefile import quantities as units
from vibeam.casefile.fields import NUMBER_WITH_UNIT, EntryInUnits, Range
from vibeam.casefile.unit_systems import SI, UnitSystem

RATE = units.dimension("1/s")

ANGLE, TURNING, JERK = (units.dimension(unit) for unit in ("rad", "rad/s", "m/s^3"))

KINDS = (units.RATIO, units.FREQUENCY, units.LENGTH, units.SPEED, units.TIME, RATE, units.ACCELERATION, ANGLE)

#: dimension of an output's quantity, and of its rate
OF_OUTPUT = {
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
    return OF_OUTPUT[of][unit.endswith("/s")] if unit.startswith("q") else DIMENSIONS[unit]


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
class AmountEntry(EntryInUnits):
    """A number with any unit that a compared quantity may have, or a percentage; a plain number where it has none."""

    range: Range

    def read(self, value: Any, system: UnitSystem | None) -> Amount:
        """As ``Entry.read``."""
        if not isinstance(value, str):
            units.to_si(value, units.RATIO)
            amount = Amount(value, system=system)
        else:
            kind = next((kind for kind in KINDS if _suits(value, kind)), units.RATIO)
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
