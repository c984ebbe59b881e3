"""Amounts: measured values in case files, numbers whose unit is checked against the quantity they belong to."""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal
from typing import Any

from vibeam.case.faults import as_shown_in_message
from vibeam.casefile import quantities as units
from vibeam.casefile.fields import NUMBER_WITH_UNIT, Entry, Range

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


@dataclass(frozen=True)
class Amount:
    """Number in SI and its dimension; None: written without a unit. ``percent``: written as a percentage."""

    number: float
    kind: units.Dimension | None = None
    percent: bool = False

    def fault(self, quantity: str, unit: str, *, plain: bool, of: str = "displacement") -> str | None:
        """Reason why this cannot be a ``quantity`` of that unit.

        ``plain``: outputs have no dimension; ``of``: what the output reads.
        """
        wanted = units.RATIO if plain and unit[0] in "qc" else DIMENSIONS[unit]
        if not plain and unit.startswith("q"):
            wanted = OF_OUTPUT[of][unit.endswith("/s")]
        if self.kind in (None, wanted):
            return None
        assert self.kind is not None
        written = "a percentage" if self.percent else self.kind.phrase
        return f'{written}, but "{quantity}" is {wanted.phrase}: write it as {as_shown_in_message(wanted.example)}'


@dataclass(frozen=True)
class AmountEntry(Entry):
    """A number with any unit that a compared quantity may have, a percentage, or a plain number in SI units."""

    range: Range

    def parse(self, value: Any) -> Amount:
        """As ``Entry.parse``."""
        if not isinstance(value, str):
            amount = Amount(units.to_si(value, units.RATIO))
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
        if not isinstance(value, Amount) or value.kind is None:
            return value.number if isinstance(value, Amount) else value
        if value.percent:
            return f"{Decimal(repr(value.number)) * 100:f} %"
        return f"{value.number!r} {value.kind.unit}".strip()


def _suits(text: str, kind: units.Dimension) -> bool:
    try:
        units.to_si(text, kind)
    except units.UnitError:
        return False
    return True
