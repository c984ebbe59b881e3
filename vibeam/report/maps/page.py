"""Picture of a map: its page, title and legend."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from vibeam.figures.page import blank_page, legend, titled, write_page
from vibeam.report.maps.axes import quantity_label
from vibeam_models.registry import loaded

if TYPE_CHECKING:
    from vibeam.maps.run import MapResult

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
    legend(figure, handles, [str(each.get_label()) for each in handles])
    return figure


def _caption(result: MapResult) -> str:
    shows = CAPTIONS.get(result.plan.picture) or quantity_label(result, result.plan.quantity)
    if result.done < result.points:
        return f"{shows}: {result.done} of {result.points} points"
    return shows
