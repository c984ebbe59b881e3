"""Picture and tables of a map: the page with title and legend, shares of the classes of motion, coexisting motions."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from vibeam.figures.page import blank_page, legend, titled, write_page
from vibeam.figures.units import DisplayUnits
from vibeam.report.maps.axes import quantity_label
from vibeam.report.tables import blank
from vibeam.system.number_text import percent
from vibeam_models.registry import loaded

if TYPE_CHECKING:
    from vibeam.maps.motions import CoexistingMotion
    from vibeam.maps.result import MapRow
    from vibeam.maps.run import MapResult
    from vibeam.report.tables import ReportTable

CAPTIONS = {
    "period": "period of the motion",
    "bifurcation": "bifurcation diagram: output at the end of each drive period",
    "basins": "coexisting motions",
    "spectra": "spectra along one axis",
}

HOMES = {
    "period": ("plane", "period"),
    "values": ("plane", "values"),
    "bifurcation": ("bifurcation", "bifurcation"),
    "basins": ("basins", "basins"),
    "spectra": ("spectra", "spectra"),
}


def write_map(result: MapResult, *paths: Path, exact: bool = True) -> list[str]:
    """Draw a map to ``paths``, by their endings; ``exact``: with what is known in closed form. Returns notes on it."""
    notes: list[str] = []
    write_page(lambda: _figure(result, exact and result.plan.boundaries, notes), paths)
    return notes


def map_figure(result: MapResult) -> Figure:
    """The figure of a map."""
    return _figure(result, result.plan.boundaries, [])


def _figure(result: MapResult, exact: bool, notes: list[str]) -> Figure:
    home, name = HOMES[result.plan.picture]
    module = loaded(f"vibeam.report.maps.{home}")
    figure = blank_page(module.size_of(result), result.case.figure)
    handles, said = getattr(module, name)(figure, result, exact)
    notes += said
    caption = "\n".join([_caption(result), *(said if result.plan.picture == "spectra" else ())])
    titled(figure, result.case.figure, result.case.title, caption)
    legend(figure, handles)
    return figure


def _caption(result: MapResult) -> str:
    shows = CAPTIONS.get(result.plan.picture) or quantity_label(result, result.plan.quantity)
    if result.done < result.points:
        return f"{shows}: {result.done} of {result.points} points"
    return shows


def shares(rows: Sequence[MapRow]) -> ReportTable:
    """Table of the shares of each class of motion."""
    table = blank("Maps", "map", "fidelity", "direction", "at", "points|")
    table.add("no impact|", "period 1|", "period 2|", "period 3 … 16|", "not periodic|", "failed|")
    for row in rows:
        found = (row.no_impact, row.period_1, row.period_2, row.period_more, row.not_periodic, row.failed)
        table.add_row(row.map, row.fidelity, row.direction, row.at, str(row.points), *map(percent, found))
    return table


def motions(found: Sequence[CoexistingMotion], units: DisplayUnits) -> ReportTable:
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
