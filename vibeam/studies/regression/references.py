"""Regression of a result against the reference curves of its case."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np

from vibeam.exchange.curves.record import SAME_FREQUENCY, Point
from vibeam.exchange.faults import CaseError, Fault
from vibeam.studies.regression.registration import CurveRegistration, Piece, register
from vibeam.system.response import Branches, Ended, FrequencyResponse

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.plans import Reference
    from vibeam.runs.result import Result

SMALL = 1e-6  # smallest reference value for relative differences, as a share of the column's largest
COVERAGE = 2.0  # standard uncertainties that a difference may be for the measurement's sake: 95 %
TOLD = 3  # points named that are missed
COMPARABLE = 1e-4  # largest relative difference from which on a curve is registered
CONTINUOUS = ("amplitude", "maximum", "minimum", "reach", "impact_velocity")  # over frequency: these may be shifted


@dataclass(frozen=True)
class CheckRow:
    """Outcome of one reference: ``points`` of ``total`` were compared; ``worst`` is relative, at ``frequency`` (Hz).

    ``kind``: ``"reference"``, derived by others, ``"regression value"``, an earlier result of the model itself, or
    ``"measured"``. ``passed`` None: no tolerance, no verdict. ``registration``: shift and amplitude error of the curve.
    """

    reference: str
    fidelity: str
    quantity: str
    points: int
    total: int
    worst: float
    frequency: float
    tolerance: float
    passed: bool | None
    notes: tuple[str, ...] = ()
    kind: str = "reference"
    registration: CurveRegistration | None = None


@dataclass(frozen=True)
class Match:
    """Reference point beside the computed one: the relative difference and other faults.

    The difference is ∞ where the computed value is missing, 0 where the reference gives only the period. ``excess``:
    the difference over what tolerance and measurement allow; missed above 1. ``direction``: of the branch compared.
    """

    point: Point
    difference: float
    fault: str
    excess: float
    direction: str
    value: float


def check(
    case: Case, result: Result, *, partial: bool = False, at: Mapping[str, Branches] | None = None
) -> list[CheckRow]:
    """Compare ``result`` with every reference of ``case``.

    A reference is missed where a difference exceeds its tolerance and twice the standard uncertainty of the value, a
    period differs, a point failed, or a reference point has no counterpart in the sweep; ``partial`` forgives the last
    as long as one point is compared (for a sweep whose grid was overridden). ``at``: branches with the references' own
    frequencies, by reference. CaseError where a reference file cannot be read.
    """
    branches = {name: result[each.fidelity] for name, each in case.references.items()} if at is None else at
    return [_check(each, branches[name], partial) for name, each in case.references.items()]


def require_readable(case: Case) -> None:
    """Raise CaseError for faulty reference files of a case, before anything is computed."""
    faults: list[Fault] = []
    for reference in case.references.values():
        try:
            reference.read()
        except CaseError as wrong:
            faults += wrong.faults
    if faults:
        raise CaseError(faults)


def _check(reference: Reference, branches: Branches, partial: bool) -> CheckRow:
    curve = reference.read()
    points = curve.along(("up", "down") if reference.direction == "both" else (reference.direction,))
    matches = list(matched(reference, points, branches))
    worst = max(matches, key=lambda match: (match.excess, match.difference), default=None)
    faults = [match.fault for match in matches if match.fault]
    unmatched = [point for point in points if point not in {match.point for match in matches}]
    within = worst is not None and worst.excess <= 1
    passed = bool(within and not faults and (partial or not unmatched))
    return CheckRow(
        reference=reference.name,
        fidelity=reference.fidelity,
        quantity=reference.quantity,
        points=len(matches),
        total=len(points),
        worst=float(worst.difference) if worst else float("nan"),
        frequency=worst.point.frequency if worst else float("nan"),
        tolerance=float("nan") if reference.tolerance is None else reference.tolerance,
        passed=None if reference.tolerance is None else passed,
        notes=tuple(_notes(reference, branches, len(points), unmatched, matches)),
        kind="measured" if reference.measured else "regression value" if curve.recorded else "reference",
        registration=registered(reference, matches, branches),
    )


def _notes(
    reference: Reference, branches: Branches, total: int, unmatched: list[Point], matches: list[Match]
) -> Iterator[str]:
    if not total:
        yield "the file has no such point"
    elif unmatched:
        yield f"{len(unmatched)} of {total} reference points are {_absence(unmatched, branches)}"
    faults = [match.fault for match in matches if match.fault]
    if faults:
        more = f" (and {len(faults) - 1} more)" if len(faults) > 1 else ""
        yield faults[0] + more
    missed = sorted((match for match in matches if 1 < match.excess < float("inf")), key=lambda match: -match.excess)
    if missed and reference.tolerance is not None:
        places = "; ".join(_place(match, reference.form.unit) for match in missed[:TOLD])
        yield f"{len(missed)} of {len(matches)} points off by more than allowed: {places}"
    if any(match.point.direction is None for match in matches) and len(list(branches.items())) > 1:
        yield "no direction is given: each point is compared with the nearer branch"


def _absence(unmatched: list[Point], branches: Branches) -> str:
    ends = [(response.frequency.min(), response.frequency.max()) for _, response in branches.items() if len(response)]
    low, high = min((end[0] for end in ends), default=0.0), max((end[1] for end in ends), default=0.0)
    margin = 1 + SAME_FREQUENCY
    if all(point.frequency * margin < low or point.frequency > high * margin for point in unmatched):
        return f"outside the sweep, {low:.6g} … {high:.6g} Hz: widen it, or give the reference a window"
    return "not in the sweep's grid"


def _place(match: Match, unit: str) -> str:
    """A missed point: where, what it is, what it should be, lengths in mm."""
    factor, unit = (1e3, f"m{unit}") if unit in ("m", "m/s") else (1.0, "" if unit == "1" else unit)
    wanted, given = match.point.value or 0.0, match.point.uncertainty
    scatter = "" if given is None else f" ± {factor * given:.2g}"
    off = match.value - wanted
    relative = f" ({100 * off / abs(wanted):+.3g} %)" if wanted else ""
    said = f"{factor * match.value:.4g}", f"{factor * wanted:.4g}{scatter} {unit}".strip()
    return f"{match.point.frequency:.6g} Hz {match.direction} {said[0]}, not {said[1]}{relative}"


def matched(reference: Reference, points: list[Point], branches: Branches) -> Iterator[Match]:
    """Match reference points with the computed ones at their frequencies, those without direction with the nearer."""
    ours = dict(branches.items())
    least = SMALL * max((abs(point.value or 0.0) for point in points), default=0.0)
    for point in points:
        found = []
        for direction in [point.direction] if point.direction else list(ours):
            response = ours.get(direction)
            where = _index(response, point.frequency)
            if response is not None and where is not None:
                found.append(_match(reference, point, direction, (response, where), least))
        if found:
            yield min(found, key=lambda match: (bool(match.fault), match.excess))


def _index(response: FrequencyResponse | None, frequency: float) -> int | None:
    if response is None:
        return None
    found = np.flatnonzero(np.isclose(response.frequency, frequency, rtol=SAME_FREQUENCY, atol=0))
    return int(found[0]) if len(found) else None


def _match(
    reference: Reference, point: Point, direction: str, at: tuple[FrequencyResponse, int], least: float
) -> Match:
    response, where = at
    said, infinite = f"at {point.frequency:g} Hz {direction}", float("inf")
    ended = Ended.of_code(int(response.ended[where]))
    if ended is not Ended.COMPLETE:
        return Match(point, infinite, f"{said}: {ended.value}", infinite, direction, float("nan"))
    period = int(response.period[where])
    fault = "" if point.period in (None, period) else f"{said}: period {period}, not {point.period}"
    if point.value is None:
        return Match(point, 0.0, fault, 0.0, direction, float("nan"))
    value = float(getattr(response, reference.quantity)[where])
    off, scale = abs(value - float(point.value)), max(abs(float(point.value)), least)
    if not isfinite(off):
        return Match(point, infinite, fault, infinite, direction, value)
    allowed = (reference.tolerance or 0.0) * scale + COVERAGE * (point.uncertainty or 0.0)
    excess = off / allowed if allowed else (infinite if off else 0.0)
    return Match(point, off / scale if off else 0.0, fault, excess, direction, value)


def registered(reference: Reference, matches: list[Match], branches: Branches) -> CurveRegistration | None:
    """Register the branches with the reference points matched on them; None where that says nothing."""
    if reference.quantity not in CONTINUOUS:
        return None
    points = [match for match in matches if match.point.value is not None and isfinite(match.value)]
    if not any(match.difference > COMPARABLE for match in points):
        return None  # nothing to tell apart
    frequency = np.array([match.point.frequency for match in points])
    value = np.array([match.point.value for match in points], dtype=float)
    used = {match.direction for match in points}
    return register(
        [piece for way in sorted(used) for piece in pieces_of(branches, way, reference.quantity)], frequency, value
    )


def pieces_of(branches: Branches, direction: str, quantity: str) -> list[Piece]:
    """Pieces of a branch's periodic motions, cut at jumps and changes of the period."""
    from vibeam.observe.branches import MotionClass, pieces

    response = dict(branches.items())[direction]
    value, scattered = (
        np.asarray(getattr(response, quantity), dtype=float),
        (MotionClass.FAILED, MotionClass.NOT_PERIODIC),
    )
    found = [each for each in pieces(response, value) if each.kind not in scattered]
    return [(response.frequency[each.points], value[each.points]) for each in found]
