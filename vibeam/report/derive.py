"""Derived SDOF parameters as a sheet: the one degree of freedom in a sentence, and its rows beside finite elements."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from math import isfinite
from typing import TYPE_CHECKING

from vibeam.case.held import held_of
from vibeam.report.measured import case_pictures
from vibeam.report.output import StudySheet, plain
from vibeam.report.tables import ReportTable, blank, shown
from vibeam.system.number_text import percent, signed, with_unit, without_round_off

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.studies.contact_time import ContactAtSpeed
    from vibeam.studies.derive import DerivedParameter, DerivedTable


def sheet(table: DerivedTable, case: Case) -> StudySheet:
    """Sheet of the parameters derived for ``case``; as CSV a row a parameter."""
    return StudySheet(
        answer=answer(table, case),
        tables=[derivation(table)] * bool(table.rows) + [contact_table(table.contacts)] * bool(table.contacts),
        notes=table.notes,
        details=list(_assumptions(table)),
        data={"rows": table.rows, "notes": table.notes, "contacts": table.contacts},
        rows=[plain(row) for row in table],
        pictures=case_pictures(case),
    )


def answer(table: DerivedTable, case: Case) -> str:
    """Sentence with stiffness, mass, frequency and damping, each with most of what the model takes into account."""
    last = {row.symbol: row for row in table if not row.name.startswith("error of")}
    said = [f"{name} = {with_unit(last[symbol].value, last[symbol].unit)}" for name, symbol in NAMES if symbol in last]
    if "f_n" in last:
        row = last["f_n"]
        said.append(f"f = {with_unit(row.value, 'Hz')} ({_beside(row)})")
        if "β_S" in last:  # with the mode's own D = 2 ζ/ω
            said.append(f"ζ = {percent(last['β_S'].reference * row.value / row.reference)}")
    held = held_of(case.scene)
    struck = held.label if held.coefficient is not None else f"the {held.label}"
    return f"One degree of freedom: {', '.join(said) or 'none, the beam is free'}, with {struck}."


NAMES = (("k", "K_S"), ("m", "M_S"))


def _beside(row: DerivedParameter) -> str:
    error = without_round_off(row.error, 1.0)
    side = "below" if error < 0 else "above"
    return f"{percent(abs(error))} {side} the finite-element value" if error else "the finite-element value"


def derivation(rows: Iterable[DerivedParameter]) -> ReportTable:
    """Table of SDOF parameters from geometry, each beside its finite-element value."""
    table = blank("SDOF parameters", "parameter", "symbol", "by formula|", "by FE|", "unit", "error|")
    last = ""
    for row in rows:
        name, _, kept = row.name.partition(", ")
        if row.unit == "rad/s":
            continue
        same, last = name == last and bool(kept), name
        unit, error = "" if row.unit == "1" else row.unit, signed(row.error)
        values = f"{row.value:.5g}", "" if same else f"{row.reference:.5g}"
        table.add_row(
            f"  {kept}" if same else row.name, "" if same else row.symbol, *values, "" if same else unit, error
        )
    table.caption = "ω_n = 2π f_n, in CSV and JSON; -v: the assumption behind each error"
    return table


def contact_table(contacts: Sequence[ContactAtSpeed]) -> ReportTable:
    """Table of contacts with a stop that yields, a row a speed."""
    heads = ["speed|", "modes|", "1/S|", "contact time|", "indentation|", "force|", "R|"]
    units = {"speed": "m/s", "modes": "", "mass": "kg", "duration": "s", "depth": "m", "force": "N", "restitution": ""}
    if any(isfinite(each.pressure) for each in contacts):
        heads, units = [*heads, "pressure|"], units | {"pressure": "Pa"}
    table = blank("Contact with the stop", *heads)
    for row in contacts:
        table.add_row(*(shown(getattr(row, name), unit) for name, unit in units.items()))
    table.caption = "modes: those below 3/2t_c; a free mass 1/S, S their contact mobility, meets the stop"
    return table


def _assumptions(rows: Iterable[DerivedParameter]) -> Iterator[str]:
    """Cause of the difference from finite elements, with the parameters that it changes."""
    causes: dict[str, list[str]] = {}
    for row in rows:
        causes.setdefault(row.assumption, []).append(row.name)
    for cause, names in causes.items():
        yield f"Error by {cause}: {'; '.join(names)}."
