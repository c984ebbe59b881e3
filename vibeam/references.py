"""Regression: a result against the reference curves that its case names."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from re import fullmatch
from typing import TYPE_CHECKING

import numpy as np

from vibeam.faults import CaseError, Fault, cure, shown
from vibeam.reference_files import cells_of, fault_in
from vibeam.response import Ended, FrequencyResponse

if TYPE_CHECKING:
    from vibeam.case import Case
    from vibeam.plans import Reference
    from vibeam.response import Branches
    from vibeam.result import Result

QUANTITIES = ("amplitude", "maximum", "minimum", "reach", "impacts_per_period", "impact_velocity", "period")
COLUMNS = ("frequency_hz", "direction", *QUANTITIES)
NO_COLUMNS = "does not begin with the names of its columns: write {}"
SAME_FREQUENCY = 1e-9  # relative
SMALL = 1e-6  # a reference value is taken as no less than this share of the column's largest


@dataclass(frozen=True)
class Point:
    """One line of a reference file; None: not given, then not compared."""

    line: int
    frequency: float
    direction: str
    value: float | None
    period: int | None


@dataclass(frozen=True)
class CheckRow:
    """How one reference fared: ``points`` of ``total`` were compared; ``worst`` is relative, at ``frequency`` (Hz)."""

    reference: str
    fidelity: str
    quantity: str
    points: int
    total: int
    worst: float
    frequency: float
    tolerance: float
    passed: bool
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Match:
    """A reference point beside ours: the relative difference and what else is wrong.

    The difference is ∞ where ours has no number, 0 where the reference gives only the period.
    """

    point: Point
    difference: float
    fault: str


def check(case: Case, result: Result, *, partial: bool = False) -> list[CheckRow]:
    """Compare ``result`` with every reference of ``case``.

    A reference is missed where a difference exceeds its tolerance, a period differs, a point failed, or a reference
    point has no counterpart in the sweep; ``partial`` forgives the last as long as one point is compared (for a sweep
    whose grid was overridden). CaseError where a reference file cannot be read.
    """
    return [_check(reference, result, partial) for reference in case.references.values()]


def require_readable(case: Case) -> None:
    """CaseError with what is wrong in the reference files of a case: before anything is computed."""
    faults: list[Fault] = []
    for reference in case.references.values():
        try:
            reference_points(reference)
        except CaseError as wrong:
            faults += wrong.faults
    if faults:
        raise CaseError(faults)


def reference_points(reference: Reference) -> list[Point]:
    """The points of a case's reference, on the branches it is about; CaseError where its file cannot be read."""
    wanted = ("up", "down") if reference.direction == "both" else (reference.direction,)
    return read_reference(reference.file, reference.quantity, wanted, quote=reference.quote)


def read_reference(
    path: Path, quantity: str, directions: Collection[str] = ("up", "down"), *, quote: bool = True
) -> list[Point]:
    """The points of a reference file that give ``quantity`` on the branches asked for; CaseError names its faults.

    ``quote``: whether messages may show what the file holds, not only the line at which it is wrong.
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
    wrong += [(name, f"unknown column; {cure(name, COLUMNS)}") for name in head if name not in COLUMNS]
    wrong += [(name, "the column is there twice") for name in COLUMNS if head.count(name) > 1]
    return [fault_in(path, line, message, name) for name, message in wrong]


def _point(number: int, row: tuple[list[str], list[str]], quantity: str) -> Point:
    head, given = row
    if len(head) != len(given):
        raise ValueError(f"{len(given)} cells for {len(head)} columns")
    cells = dict(zip(head, given, strict=True))
    if cells["direction"] not in ("up", "down"):
        raise ValueError(f"direction {shown(cells['direction'])} is neither up nor down")
    value = _finite(cells[quantity]) if cells[quantity] else None
    period = cells.get("period")
    if period and not fullmatch("[+-]?[0-9]{1,9}", period):
        raise ValueError(f"the period {shown(period)} is not a whole number")
    return Point(number, _finite(cells["frequency_hz"]), cells["direction"], value, int(period) if period else None)


def _finite(text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        raise ValueError(f"{shown(text)} is not a number") from None
    if not isfinite(number):
        raise ValueError(f"{shown(text)} is not a finite number")
    return number


def _check(reference: Reference, result: Result, partial: bool) -> CheckRow:
    points = reference_points(reference)
    matches = list(_matches(points, result[reference.fidelity], reference.quantity))
    worst = max(matches, key=lambda match: match.difference, default=None)
    faults = [match.fault for match in matches if match.fault]
    unmatched = len(points) - len(matches)
    within = worst is not None and worst.difference <= reference.tolerance
    return CheckRow(
        reference=reference.name,
        fidelity=reference.fidelity,
        quantity=reference.quantity,
        points=len(matches),
        total=len(points),
        worst=worst.difference if worst else float("nan"),
        frequency=worst.point.frequency if worst else float("nan"),
        tolerance=reference.tolerance,
        passed=within and not faults and (partial or not unmatched),
        notes=tuple(_notes(len(points), unmatched, faults)),
    )


def _notes(total: int, unmatched: int, faults: list[str]) -> Iterator[str]:
    if not total:
        yield "the file has no such point"
    elif unmatched:
        yield f"{unmatched} of {total} reference points are not in the sweep's grid"
    if faults:
        more = f" (and {len(faults) - 1} more)" if len(faults) > 1 else ""
        yield faults[0] + more


def _matches(points: list[Point], branches: Branches, quantity: str) -> Iterator[_Match]:
    ours = dict(branches.items())
    least = SMALL * max((abs(point.value or 0.0) for point in points), default=0.0)
    for point in points:
        response = ours.get(point.direction)
        where = _index(response, point.frequency)
        if response is not None and where is not None:
            yield _match(point, response, where, quantity, least)


def _index(response: FrequencyResponse | None, frequency: float) -> int | None:
    if response is None:
        return None
    found = np.flatnonzero(np.isclose(response.frequency, frequency, rtol=SAME_FREQUENCY, atol=0))
    return int(found[0]) if len(found) else None


def _match(point: Point, response: FrequencyResponse, where: int, quantity: str, least: float) -> _Match:
    at = f"at {point.frequency:g} Hz {point.direction}"
    ended = Ended.of_code(int(response.ended[where]))
    if ended is not Ended.COMPLETE:
        return _Match(point, float("inf"), f"{at}: {ended.value}")
    period = int(response.period[where])
    fault = "" if point.period in (None, period) else f"{at}: period {period}, not {point.period}"
    if point.value is None:
        return _Match(point, 0.0, fault)
    off = abs(float(getattr(response, quantity)[where]) - point.value)
    difference = off / max(abs(point.value), least) if off else 0.0
    return _Match(point, difference if isfinite(difference) else float("inf"), fault)
