"""Swept maps: their sheet, with shares of the classes of motion, and the motions that coexist."""

from __future__ import annotations

from collections.abc import Sequence

from vibeam.figures.units import DisplayUnits, units_of
from vibeam.maps.axes import name_of_key
from vibeam.maps.motions import CoexistingMotion, motions_of
from vibeam.maps.result import MapResult, MapRow, rows_of
from vibeam.report.output import StudySheet
from vibeam.report.tables import ReportTable, blank
from vibeam.runs.comparison.differences import listed
from vibeam.system.number_text import percent

CLASSES = {
    "period_1": "repeat every drive period", "period_2": "every second one", "period_more": "after up to 16",
    "not_periodic": "do not repeat", "no_impact": "have no impact", "failed": "failed",
}  # fmt: skip


def sheet(found: MapResult, notes: Sequence[str]) -> StudySheet:
    """Sheet of a map; ``notes`` on its picture."""
    rows = list(rows_of(found))
    motions = motions_of(found) if found.plan.picture == "basins" else []
    units = units_of(found.case, length=max((each.amplitude for each in motions), default=0.0))
    return StudySheet(
        _answer(found, rows, motions),
        [_shares(found.plan.name, rows), *([_coexisting(motions, units)] if motions else [])],
        notes,
        data={"rows": rows, "motions": motions},
    )


def _answer(found: MapResult, rows: Sequence[MapRow], motions: Sequence[CoexistingMotion]) -> str:
    """Shares of the classes of motion of all points, or how many motions coexist."""
    over = listed([name_of_key(found.case, axis.key) for axis in found.plan.axes])
    head, rest = f"{found.plan.name}: of {found.points} motions over {over}", "all else is as in the case"
    if motions:
        commonest = motions[0]
        kinds = f"{len(motions)} kinds, the commonest {commonest.name}, {percent(commonest.share)} of the starts"
        return f"{head} there are {kinds}; {rest}."
    total = sum(row.points for row in rows)
    shares = {name: sum(getattr(row, name) * row.points for row in rows) / total for name in CLASSES}
    said = [f"{percent(share)} {CLASSES[name]}" for name, share in shares.items() if share > 0]
    return f"{head} {listed(said)}; {rest}."


def _shares(name: str, rows: Sequence[MapRow]) -> ReportTable:
    """Table of the shares of each class of motion."""
    table = blank(f"Motions of map {name}", "fidelity", "direction", "at", "points|")
    table.add("no impact|", "period 1|", "period 2|", "period 3 … 16|", "not periodic|", "failed|")
    for row in rows:
        found = (row.no_impact, row.period_1, row.period_2, row.period_more, row.not_periodic, row.failed)
        table.add_row(row.fidelity, row.direction, row.at, str(row.points), *map(percent, found))
    return table


def _coexisting(found: Sequence[CoexistingMotion], units: DisplayUnits) -> ReportTable:
    """Table of the motions that starts lead to, the commonest of each fidelity first."""
    unit = f" ({units.length})" if units.length else ""
    table = blank(
        "Coexisting motions", "fidelity", "motion", "period|", "impacts|", f"amplitude{unit}|", "starts|", "share|"
    )
    for each in found:
        size = f"{each.amplitude * units.length_factor:.4g}"
        period = {0: "none", -1: "–"}.get(each.period, str(each.period))
        table.add_row(each.fidelity, each.name, period, str(each.impacts), size, str(each.starts), percent(each.share))
    return table
