"""Table [reference.NAME]: a curve that a fidelity is compared with; rules between its keys; its record."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path as File
from types import SimpleNamespace
from typing import Any

from vibeam.case.plans import Direction, Reference
from vibeam.casefile import quantities as units
from vibeam.casefile.fields import JsonSchema, Several, ValueEntry, Word
from vibeam.casefile.quantities import ANY, NUMBER_WITH_UNIT, POSITIVE
from vibeam.casefile.tables.declared import Table, key, table
from vibeam.casefile.tables.expectations import AmountEntry, si_unit, swept_checks
from vibeam.casefile.tables.table import QUANTITIES, Frequency, named_fidelity, plan_keys, plan_of
from vibeam.exchange.curves.record import QUANTITIES as OF_CURVES
from vibeam.exchange.curves.record import ROLES, ReferenceForm
from vibeam.exchange.faults import Complaint, KeyPath, as_shown_in_message, suggest
from vibeam.exchange.files import file_fault
from vibeam.exchange.units import known_unit

NAMES = (ROLES[0], *OF_CURVES, *ROLES[1:])


def _columns(value: Any, said: str) -> dict[str, Any]:
    if not isinstance(value, dict) or not value:
        raise ValueError(f"must be {said}, not {as_shown_in_message(value)}")
    for name in value:
        if name not in NAMES:
            raise ValueError(f"{as_shown_in_message(name)} is no column of a reference; {suggest(name, NAMES)}")
    return dict(value)


def _of_columns(reading: Callable[[Any], Any], said: str, each: JsonSchema) -> ValueEntry:
    own = {"properties": dict.fromkeys(NAMES, each), "minProperties": 1, "additionalProperties": False}
    return ValueEntry(reading, said, {"type": "object"} | own)


def _heads(value: Any) -> dict[str, str | int]:
    found = _columns(value, HEADS.describe())
    for name, head in found.items():
        if isinstance(head, bool) or not isinstance(head, str | int) or not head:
            raise ValueError(f"{name}: must be a head in quotes or a column's number, not {as_shown_in_message(head)}")
        if isinstance(head, int) and not 0 < head <= 10_000:
            raise ValueError(f"{name}: columns are numbered from 1, not {as_shown_in_message(head)}")
    return found


def _units(value: Any) -> dict[str, str]:
    found = _columns(value, COLUMN_UNITS.describe())
    for name, unit in found.items():
        if not isinstance(unit, str) or not known_unit(unit):
            raise ValueError(f'{name}: {as_shown_in_message(unit)} is no unit that is known: write "mm"')
    return found


def _scale(value: Any) -> tuple[float, str]:
    text, unit = value, ""
    if isinstance(value, str):
        text, _, unit = value.strip().partition(" ")
        unit = unit.strip().replace("μ", "µ")
        if unit and not known_unit(unit):
            raise ValueError(f'{as_shown_in_message(value)} has an unknown unit: write "2 mm/V"')
    number = units.to_si(text, units.RATIO)
    if not number:
        raise ValueError("is 0: no value would be left")
    return number, unit


def _scale_written(value: Any) -> Any:
    return value if not isinstance(value, tuple) else f"{value[0]!r} {value[1]}" if value[1] else value[0]


#: head of each column, or its number from 1; the units of columns
HEAD: JsonSchema = {"anyOf": [{"type": "string"}, {"type": "integer", "minimum": 1}]}
HEADS = _of_columns(_heads, '{ frequency = "head", amplitude = 2 }', HEAD)
COLUMN_UNITS = _of_columns(_units, '{ frequency = "Hz", amplitude = "mm" }', {"type": "string"})

#: a number other than 0, with a unit where it turns one quantity into another
NUMBER: JsonSchema = {"anyOf": [{"type": "number"}, {"type": "string", "pattern": NUMBER_WITH_UNIT}]}
SCALE = ValueEntry(_scale, "number ≠ 0 | mm/V …", NUMBER, _scale_written)

SIGNS = {"semicolon": ";", "comma": ",", "tab": "\t", "bar": "|", "blank": " "}


class _Form(Table):
    columns = key(
        HEADS, "heads of the file's columns, or their numbers from 1; variables, datasets, number of the data set 58",
        {"frequency": "f [Hz]", "amplitude": "x [mm]", "uncertainty": "u [mm]"}, None,
    )  # fmt: skip
    units = key(COLUMN_UNITS, "units of columns whose heads do not say them; absent = SI", {"amplitude": "mm"}, None)
    separator = key(Word(tuple(SIGNS)), "between the cells of a line of text; absent = found out", "semicolon", None)
    decimal = key(Word((".", ",")), "decimal sign in text; absent = found out", ",", None)
    scale = key(SCALE, "factor of the values, with a unit where it is a sensor's", "2 mm/V", None)
    offset = key(AmountEntry(ANY), "added to the values after scale", "0.05 mm", None)
    window = key(
        Several(Frequency, limit=2, ascending=True),
        "lowest and highest frequency compared; absent = all",
        ["14 Hz", "17 Hz"],
        None,
    )
    uncertainty = key(
        AmountEntry(POSITIVE),
        "standard uncertainty of every value, in its unit or as a percentage of it, where no column gives it",
        "2 %",
        None,
    )


_AFTER = ("measured", "source")
_KEYS = plan_keys(Reference, quantity=Word(QUANTITIES))
_BEFORE = {name: each for name, each in _KEYS.items() if name not in _AFTER}
MEANING = "A curve that a fidelity is checked against, one table each."
ReferenceTable = table("ReferenceTable", MEANING, _BEFORE, _Form, {name: _KEYS[name] for name in _AFTER})


def reference_checks(case: SimpleNamespace, folder: File) -> Iterator[Complaint]:
    """Complaints about every [reference.NAME]; files are looked for from ``folder``."""
    for name, reference in case.reference.items():
        path: KeyPath = ("reference", name)
        yield from named_fidelity(case, (*path, "fidelity"), reference.fidelity)
        if reference.file is not None and (fault := fault_of_file(folder, reference.file)):
            yield (*path, "file"), fault
        yield from swept_checks(case, (*path, "direction"), reference.direction)
        if reference.tolerance is None and not reference.measured:
            yield (*path, "tolerance"), 'missing: write tolerance = "1 %", or measured = true for no verdict'
        if reference.window is not None and len(reference.window) != 2:
            yield (*path, "window"), 'must be two frequencies: write window = ["… Hz", "… Hz"]'
        if reference.quantity is not None:
            yield from _column_checks(path, reference)


def _column_checks(path: KeyPath, reference: SimpleNamespace) -> Iterator[Complaint]:
    for part in ("columns", "units"):
        for name in getattr(reference, part) or ():
            if name not in (*ROLES, reference.quantity):
                yield (*path, part), f'{name} is not compared: quantity = "{reference.quantity}"'


def fault_of_file(folder: File, name: str) -> str | None:
    """Reason why a file of measured data cannot be read, None where it can."""
    fault = file_fault(folder / name)
    if fault == "no such file":
        return f"no file {as_shown_in_message(name)} in the case file's folder"
    return fault and f"{as_shown_in_message(name)} {fault}"


def record(name: str, said: Any, case: Any, folder: File, swept: Direction) -> Reference:
    """Record of a table of a case."""
    own = {"direction": said.direction or swept, "form": _form(said, si_unit(case, said))}
    quote = (folder / said.file).resolve().is_relative_to(folder.resolve())
    return plan_of(Reference, said, name=name, file=(folder / said.file).absolute(), quote=quote, **own)


def _form(table: Any, unit: str) -> ReferenceForm:
    scale, scale_unit = table.scale or (1.0, "")
    lowest, highest = table.window or (None, None)
    return ReferenceForm(
        columns=table.columns or {},
        units=table.units or {},
        unit=unit,
        scale=scale,
        scale_unit=scale_unit,
        offset=0.0 if table.offset is None else table.offset.number,
        window=None if lowest is None or highest is None else (lowest, highest),
        uncertainty=None if table.uncertainty is None else table.uncertainty.number,
        relative=table.uncertainty is not None and table.uncertainty.percent,
        separator=SIGNS.get(table.separator or "", ""),
        decimal=table.decimal or "",
    )
