"""Regression of a result against the reference curves of its case."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.faults import CaseError, Fault
from vibeam.case.reference_curves import SAME_FREQUENCY, Point, reference_points
from vibeam.system.response import Ended, FrequencyResponse

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.plans import Reference
    from vibeam.run.result import Result
    from vibeam.system.response import Branches

SMALL = 1e-6  # smallest reference value for relative differences, as a share of the column's largest


@dataclass(frozen=True)
class CheckRow:
    """Outcome of one reference: ``points`` of ``total`` were compared; ``worst`` is relative, at ``frequency`` (Hz).

    ``kind``: ``"reference"``, derived by others, or ``"regression value"``, an earlier result of the model itself.
    """

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
    kind: str = "reference"


@dataclass(frozen=True)
class _Match:
    """Reference point beside the computed one: the relative difference and other faults.

    The difference is ∞ where the computed value is missing, 0 where the reference gives only the period.
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
    """Raise CaseError for faulty reference files of a case, before anything is computed."""
    faults: list[Fault] = []
    for reference in case.references.values():
        try:
            reference_points(reference)
        except CaseError as wrong:
            faults += wrong.faults
    if faults:
        raise CaseError(faults)


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
