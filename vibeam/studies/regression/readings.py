"""Numbers read off a result, by themselves or against another fidelity; beside what was measured, without verdict."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import isclose, isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.plans import MeasuredNumber, ResultNumber, ShowPlan
from vibeam.case.response_quantities import values_of
from vibeam.case.study_plans import ERRORS
from vibeam.exchange.curves.record import SAME_FREQUENCY
from vibeam.figures import FIGURES, kinds_alone, quantities_shown
from vibeam.studies.regression.number_read import NAN, NumberRead
from vibeam.system.response import Ended, FrequencyResponse
from vibeam_models.registry import loaded

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.runs.result import Result


def directions(reading: ResultNumber, case: Case) -> tuple[str, ...]:
    """Directions of the branches that a reading is of; one that says nothing under a record."""
    if case.record is not None:
        return ("",)
    if reading.quantity in (*quantities_shown(), *ERRORS) or of_figure(reading):
        return ("up",)  # of the motions as such, whichever direction they are swept in
    return ("up", "down") if reading.direction == "both" else (reading.direction,)


def read(reading: ResultNumber, result: Result, direction: str) -> NumberRead:
    """Number of a reading on one branch."""
    if result.case.record is not None and reading.show is None:
        from vibeam.studies.regression.transient_readings import read_transient

        transient: Any = result
        return read_transient(reading, transient)
    ours = _number(reading, result, reading.fidelity, direction)
    if reading.against is None or ours.fault:
        return ours
    other = _number(reading, result, reading.against, direction)
    if other.fault:
        return NumberRead(NAN, f"{reading.against} {other.fault}", absent=other.absent)
    if not other.number:
        return NumberRead(NAN, f"{direction}: {reading.against} is 0 there: nothing to compare with")
    return NumberRead(ours.number / other.number - 1, note=ours.note or other.note)


def _number(reading: ResultNumber, result: Result, name: str, direction: str) -> NumberRead:
    if of_figure(reading):
        return _read_off(reading, result, name)
    if reading.quantity in quantities_shown():
        return _limit(reading, result, name)
    if reading.quantity in ERRORS:
        return _error(reading, result, name)
    response = dict(result[name].items())[direction]
    if reading.frequency is None:
        number = EXTENTS[reading.quantity](response)
        irregular = reading.quantity in OF_PEAK and isfinite(number) and not response.peak.repeats
        note = f"{direction}: the motion at the peak does not repeat" * irregular
        return NumberRead(number, "" if isfinite(number) else f"{direction}: there is none", note)
    present = np.flatnonzero(np.isclose(response.frequency, reading.frequency, rtol=SAME_FREQUENCY, atol=0))
    if not len(present):
        return NumberRead(NAN, f"{reading.frequency:g} Hz is not in the sweep's grid", absent=True)
    ended = Ended.of_code(int(response.ended[present[0]]))
    if ended is not Ended.COMPLETE:
        return NumberRead(NAN, f"{direction}: {ended.value}")
    number = float(values_of(result.case, name, response, reading.quantity)[present[0]])
    return NumberRead(number, "" if isfinite(number) else f"{direction}: there is none")


def _limit(reading: ResultNumber, result: Result, name: str) -> NumberRead:
    home = next(kind.home for kind in FIGURES.values() if reading.quantity in kind.quantities)
    found = loaded(home).numbers(result.case, name, np.array([reading.frequency]), reading.quantity)
    number = float(found[0])
    return NumberRead(number, "" if isfinite(number) else "there is none")


def _error(reading: ResultNumber, result: Result, name: str) -> NumberRead:
    """Error of a fidelity against the finest of its rig, of that against a fuller model."""
    found = next(each for each in result.compare() if each.fidelity == name)
    if found.comparison is None:
        return NumberRead(0.0) if found.whole else NumberRead(NAN, found.why or "it is not compared")
    number = float(getattr(found.comparison, reading.quantity))
    return NumberRead(number, "" if isfinite(number) else "no motion to compare")


def of_figure(reading: ResultNumber) -> bool:
    """Test whether a number is read off a figure, that of its [show.NAME] or one that needs no such table."""
    return reading.show is not None or reading.quantity in kinds_alone()


def _read_off(reading: ResultNumber, result: Result, name: str) -> NumberRead:
    """Read the number off a figure's data, computed for this alone where the run has none."""
    from vibeam.figures.sheet import sheet_at

    show = reading.show or ""
    usual = ShowPlan(name="", kind=kinds_alone().get(reading.quantity, ""), key="", fidelities=(name,))
    plan = result.case.shows.get(show, usual)
    sheet = sheet_at(result.case, plan, name, reading.frequency, result.shown.get(show, ()))
    if sheet.fault:
        return NumberRead(NAN, sheet.fault)
    values = sheet.of(reading.quantity)
    if reading.number is not None:
        values = values[np.isclose(sheet[FIGURES[plan.kind].entries], reading.number)]
    present = values[np.isfinite(values)]
    return NumberRead(float(np.mean(present))) if len(present) else NumberRead(NAN, "there is none")


def _range(response: FrequencyResponse, end: int) -> float:
    found = response.period_one
    return NAN if found is None else found[end]


OF_PEAK = ("peak", "peak_frequency")

EXTENTS: dict[str, Callable[[FrequencyResponse], float]] = {
    "peak": lambda response: response.peak.amplitude,
    "peak_frequency": lambda response: response.peak.frequency,
    "period_one_from": lambda response: _range(response, 0),
    "period_one_to": lambda response: _range(response, 1),
}


SAME = 1e-6  # relative difference of branches that are one row, and of a difference that is just the uncertainty


@dataclass(frozen=True)
class MeasuredRow:
    """Measured number beside the model's, in ``unit`` (m, m/s, Hz, 1/s, 1).

    ``number``: of the mode or order. ``frequency`` in Hz, ``difference``: model − measured, NaN where the model has no
    such number (``notes`` say why). ``within``: whether it is within the uncertainty of the measurement; None where
    that is not given. ``chose``: keys of the model that the number chose: with any, the model is calibrated by it and
    it tests nothing; without, the model predicts it.
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
    uncertainty: float | None
    model: float
    difference: float
    within: bool | None
    chose: tuple[str, ...]
    source: str
    notes: tuple[str, ...] = ()
    kind: str = "measured"


OF_MEASURED = ("fidelity", "quantity", "number", "against", "unit", "value", "uncertainty", "chose", "source")


def compare(case: Case, result: Result) -> list[MeasuredRow]:
    """Compare ``result`` with every measured number of ``case``; one row each, one a branch where they differ."""
    return [row for each in case.measured.values() for row in _rows(each, result)]


def _rows(measured: MeasuredNumber, result: Result) -> Iterator[MeasuredRow]:
    rows = [_row(measured, result, direction) for direction in directions(measured, result.case)]
    first, last = rows[0], rows[-1]
    same = isclose(first.model, last.model, rel_tol=SAME) or (first.notes and first.notes == last.notes)
    yield from [replace(first, direction="both" if of_figure(measured) else measured.direction)] if same else rows


def _row(measured: MeasuredNumber, result: Result, direction: str) -> MeasuredRow:
    found = read(measured, result, direction)
    difference = found.number - measured.value
    known = measured.uncertainty is not None and isfinite(difference)
    return MeasuredRow(
        **{name: getattr(measured, name) for name in OF_MEASURED},
        measured=measured.name,
        frequency=NAN if measured.frequency is None else measured.frequency,
        direction=direction,
        model=found.number,
        difference=difference,
        within=abs(difference) <= (measured.uncertainty or 0.0) * (1 + SAME) if known else None,
        notes=tuple(filter(None, (found.fault, found.note))),
    )
