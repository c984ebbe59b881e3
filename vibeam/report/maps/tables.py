"""Table of a map in the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from vibeam.figures.units import DisplayUnits
from vibeam.report.tables import blank
from vibeam.system.number_text import percent

if TYPE_CHECKING:
    from vibeam.maps.motions import Motion
    from vibeam.maps.result import MapRow
    from vibeam.report.table_widths import ReportTable


def shares(rows: Sequence[MapRow]) -> ReportTable:
    """Table of the shares of each class of motion."""
    table = blank("Maps", "map", "fidelity", "direction", "at", "points|")
    table.add("no impact|", "period 1|", "period 2|", "period 3 … 16|", "not periodic|", "failed|")
    for row in rows:
        found = (row.no_impact, row.period_1, row.period_2, row.period_more, row.not_periodic, row.failed)
        table.add_row(row.map, row.fidelity, row.direction, row.at, str(row.points), *map(percent, found))
    return table


def motions(found: Sequence[Motion], units: DisplayUnits) -> ReportTable:
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
