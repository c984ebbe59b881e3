"""Comparison of a result with what was measured: differences, no verdicts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import isclose, isfinite
from typing import TYPE_CHECKING

from vibeam.case.plans import Measured
from vibeam.studies.regression.readings import NAN, directions, read

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.runs.result import Result


SAME = 1e-6  # relative difference of branches that are one row, and of a difference that is just the scatter


@dataclass(frozen=True)
class MeasuredRow:
    """Measured number beside the model's, in ``unit`` (m, m/s, Hz, 1/s, 1).

    ``number``: of the mode or order. ``frequency`` in Hz, ``difference``: model − measured, NaN where the model has no
    such number (``notes`` say why). ``within``: whether it is within the scatter of the measurement; None where that is
    not given. ``chose``: keys of the model that the number chose: with any, the model is calibrated by it and it
    tests nothing; without, the model predicts it.
    """

    measured: str
    fidelity: str
    quantity: str
    number: float | None
    against: str | None
    frequency: float
    direction: str
    unit: str
    value: float
    scatter: float | None
    model: float
    difference: float
    within: bool | None
    chose: tuple[str, ...]
    source: str
    notes: tuple[str, ...] = ()
    kind: str = "measured"


def compare(case: Case, result: Result) -> list[MeasuredRow]:
    """Compare ``result`` with every measured number of ``case``; one row each, one a branch where they differ."""
    return [row for each in case.measured.values() for row in _rows(each, result)]


def _rows(measured: Measured, result: Result) -> Iterator[MeasuredRow]:
    rows = [_row(measured, result, direction) for direction in directions(measured)]
    first, last = rows[0], rows[-1]
    same = isclose(first.model, last.model, rel_tol=SAME) or (first.notes and first.notes == last.notes)
    yield from [replace(first, direction="both" if measured.show else measured.direction)] if same else rows


def _row(measured: Measured, result: Result, direction: str) -> MeasuredRow:
    found = read(measured, result, direction)
    difference = found.number - measured.value
    known = measured.scatter is not None and isfinite(difference)
    return MeasuredRow(
        measured=measured.name,
        fidelity=measured.fidelity,
        quantity=measured.quantity,
        number=measured.number,
        against=measured.against,
        frequency=NAN if measured.frequency is None else measured.frequency,
        direction=direction,
        unit=measured.unit,
        value=measured.value,
        scatter=measured.scatter,
        model=found.number,
        difference=difference,
        within=abs(difference) <= (measured.scatter or 0.0) * (1 + SAME) if known else None,
        chose=measured.chose,
        source=measured.source,
        notes=tuple(filter(None, (found.fault, found.note))),
    )
