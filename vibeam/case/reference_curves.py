"""Regression of a result against the reference curves of its case."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from re import fullmatch
from typing import TYPE_CHECKING

from vibeam.case.faults import CaseError, Fault, as_shown_in_message, suggest
from vibeam.case.reference_files import cells_of, fault_in

if TYPE_CHECKING:
    from vibeam.case.plans import Reference


QUANTITIES = ("amplitude", "maximum", "minimum", "reach", "impacts_per_period", "impact_velocity", "period")

COLUMNS = ("frequency_hz", "direction", *QUANTITIES)

NO_COLUMNS = "does not begin with the names of its columns: write {}"

SAME_FREQUENCY = 1e-9  # relative tolerance


@dataclass(frozen=True)
class Point:
    """Line of a reference file; None: not given, then not compared."""

    line: int
    frequency: float
    direction: str
    value: float | None
    period: int | None


def reference_points(reference: Reference) -> list[Point]:
    """Points of a case's reference on its branches; CaseError where its file cannot be read."""
    wanted = ("up", "down") if reference.direction == "both" else (reference.direction,)
    return read_reference(reference.file, reference.quantity, wanted, quote=reference.quote)


def read_reference(
    path: Path, quantity: str, directions: Collection[str] = ("up", "down"), *, quote: bool = True
) -> list[Point]:
    """Read the points of a reference file for ``quantity`` on given branches; CaseError names its faults.

    ``quote``: whether messages may quote the file's content, not only the line number.
    """
    lines = cells_of(path)
    first, head = next(lines, (None, []))
    faults = _column_faults(path, first, head, quantity)
    if faults:
        raise CaseError(faults if quote else [fault_in(path, first, NO_COLUMNS.format(_heading(quantity)))])
    found = []
    for number, cells in lines:
        try:
            point = _point(number, (head, cells), quantity)
        except ValueError as fault:
            why = str(fault) if quote else "write a frequency in Hz, up or down, and numbers"
            raise CaseError([fault_in(path, number, f"is no reference point: {why}")]) from None
        if point.direction in directions and not point.value is point.period is None:
            found.append(point)
    return found


def _heading(quantity: str) -> str:
    return f"frequency_hz,direction,{quantity}"


def _column_faults(path: Path, line: int | None, head: list[str], quantity: str) -> list[Fault]:
    if not set(head) & set(COLUMNS):
        return [fault_in(path, line, NO_COLUMNS.format(_heading(quantity)))]
    wrong = [(name, "the column is missing") for name in _heading(quantity).split(",") if name not in head]
    wrong += [(name, f"unknown column; {suggest(name, COLUMNS)}") for name in head if name not in COLUMNS]
    wrong += [(name, "the column is there twice") for name in COLUMNS if head.count(name) > 1]
    return [fault_in(path, line, message, name) for name, message in wrong]


def _point(number: int, row: tuple[list[str], list[str]], quantity: str) -> Point:
    head, given = row
    if len(head) != len(given):
        raise ValueError(f"{len(given)} cells for {len(head)} columns")
    cells = dict(zip(head, given, strict=True))
    if cells["direction"] not in ("up", "down"):
        raise ValueError(f"direction {as_shown_in_message(cells['direction'])} is neither up nor down")
    value = _finite(cells[quantity]) if cells[quantity] else None
    period = cells.get("period")
    if period and not fullmatch("[+-]?[0-9]{1,9}", period):
        raise ValueError(f"the period {as_shown_in_message(period)} is not a whole number")
    return Point(number, _finite(cells["frequency_hz"]), cells["direction"], value, int(period) if period else None)


def _finite(text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        raise ValueError(f"{as_shown_in_message(text)} is not a number") from None
    if not isfinite(number):
        raise ValueError(f"{as_shown_in_message(text)} is not a finite number")
    return number
