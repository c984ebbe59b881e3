"""Regression: a result against the reference curves that its case names."""

from __future__ import annotations

import csv
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from vibeam.faults import CaseError, Fault, cure
from vibeam.response import Ended, FrequencyResponse

if TYPE_CHECKING:
    from vibeam.case import Case
    from vibeam.plans import Reference
    from vibeam.response import Branches
    from vibeam.result import Result

QUANTITIES = ("amplitude", "maximum", "minimum", "reach", "impacts_per_period", "impact_velocity", "period")
COLUMNS = ("frequency_hz", "direction", *QUANTITIES)
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


def reference_points(reference: Reference) -> list[Point]:
    """The points of a case's reference, on the branches it is about; CaseError where its file cannot be read."""
    wanted = ("up", "down") if reference.direction == "both" else (reference.direction,)
    return read_reference(reference.file, reference.quantity, wanted)


def read_reference(path: Path, quantity: str, directions: Collection[str] = ("up", "down")) -> list[Point]:
    """The points of a reference file that give ``quantity`` on the branches asked for; CaseError names its faults."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as fault:
        raise CaseError([Fault(str(path), None, "", f"cannot be read: {fault}")]) from None
    numbered = [(number, line) for number, line in enumerate(lines, 1) if line.strip() and not line.startswith("#")]
    head = [cell.strip() for cell in numbered[0][1].split(",")] if numbered else []
    faults = _column_faults(path, head, quantity)
    if faults:
        raise CaseError(faults)
    rows = zip((number for number, _ in numbered[1:]), csv.DictReader(line for _, line in numbered), strict=True)
    return [point for number, row in rows for point in _points(path, number, row, quantity, directions)]


def _column_faults(path: Path, head: list[str], quantity: str) -> list[Fault]:
    missing = [name for name in ("frequency_hz", "direction", quantity) if name not in head]
    unknown = [name for name in head if name not in COLUMNS]
    faults = [Fault(str(path), None, name, "the column is missing") for name in missing]
    return faults + [Fault(str(path), None, name, f"unknown column; {cure(name, COLUMNS)}") for name in unknown]


def _points(
    path: Path, number: int, row: dict[str, str], quantity: str, directions: Collection[str]
) -> Iterator[Point]:
    """One point, or none where nothing is given or on another branch."""
    try:
        point = _point(number, row, quantity)
    except (ValueError, TypeError, AttributeError) as fault:
        raise CaseError([Fault(str(path), number, "", f"is no reference point: {fault}")]) from None
    if point.direction in directions and not point.value is point.period is None:
        yield point


def _point(number: int, row: dict[str, str], quantity: str) -> Point:
    if None in row or None in row.values():
        raise ValueError("it has not one cell a column")
    cells = {name: cell.strip() for name, cell in row.items()}
    if cells["direction"] not in ("up", "down"):
        raise ValueError(f"direction {cells['direction']!r} is neither up nor down")
    value = _finite(cells[quantity]) if cells[quantity] else None
    period = int(cells["period"]) if cells.get("period") else None
    return Point(number, _finite(cells["frequency_hz"]), cells["direction"], value, period)


def _finite(text: str) -> float:
    number = float(text)
    if not isfinite(number):
        raise ValueError(f"{text!r} is not a finite number")
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
