"""Regression of single numbers: expectations of a fidelity, by itself or against another one."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.plans import Expectation
from vibeam.case.reference_curves import SAME_FREQUENCY
from vibeam.figures import FIGURES, LIMITS
from vibeam.studies.regression.references import CheckRow
from vibeam.system.response import Ended, FrequencyResponse, period_one_range, periodic

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.run.result import Result


NAN = float("nan")


@dataclass(frozen=True)
class _Found:
    """Number on one branch, NaN with the reason ``fault``."""

    number: float
    fault: str = ""
    absent: bool = False  #: the frequency is not in the grid


def check(case: Case, result: Result, *, partial: bool = False) -> list[CheckRow]:
    """Compare ``result`` with every expectation of ``case``.

    One is missed where a branch is off by more than the tolerance, failed, or has no such frequency; ``partial``
    forgives the last for a sweep whose grid was overridden: the row then has 0 points.
    """
    return [_check(each, result, partial) for each in case.expectations.values()]


def _check(expected: Expectation, result: Result, partial: bool) -> CheckRow:
    found = [_found(expected, result, direction) for direction in _directions(expected)]
    present = [each for each in found if not each.absent]
    deviations = [_deviation(expected, each.number) for each in present]
    worst = max(deviations, default=NAN)
    faults = [each.fault for each in found if each.fault and not (partial and each.absent)]
    within = all(each <= expected.tolerance for each in deviations)
    return CheckRow(
        reference=expected.name,
        fidelity=expected.fidelity,
        quantity=expected.quantity,
        points=len(present),
        total=len(found),
        worst=worst,
        frequency=NAN if expected.frequency is None else expected.frequency,
        tolerance=expected.tolerance,
        passed=within and not faults,
        notes=tuple(dict.fromkeys([*faults, *_reported(expected, present)])),
    )


def _directions(expected: Expectation) -> tuple[str, ...]:
    if expected.quantity in LIMITS or expected.show:
        return ("up",)  # of the motions as such, whichever direction they are swept in
    return ("up", "down") if expected.direction == "both" else (expected.direction,)


def _deviation(expected: Expectation, number: float) -> float:
    deviations = abs(number - expected.value)
    scale = abs(expected.value) if expected.against is None and expected.value else 1.0
    return deviations / scale if isfinite(deviations) else float("inf")


def _reported(expected: Expectation, found: list[_Found]) -> Iterator[str]:
    for each in found:
        if expected.against is not None:
            yield f"{100 * each.number:+.2f} % against {expected.against}, expected {100 * expected.value:+.4g} %"
        else:
            yield f"{each.number:.5g}, expected {expected.value:.5g}"


def _found(expected: Expectation, result: Result, direction: str) -> _Found:
    ours = _number(expected, result, expected.fidelity, direction)
    if expected.against is None or ours.fault:
        return ours
    other = _number(expected, result, expected.against, direction)
    if other.fault:
        return _Found(NAN, f"{expected.against} {other.fault}", other.absent)
    return _Found(ours.number / other.number - 1 if other.number else NAN)


def _number(expected: Expectation, result: Result, name: str, direction: str) -> _Found:
    if expected.show is not None:
        return _read_off(expected, expected.show, result, name)
    if expected.quantity in LIMITS:
        return _limit(expected, result, name)
    response = dict(result[name].items())[direction]
    if expected.frequency is None:
        number = EXTENTS[expected.quantity](response)
        return _Found(number, "" if isfinite(number) else f"{direction}: there is none")
    present = np.flatnonzero(np.isclose(response.frequency, expected.frequency, rtol=SAME_FREQUENCY, atol=0))
    if not len(present):
        return _Found(NAN, f"{expected.frequency:g} Hz is not in the sweep's grid", absent=True)
    ended = Ended.of_code(int(response.ended[present[0]]))
    if ended is not Ended.COMPLETE:
        return _Found(NAN, f"{direction}: {ended.value}")
    number = float(getattr(response, expected.quantity)[present[0]])
    return _Found(number, "" if isfinite(number) else f"{direction}: there is none")


def _limit(expected: Expectation, result: Result, name: str) -> _Found:
    from vibeam.figures.kinds.boundaries import limits

    number = float(limits(result.case, name, np.array([expected.frequency]), expected.quantity)[0])
    return _Found(number, "" if isfinite(number) else "there is none")


def _read_off(expected: Expectation, show: str, result: Result, name: str) -> _Found:
    """Read the number off a figure's data, computed for this alone where the run has none."""
    from vibeam.figures.sheet import sheet_at

    plan = result.case.shows[show]
    sheet = sheet_at(result.case, plan, name, expected.frequency, result.shown.get(show, ()))
    if sheet.fault:
        return _Found(NAN, sheet.fault)
    values = sheet.of(expected.quantity)
    if expected.number is not None:
        values = values[np.isclose(sheet[FIGURES[plan.kind].entries], expected.number)]
    present = values[np.isfinite(values)]
    return _Found(float(np.mean(present))) if len(present) else _Found(NAN, "there is none")


def _top(response: FrequencyResponse) -> int | None:
    present = periodic(response)
    return int(np.argmax(np.where(present, response.amplitude, -np.inf))) if present.any() else None


def _peak(response: FrequencyResponse) -> float:
    top = _top(response)
    return NAN if top is None else float(response.amplitude[top])


def _peak_frequency(response: FrequencyResponse) -> float:
    top = _top(response)
    return NAN if top is None else float(response.frequency[top])


def _range(response: FrequencyResponse, end: int) -> float:
    found = period_one_range(response)
    return NAN if found is None else found[end]


EXTENTS: dict[str, Callable[[FrequencyResponse], float]] = {
    "peak": _peak,
    "peak_frequency": _peak_frequency,
    "period_one_from": lambda response: _range(response, 0),
    "period_one_to": lambda response: _range(response, 1),
}
