"""Page and sheet of a map, whatever its picture: title, caption and legend; answer, tables and rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from vibeam.figures.page import blank_page, legend, titled, write_page
from vibeam.maps.result import MapResult
from vibeam.report.maps.labels import quantity_label
from vibeam.report.output import StudySheet
from vibeam_models.registry import loaded

CAPTIONS = {
    "period": "period of the motion",
    "bifurcation": "bifurcation diagram: output at the end of each drive period",
    "basins": "coexisting motions",
}
IN_PLANE = ("period", "values")  # pictures that ``plane`` draws; each other has a module of its name


def still(result: MapResult, exact: bool) -> Any:
    """A stored map as its picture takes it, nothing flown for it; ``exact``: with closed forms, which take seconds."""
    plan = replace(result.plan, boundaries=exact and result.plan.boundaries)
    return study_of(replace(result, plan=plan))


def study_of(result: MapResult) -> Any:
    """A finished map as its picture takes it: itself where motions are shown, else the study of them."""
    if result.plan.picture == "verdict":
        from vibeam.studies.fidelity_map.study import fidelity_map_of

        return fidelity_map_of(result)
    if result.plan.picture == "stability":
        from vibeam.studies.stability import stability_of

        return stability_of(result)
    return result


def write_map(found: Any, *paths: Path) -> list[str]:
    """Draw a map, ``found`` as of ``study_of``, to ``paths``, by their endings. Returns notes on it."""
    notes: list[str] = []
    write_page(lambda: _figure(found, found.plan.boundaries, notes), paths)
    return notes


def map_figure(found: Any, exact: bool = True) -> Figure:
    """The figure of a finished map, or of a study of one; ``exact``: with closed forms, which may take seconds."""
    shown = still(found, exact) if isinstance(found, MapResult) else found
    return _figure(shown, exact and shown.plan.boundaries, [])


def _figure(found: Any, exact: bool, notes: list[str]) -> Figure:
    picture = found.plan.picture
    module = _module("plane" if picture in IN_PLANE else picture)
    figure = blank_page(module.size_of(found), found.case.figure)
    handles, said = getattr(module, picture)(figure, found, exact)
    notes += said
    shown = _caption(found) if isinstance(found, MapResult) else module.caption(found)
    titled(figure, found.case.figure, found.case.title, shown)
    legend(figure, handles)
    return figure


def _module(name: str) -> Any:
    return loaded(f"vibeam.report.maps.{name}")


def _caption(found: MapResult) -> str:
    return CAPTIONS.get(found.plan.picture) or quantity_label(found, found.plan.quantity)


def sheet_of(found: Any, notes: Sequence[str] = ()) -> StudySheet:
    """Sheet of a map as ``study_of`` has it; ``notes`` on its picture."""
    if isinstance(found, MapResult):
        return _module("swept").sheet(found, notes)  # type: ignore[no-any-return]
    return _module(found.plan.picture).sheet(found)  # type: ignore[no-any-return]
