"""Tables of numbers that a model is compared with, expected or measured; their amounts, in a unit of what is read."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal
from types import SimpleNamespace
from typing import Any

from vibeam.case.plans import Direction, Expectation, MeasuredNumber, ResultNumber
from vibeam.case.study_plans import ERRORS, EXTENTS
from vibeam.case.transient_quantities import QUANTITIES as OF_RECORDS
from vibeam.casefile import quantities as units
from vibeam.casefile.fields import Entry, Word
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.quantities import ANY, NUMBER_WITH_UNIT, POSITIVE, SI, Dimension, Range, UnitSystem
from vibeam.casefile.tables.declared import table
from vibeam.casefile.tables.maps import LEVEL
from vibeam.casefile.tables.outputs import main_output, of_displacement, quantity_named
from vibeam.casefile.tables.table import NAME, QUANTITIES, named_fidelity, plan_keys, plan_of
from vibeam.casefile.tables.transient_numbers import (
    ENERGY,
    swept_number_checks,
    transient_checks,
    transient_dimension,
)
from vibeam.exchange.faults import Complaint, KeyPath, as_shown_in_message, shortened, suggest
from vibeam.figures import FIGURES, OF_OUTPUT, kinds_alone, quantities_shown, units_read
from vibeam.figures.declaration import FigureKind
from vibeam.system.quantities import LAYOUT

RATE = units.dimension("1/s")
ANGLE, TURNING, JERK = (units.dimension(unit) for unit in ("rad", "rad/s", "m/s^3"))
COMPARED = (units.RATIO, units.FREQUENCY, units.LENGTH, units.SPEED, units.TIME, RATE, units.ACCELERATION, ANGLE,
            units.FORCE, ENERGY)  # fmt: skip

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
    "m": units.LENGTH,
    "m s-1": units.SPEED,
    "m s-2": units.ACCELERATION,
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
            kind = next((kind for kind in COMPARED if units.suits(value, kind)), units.RATIO)
            amount = Amount(units.to_si(value, kind), kind, value.strip().endswith("%"))
        self.range.check(amount.number, value)
        return amount

    def describe(self) -> str:
        """As ``Entry.describe``."""
        known = "number | % | Hz | m | m/s | s | 1/s | m/s^2 | rad | N | J"
        return " ".join(filter(None, [known, self.range.describe()]))

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


AMOUNTS = {"expect": ("value",), "measured": ("value", "uncertainty"), "reference": ("offset", "uncertainty")}


def amount_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about amounts whose unit is missing, or not one of the quantity that is read."""
    for kind, keys in AMOUNTS.items():
        for name, reading in getattr(case, kind).items():
            for key in keys if reading.quantity is not None else ():
                amount = getattr(reading, key)
                if amount is None or (amount.percent and key == "uncertainty"):
                    continue
                if fault := amount.fault(reading.quantity, dimension_read(case, reading)):
                    yield (kind, name, key), fault


def amounts_in_si(case: Any) -> dict[str, Any]:
    """The comparing tables of a checked case, by name, their amounts in SI."""
    found = {kind: dict(getattr(case, kind)) for kind in AMOUNTS}
    for kind, keys in AMOUNTS.items():
        for name, reading in found[kind].items():
            wanted = dimension_read(case, reading)
            amounts = {key: amount.of(wanted) for key in keys if (amount := getattr(reading, key)) is not None}
            found[kind][name] = reading.with_(**amounts)
    return found


def dimension_read(case: Any, reading: Any) -> Dimension:
    """Dimension of what a table reads, off the output of its figure, or of the sweep."""
    if case.record is not None and getattr(reading, "show", None) is None:
        return transient_dimension(case, reading)
    shown = case.show.get(getattr(reading, "show", None))
    of = quantity_named(case, (shown and shown.output) or main_output(case)).name
    unit = unit_of_reading(reading.quantity, getattr(reading, "against", None))
    return kind_of_reading(unit, plain=KINDS[case.kind].plain, of=of)


def si_unit(case: Any, reading: Any) -> str:
    """SI unit of what a table reads; ``"1"`` of a plain number."""
    return dimension_read(case, reading).unit or "1"


def unit_of_reading(quantity: str, against: str | None) -> str:
    """Unit of a compared quantity: q and q/s of an output and its rate, c and c/s of the contact, Hz, 1/s, or 1."""
    if against is not None:
        return "1"
    if quantity in OF_OUTPUT:
        return "q"
    if quantity in EXTENTS:
        return "q" if quantity == "peak" else "Hz"
    if quantity not in OF_SWEEPS or quantity in ERRORS:
        return "1"  # of a record, which its own rule says, or a share
    return (units_read() | quantities_shown()).get(quantity) or LAYOUT[quantity].unit


def expectation_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about every [expect.NAME]."""
    for name, expect in case.expect.items():
        yield from reading_checks(case, ("expect", name), expect)


def reading_checks(case: SimpleNamespace, path: KeyPath, expect: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about where an [expect.NAME] or [measured.NAME] finds its number."""
    yield from named_fidelity(case, (*path, "fidelity"), expect.fidelity)
    yield from named_fidelity(case, (*path, "against"), expect.against)
    if case.record is not None and expect.show is None:
        yield from transient_checks(case, path, expect)
        return
    yield from swept_number_checks(path, expect)
    if expect.quantity in OF_RECORDS and expect.quantity not in OF_SWEEPS:
        yield (*path, "quantity"), f'"{expect.quantity}" is of a [record]: name another'
        return
    yield from swept_checks(case, (*path, "direction"), expect.direction)
    if expect.quantity in OF_OUTPUT:
        yield from of_displacement(case, (*path, "quantity"), expect.quantity)
    if expect.show is not None or expect.number is not None or expect.quantity in units_read():
        yield from _of_a_figure(case, path, expect)
    elif expect.quantity in EXTENTS + ERRORS and expect.frequency is not None:
        yield (*path, "frequency"), f'"{expect.quantity}" is of a whole branch: leave the frequency away'
    elif expect.quantity in (*QUANTITIES, *OF_OUTPUT, *quantities_shown()) and expect.frequency is None:
        yield (*path, "frequency"), f'missing: "{expect.quantity}" is read at one frequency'


def _of_a_figure(case: SimpleNamespace, path: KeyPath, expect: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about a number that is, or should be, read off a figure."""
    if expect.show is None and (alone := kinds_alone().get(expect.quantity)):
        yield from _chosen(path, expect, FIGURES[alone])
        return
    if expect.show is None:
        what = (
            f"[show.NAME] that {as_shown_in_message(expect.quantity)} is read off" if expect.quantity else "[show.NAME]"
        )
        yield (*path, "show"), f"missing: name the {what}"
        return
    if expect.show not in case.show:
        yield (
            (*path, "show"),
            f"no [show.{shortened(expect.show)}]; {suggest(expect.show, filter(NAME.fullmatch, case.show))}",
        )
        return
    show = case.show[expect.show]
    if show.kind is None or expect.quantity is None:
        return
    kind = FIGURES[show.kind]
    if expect.quantity not in kind.reads:
        words = " | ".join(f'"{word}"' for word in kind.reads) or "nothing that can be expected"
        yield (*path, "quantity"), f'kind = "{show.kind}" has {words}'
    yield from _chosen(path, expect, kind)


def _chosen(path: KeyPath, expect: SimpleNamespace, kind: FigureKind) -> Iterator[Complaint]:
    """Complaints about the entry, and the frequency, at which a figure of a ``kind`` is read."""
    if expect.number is None and kind.entries:
        yield (*path, "number"), f'missing: which {kind.entries} of kind = "{kind.name}" is meant; write number = 2'
    elif expect.number is not None and not kind.entries:
        yield (*path, "number"), f'kind = "{kind.name}" is read by its mean: leave it away'
    there = "frequency" in kind.needs + kind.takes
    if there and expect.frequency is None:
        yield (*path, "frequency"), f'missing: kind = "{kind.name}" is read at one frequency'
    elif not there and expect.frequency is not None:
        yield (*path, "frequency"), f'kind = "{kind.name}" has no use for it: leave it away'


def swept_checks(case: SimpleNamespace, path: KeyPath, way: str | None) -> Iterator[Complaint]:
    """A complaint about a direction that is not swept."""
    swept = getattr(case.sweep, "direction", None)
    if way and swept and swept not in ("both", way):
        yield path, f'"{way}" is not swept: sweep.direction is "{swept}"'


OF_SWEEPS = (*QUANTITIES, *OF_OUTPUT, *EXTENTS, *ERRORS, *quantities_shown(), *units_read())


def _reading_table(name: str, plan: type[ResultNumber], meaning: str, **entries: Entry) -> Any:
    compared = Word(tuple(dict.fromkeys((*OF_SWEEPS, *OF_RECORDS))))
    return table(name, meaning, plan_keys(plan, quantity=compared, at=LEVEL, **entries))


ExpectTable: Any = _reading_table(
    "ExpectTable",
    Expectation,
    "A number that a fidelity is checked against, by itself or against another fidelity, one table each.",
    value=AmountEntry(ANY),
)
MeasuredTable: Any = _reading_table(
    "MeasuredTable",
    MeasuredNumber,
    "A number that was measured, which the model is compared with and never judged by, one table each.",
    value=AmountEntry(ANY),
    uncertainty=AmountEntry(POSITIVE),
)


def expectation(name: str, said: Any, swept: Direction) -> Expectation:
    """Plan of an [expect.NAME]."""
    return plan_of(Expectation, said, name=name, value=said.value.number, direction=said.direction or swept)


def measured_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about every [measured.NAME]."""
    for name, measured in case.measured.items():
        yield from reading_checks(case, ("measured", name), measured)


def measured_number(name: str, case: Any, swept: Direction, chose: tuple[str, ...]) -> MeasuredNumber:
    """Plan of a [measured.NAME] of a case; ``chose``: the keys that the number chose."""
    said = case.measured[name]
    return plan_of(
        MeasuredNumber,
        said,
        name=name,
        value=said.value.number,
        uncertainty=_absolute_uncertainty(said),
        direction=said.direction or swept,
        unit=si_unit(case, said),
        chose=chose,
    )


def _absolute_uncertainty(said: Any) -> float | None:
    """Uncertainty in the unit of the value; a percentage is of the value, of a difference by itself."""
    if said.uncertainty is None:
        return None
    relative = said.uncertainty.percent and said.against is None and said.value.number != 0
    return float(said.uncertainty.number) * (abs(said.value.number) if relative else 1.0)
