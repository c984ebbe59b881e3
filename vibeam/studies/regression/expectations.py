"""Regression of single numbers: expectations of a fidelity, by itself or against another one."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite
from typing import TYPE_CHECKING

from vibeam.case.plans import Expectation
from vibeam.studies.regression.readings import NAN, Found, directions, read
from vibeam.studies.regression.references import CheckRow

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.runs.result import Result


def check(case: Case, result: Result, *, partial: bool = False) -> list[CheckRow]:
    """Compare ``result`` with every expectation of ``case``.

    One is missed where a branch is off by more than the tolerance, failed, or has no such frequency; ``partial``
    forgives the last for a sweep whose grid was overridden: the row then has 0 points.
    """
    return [_check(each, result, partial) for each in case.expectations.values()]


def _check(expected: Expectation, result: Result, partial: bool) -> CheckRow:
    found = [read(expected, result, direction) for direction in directions(expected)]
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
        notes=tuple(
            dict.fromkeys([*faults, *filter(None, (each.note for each in found)), *_reported(expected, present)])
        ),
        kind="reference" if expected.source else "regression value",
    )


def _deviation(expected: Expectation, number: float) -> float:
    deviations = abs(number - expected.value)
    scale = abs(expected.value) if expected.against is None and expected.value else 1.0
    return deviations / scale if isfinite(deviations) else float("inf")


def _reported(expected: Expectation, found: list[Found]) -> Iterator[str]:
    for each in found:
        if each.fault:
            continue  # its reason is among the notes
        if expected.against is not None:
            yield f"{100 * each.number:+.2f} % against {expected.against}, expected {100 * expected.value:+.4g} %"
        else:
            yield f"{each.number:.5g}, expected {expected.value:.5g}"
