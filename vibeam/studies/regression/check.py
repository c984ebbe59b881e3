"""Regression check of a case: its result, flown where references are, against curves, expected and measured numbers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.plans import Expectation
from vibeam.case.source import of_source
from vibeam.exchange.curves.record import SAME_FREQUENCY
from vibeam.studies.regression import readings, references
from vibeam.studies.regression.number_read import NAN, NumberRead
from vibeam.studies.regression.readings import MeasuredRow, directions, read
from vibeam.studies.regression.references import CheckRow
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.runs.result import Result
    from vibeam.system.response import Branches


def check_expectations(case: Case, result: Result, *, partial: bool = False) -> list[CheckRow]:
    """Compare ``result`` with every expectation of ``case``.

    One is missed where a branch is off by more than the tolerance, failed, or has no such frequency; ``partial``
    forgives the last for a sweep whose grid was overridden: the row then has 0 points.
    """
    return [_check(each, result, partial) for each in case.expectations.values()]


def _check(expected: Expectation, result: Result, partial: bool) -> CheckRow:
    found = [read(expected, result, direction) for direction in directions(expected, result.case)]
    present = [each for each in found if not each.absent]
    deviations = [_deviation(expected, each.number) for each in present]
    faults = [each.fault for each in found if each.fault and not (partial and each.absent)]
    within = all(each <= expected.tolerance for each in deviations)
    return CheckRow(
        reference=expected.name,
        fidelity=expected.fidelity,
        quantity=expected.quantity,
        points=len(present),
        total=len(found),
        worst=max(deviations, default=NAN),
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


def _reported(expected: Expectation, found: list[NumberRead]) -> Iterator[str]:
    for each in found:
        if each.fault:
            continue  # its reason is among the notes
        if expected.against is not None:
            yield f"{100 * each.number:+.2f} % against {expected.against}, expected {100 * expected.value:+.4g} %"
        else:
            yield f"{each.number:.5g}, expected {expected.value:.5g}"


def at_references(case: Case, result: Result, *, partial: bool = False) -> dict[str, Branches]:
    """Branches by reference: those of ``result`` where its grid has all points, else swept anew with the others in it.

    Frequencies beyond the ends of the grid are not flown: no motion leads there. ``partial``: what is on the grid is
    enough, as long as there is anything.
    """
    wanted = {name: _off_grid(case, name, result, partial) for name in case.references}
    further: dict[str, Array] = {}
    for name, off in wanted.items():
        fidelity = case.references[name].fidelity
        if len(off):
            further[fidelity] = np.union1d(further.get(fidelity, np.empty(0)), off)
    swept = {fidelity: _swept(case, fidelity, off) for fidelity, off in further.items()}
    return {
        name: swept[reference.fidelity] if len(wanted[name]) else result[reference.fidelity]
        for name, reference in case.references.items()
    }


def _off_grid(case: Case, name: str, result: Result, partial: bool) -> Array:
    """Frequencies of a reference inside the grid's ends, and not in it."""
    grid, there = case.sweep.frequency, np.unique([point.frequency for point in case.references[name].points()])
    nearest = grid[np.searchsorted((grid[1:] + grid[:-1]) / 2, there)]
    off = np.abs(there - nearest) > SAME_FREQUENCY * there
    if partial and not off.all():
        return np.empty(0)
    return np.asarray(there[off & (there > grid.min()) & (there < grid.max())])


def _swept(case: Case, fidelity: str, further: Array) -> Branches:
    from vibeam.runs.run import run

    grid = np.union1d(case.sweep.frequency, further)
    own = replace(case.alone(fidelity), swept=replace(case.sweep, frequency=grid))
    found: Any = run(own, show=False)[fidelity]
    return found  # type: ignore[no-any-return]  # of a sweep


@of_source
def check(case: Case, result: Result | None = None, *, partial: bool = False) -> list[CheckRow]:
    """Compare a case with its references and expectations, one row each; ``row.passed`` is the verdict.

    ``result`` None: the case is run, every fidelity by itself. References are compared at their own frequencies: what
    the sweep does not have between its ends is flown. ``partial`` forgives frequencies that it does not have. CaseError
    for a reference file that cannot be read.

    >>> import vibeam
    >>> rows = vibeam.check("cases/dtu_neutral.toml")
    >>> all(row.passed is not False for row in rows)
    True
    """
    result = _result(case) if result is None else result
    at = at_references(case, result, partial=partial)
    return references.check(case, result, partial=partial, at=at) + check_expectations(case, result, partial=partial)


@of_source
def compare_measured(case: Case, result: Result | None = None) -> list[MeasuredRow]:
    """Compare a case with its measured numbers, one row each; ``result`` as for ``check``. There is no verdict.

    >>> import vibeam
    >>> number = {"fidelity": "sdof", "quantity": "peak_frequency", "direction": "up", "value": "15.2 Hz"}
    >>> case = vibeam.load("cases/dtu_neutral.toml", {"measured.peak": number | {"source": "a log book"}})
    >>> [(row.value, row.model, round(row.difference, 6)) for row in vibeam.compare_measured(case)]  # Hz
    [(15.2, 15.3, 0.1)]
    """
    return readings.compare(case, _result(case) if result is None else result)


def _result(case: Case) -> Any:
    from vibeam.runs.run import run

    return run(case, show=False)
