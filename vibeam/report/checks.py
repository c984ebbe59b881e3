"""Checks: tables of references, regression values and measured numbers; the record of a result as reference files."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from io import StringIO
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np
from rich.text import Text

from vibeam.exchange.curves.record import COLUMNS, QUANTITIES
from vibeam.exchange.curves.reference import RECORDED
from vibeam.figures.units import METRIC, DisplayUnits
from vibeam.report.tables import ARROWS, ReportTable, blank
from vibeam.store.provenance import provenance
from vibeam.studies.regression.readings import MeasuredRow
from vibeam.studies.regression.references import CheckRow
from vibeam.system.number_text import percent
from vibeam.system.response import complete

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.runs.result import Result

NAN = float("nan")
WITHIN = {True: "yes", False: "no", None: "not given"}


def verdicts(
    rows: Sequence[CheckRow], measured: Sequence[MeasuredRow], units: DisplayUnits = METRIC
) -> list[ReportTable]:
    """Tables of references, of regression values and of measured numbers, those that there are."""
    kinds = {"reference": "reference", "regression value": "regression value", "measured": "measured curve"}
    found = [checks(own, units, kinds[kind]) for kind in kinds if (own := [row for row in rows if row.kind == kind])]
    return [*found, measurements(measured, units)] if measured else found


def checks(rows: Iterable[CheckRow], units: DisplayUnits = METRIC, kind: str = "reference") -> ReportTable:
    """Table of the references (or regression values): passed or missed, by how much and where."""
    names = ("", kind, "fidelity", "quantity", "points|", "worst|", "at|", "allowed|", "why")
    table = blank(f"{kind.capitalize()}s", *names, heads=2)
    for row in rows:
        mark = _verdict(row.passed)
        points = str(row.points) if row.points == row.total else f"{row.points} of {row.total}"
        numbers = (points, percent(row.worst), units.frequencies(row.frequency), percent(row.tolerance))
        table.add_row(mark, row.reference, row.fidelity, row.quantity, *numbers, _why(row))
    return table


def _verdict(passed: bool | None) -> Text:
    if passed is None:
        return Text("compared")
    return Text("passed", style="green") if passed else Text("missed", style="bold red")


def measurements(rows: Iterable[MeasuredRow], units: DisplayUnits = METRIC) -> ReportTable:
    """Table of measured numbers: the model's, their difference, whether it is within the scatter."""
    table = ReportTable("Measured", 1)
    table.add("measured", "fidelity", "quantity", "at|", "measured|", "scatter|", "model|", "difference|")
    table.add("within scatter", "the model", "chosen by it", "source", "why")
    table.caption = "difference: model − measured; calibrated: the number chose keys of the model, and tests nothing"
    for row in rows:
        numbers = (row.value, NAN if row.scatter is None else row.scatter, row.model)
        values = (_amount(row, each, units) for each in numbers)
        words = (WITHIN[row.within] if isfinite(row.difference) else "–", "calibrated" if row.chose else "predicted")
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


def _why(row: CheckRow) -> str:
    if row.notes:
        return "; ".join(row.notes)
    return "off by more than allowed" if row.passed is False else ""


def record(result: Result, name: str) -> str:
    """The curves of one fidelity as the text of a reference file; points that failed have no values."""
    text = StringIO(newline="")
    for line in _head(result.case, name):
        text.write(f"# {line}\n" if line != RECORDED else f"{line}, which is no reference\n")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for direction, response in result[name].items():
        known = complete(response)
        for index, frequency in enumerate(response.frequency.tolist()):
            values = [getattr(response, each)[index].item() for each in QUANTITIES]
            cells = ["" if not known[index] or not np.isfinite(value) else repr(value) for value in values]
            writer.writerow([repr(frequency), direction, *cells])
    return text.getvalue()


def _head(case: Case, name: str) -> list[str]:
    """Comments: case, model, sweep, versions."""
    fidelity, sweep = case.fidelities[name], case.sweep
    made = provenance()
    settled = f"direction {sweep.direction}, settle {sweep.settle}, hold {sweep.hold} periods, output {sweep.output}"
    title = " ".join(case.title.split())
    return [
        RECORDED,
        f"case {case.path.name}, {title}; key {case.key}",
        f"fidelity {name}: reduction {fidelity.reduction}, solver {fidelity.solver}; key {case.own[name]}",
        f"sweep: {settled}",
        "; ".join(f"{what} {value}" for what, value in made.items()),
        "SI units (a nondimensional model: its own); period: least n <= 16, 0 none, -1 no impact",
    ]
