"""Checks: tables of references, regression values and measured numbers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import isfinite

from rich.text import Text

from vibeam.figures.units import METRIC, DisplayUnits
from vibeam.report.output import StudySheet
from vibeam.report.tables import ARROWS, ReportTable, blank
from vibeam.runs.comparison.differences import listed
from vibeam.studies.regression.readings import MeasuredRow
from vibeam.studies.regression.references import CheckRow
from vibeam.system.number_text import percent
from vibeam_models.arguments import counted

NAMED = 3  # names in a list of what is missed
KINDS = {"reference": "reference", "regression value": "regression value", "measured": "measured curve"}
WITHIN = {True: "yes", False: "no", None: ""}


def check_report(
    rows: Sequence[CheckRow], measured: Sequence[MeasuredRow], units: DisplayUnits = METRIC, held: str = "",
    remarks: Sequence[str] = (),
) -> StudySheet:  # fmt: skip
    """Report of a check: whether all holds, the tables, shift and amplitude error of every curve that is off.

    ``held``: restitution that its comparisons of fidelities hold; ``remarks`` on the result.
    """
    found = [f"{row.reference}: {row.registration.sentence}." for row in rows if row.registration is not None]
    data = {
        "rows": [*rows, *measured],
        "passed": sum(row.passed is True for row in rows),
        "missed": sum(row.passed is False for row in rows),
    }
    answer = check_answer(rows, measured) + f" {held} is held." * bool(held)
    return StudySheet(answer, verdicts(rows, measured, units), [*remarks, *found], data=data)


def check_answer(rows: Sequence[CheckRow], measured: Sequence[MeasuredRow]) -> str:
    """Sentence on what holds, what is missed, and what is compared without a verdict."""
    if not (rows or measured):
        return "The case is sound; it names no reference to check against and no measured number."
    hold, missed, beside = [], [], []
    for kind, name in KINDS.items():
        own = [row for row in rows if row.kind == kind and row.passed is not None]
        wrong = [row.reference for row in own if not row.passed]
        if wrong:
            some = wrong if len(wrong) <= NAMED else [*wrong[:NAMED], f"{len(wrong) - NAMED} more"]
            missed.append(f"{len(wrong)} of {counted(len(own), name)} missed ({', '.join(some)})")
        elif own:
            hold.append(counted(len(own), name))
        if free := sum(row.kind == kind and row.passed is None for row in rows):
            beside.append(f"{counted(free, name)} {_are(free)} compared without a tolerance")
    if measured:
        names = {row.measured for row in measured}
        judged = {row.measured for row in measured if row.within is not None}
        held = judged - {row.measured for row in measured if row.within is False}
        within = f", {len(held)} of {len(judged)} within the uncertainty" * bool(judged)
        beside.append(f"{counted(len(names), 'measured number')} {_are(len(names))} beside the model's{within}")
    count = sum(row.passed is True for row in rows)
    every = "All " * (count > 1 and not missed)
    passed = [f"{every}{listed(hold)} hold{'s' * (count == 1)}"] if hold else []
    return f"{'; '.join([*missed, *passed, *beside])}."


def _are(count: int) -> str:
    return "is" if count == 1 else "are"


def verdicts(
    rows: Sequence[CheckRow], measured: Sequence[MeasuredRow], units: DisplayUnits = METRIC
) -> list[ReportTable]:
    """Tables of references, regression values and measured numbers, those that there are; first what is missed."""
    found = [checks(own, units, name) for kind, name in KINDS.items() if (own := [r for r in rows if r.kind == kind])]
    beside = [measurements(measured, units)] if measured else []
    return [*found, *beside] if any(row.passed is False for row in rows) else [*beside, *found]


def checks(rows: Iterable[CheckRow], units: DisplayUnits = METRIC, kind: str = "reference") -> ReportTable:
    """Table of the references (or regression values), those missed first: by how much and where."""
    table = blank(
        f"{kind.capitalize()}s", "", kind, "fidelity", "quantity", "worst|", "at|", "allowed|", "why", heads=2
    )
    table.add("points|", "found", detail=True)
    for row in sorted(rows, key=lambda row: row.passed is not False):
        notes = "; ".join(row.notes)
        why = (notes or "off by more than allowed") if row.passed is False else ""
        points = str(row.points) if row.points == row.total else f"{row.points} of {row.total}"
        numbers = (percent(row.worst), units.frequencies(row.frequency), percent(row.tolerance))
        of = (_verdict(row.passed), row.reference, row.fidelity, row.quantity)
        table.add_row(*of, *numbers, why, points, "" if why else notes)
    return table


def _verdict(passed: bool | None) -> Text:
    if passed is None:
        return Text("compared")
    return Text("passed", style="green") if passed else Text("missed", style="bold red")


def measurements(rows: Sequence[MeasuredRow], units: DisplayUnits = METRIC) -> ReportTable:
    """Table of measured numbers: the model's, their difference, whether it is within the uncertainty."""
    table = ReportTable("Measured", 1)
    table.add("measured", "fidelity", "quantity", "at|", "measured|", "uncertainty|", "model|", "difference|", "within")
    table.add("the model", "chosen by it", "source", "why", detail=True)
    table.caption = "difference: model − measured; within: its uncertainty, nothing where that is not given"
    if any(row.chose for row in rows):
        table.caption += "\ncalibrated: the number chose keys of the model, and tests nothing"
    for row in rows:
        numbers = (row.value, row.uncertainty, row.model)
        values = ("" if each is None else _amount(row, each, units) for each in numbers)
        words = (WITHIN[row.within], "calibrated" if row.chose else "predicted")
        further = (", ".join(row.chose), row.source, "; ".join(row.notes))
        place = (row.measured, row.fidelity, _quantity(row), units.frequencies(row.frequency))
        table.add_row(*place, *values, _difference(row, units), *words, *further)
    return table


def _quantity(row: MeasuredRow) -> str:
    number = "" if row.number is None else f" {row.number:g}"
    against = "" if row.against is None else f" against {row.against}"
    return f"{row.quantity}{number}{against}{ARROWS.get(row.direction, '')}"


def _amount(row: MeasuredRow, value: float, units: DisplayUnits) -> str:
    """Number in the unit of the table's others; a relative difference as a percentage."""
    if row.against is not None:
        return percent(value)
    named = {"m": units.lengths, "m/s": units.speeds, "Hz": units.frequencies}
    if row.unit in named:
        return named[row.unit](value)
    unit = "" if row.unit == "1" else row.unit
    return f"{value:.4g} {unit}".strip() if isfinite(value) else "–"


def _difference(row: MeasuredRow, units: DisplayUnits) -> str:
    if not isfinite(row.difference):
        return "–"
    sign = "+" if row.difference >= 0 else "-"
    own = sign + _amount(row, abs(row.difference), units)
    return own if row.against or not row.value else f"{own} ({sign}{percent(abs(row.difference / row.value))})"
