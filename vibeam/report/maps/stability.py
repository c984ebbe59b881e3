"""Stability maps: their sheet, and their picture with types of motion by shade and Δ_MAX of averaging."""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from vibeam.figures.page import plain
from vibeam.figures.panels import say
from vibeam.figures.style import name_of
from vibeam.figures.units import DisplayUnits, units_of
from vibeam.report.maps.labels import shown_axis
from vibeam.report.maps.plane import COLUMNS, Handles, PlanePanel, draw_planes, page_size, place_of, shade, swatch
from vibeam.report.output import StudySheet
from vibeam.report.tables import ReportTable, blank
from vibeam.runs.comparison.differences import listed
from vibeam.studies.stability import ModelMap, Stability
from vibeam.system.number_text import percent
from vibeam_models.arrays import Array

NONE = "no such motion"
SHADES = {
    NONE: "white",
    "through the stop between impacts": "#EDEDED",
    "unstable": "#F6D9B8",
    "stable": "#B9DCF2",
}

AVERAGED: dict[str, Any] = {"color": "#0072B2", "linestyle": (0, (6, 1.5, 1, 1.5)), "linewidth": 0.9}


def sheet(found: Stability) -> StudySheet:
    """Sheet of the maps: the boundaries along the case's own frequencies, the points of all boundaries as CSV."""
    units = units_of(found.case, speed=max((each.velocity for each in found.crossings), default=0.0))
    tables = [_crossings(found, units)] if found.crossings else []
    return StudySheet(
        _answer(found),
        tables,
        notes=found.notes,
        more=[_shares(found)],
        data={"crossings": found.crossings, "shares": found.shares, "remarks": found.notes},
        rows=found.points,
    )


def _answer(found: Stability) -> str:
    """Shares of the plane with stable motions, and numbers of boundaries along the case's own line where known."""
    upward = shown_axis(found.case, found.plan.axes[-2])
    first, *others = [(percent(each.stable), listed(each.fidelity.split())) for each in found.shares]
    plane = f"{first[0]} of the plane of frequency and {upward.name} ({first[1]})"
    shares = listed([plane, *(f"{share} ({name})" for share, name in others)])
    one = f"Stable motions {contacts(found)} exist on {shares}"
    counts = {
        one.name: sum(each.fidelity in one.fidelities for each in found.crossings) for one in found.maps if not one.shot
    }
    if not counts:
        return f"{one}."
    line = f"along the case's own {upward.text(found.own)}" if isfinite(found.own) else "with the rig as it is"
    if not any(counts.values()):
        return f"{one}; {line} there is no boundary."
    met = listed([f"{count} ({listed(name.split())})" for name, count in counts.items()])
    return f"{one}; {line} the numbers of boundaries are {met}."


def contacts(found: Stability) -> str:
    """Impacts of the motions of a map in words: of models that are shot at, any number of contacts."""
    shot = {one.shot for one in found.maps}
    if shot == {True}:
        return f"with contacts {'every drive period' if found.plan.periods == 1 else span(found)}"
    return f"with one impact {span(found)}" + " (of some models: with contacts)" * any(shot)


def span(found: Stability) -> str:
    """Drive periods from impact to impact, in words."""
    periods = found.plan.periods
    return "a drive period" if periods == 1 else f"in {periods} drive periods"


def _crossings(found: Stability, units: DisplayUnits) -> ReportTable:
    """Table of the boundaries along the case's own frequency range."""
    table = blank("Boundaries along the case's own line", "fidelity", "boundary", "motion", "at|", "velocity|", heads=2)
    table.add("multipliers|")
    table.caption = f"of motions {contacts(found)} that keep clear of the stop between; velocity: of the hardest impact"
    for row in found.crossings:
        place = f"{row.frequency * units.frequency_factor:.6g} {units.frequency}".strip()
        table.add_row(row.fidelity, row.boundary, row.motion, place, units.speeds(row.velocity), row.multipliers)
    return table


def _shares(found: Stability) -> ReportTable:
    """Table of the shares of the map with each type of motion."""
    table = blank(f"Motions {contacts(found)}", "fidelity", "exist|", "clear|", "stable|")
    for each in found.shares:
        table.add_row(each.fidelity, *map(percent, (each.exists, each.admissible, each.stable)))
    return table


def caption(found: Stability) -> str:
    """Caption of the picture."""
    return f"stability of motions {contacts(found)}"


def size_of(found: Stability) -> tuple[float, float]:
    """A panel for each model."""
    count = len(found.maps)
    return page_size(place_of(count - 1)[0] + 1, min(count, COLUMNS), 2.0)


def kinds_of_points(one: ModelMap) -> NDArray[np.int64]:
    """Shade index of each point (rows, columns), by the better of the two motions."""
    exists, admissible, stable = np.isfinite(one.velocity), one.admissible, one.stable
    return np.asarray(exists.any(axis=0).astype(int) + admissible.any(axis=0) + (stable & admissible).any(axis=0))


def stability(figure: Figure, found: Stability, exact: bool) -> tuple[Handles, list[str]]:
    """Draw a panel for each model; legend and notes."""
    scale, seen, averaged = shown_axis(found.case, found.plan.axes[-2]).factor, set[int](), list[bool]()

    def panel(number: int, one: ModelMap) -> PlanePanel:
        kinds = kinds_of_points(one)
        seen.update(np.unique(kinds).tolist())

        def draw(axes: Axes, x: Array, y: Array) -> None:
            shade(axes, x, y, kinds, SHADES.values())
            if one.averaged is not None:
                values = one.averaged * scale
                averaged.append(bool(np.any((values >= y[0]) & (values <= y[-1]))))
                axes.plot(x, values, gid="averaged", **AVERAGED)
            if not kinds.any():
                say(axes, f"no motion {contacts(found)} anywhere in this range")

        names = ", ".join(name_of(found.case, name) for name in one.fidelities)
        title = f"{names} ({one.modes} mode{'s' * (one.modes > 1)})"
        return PlanePanel(*place_of(number), plain(title), draw, one.boundaries if exact else ())

    lines = draw_planes(figure, found.result, [panel(number, one) for number, one in enumerate(found.maps)])
    names = ["no such motion, or none found" if any(one.shot for one in found.maps) else NONE, *list(SHADES)[1:]]
    shades = enumerate(zip(names, SHADES.values(), strict=True))
    patches = [swatch(colour, name) for number, (name, colour) in shades if number in seen]
    beside = [Line2D([], [], label="averaging: Δ_MAX", **AVERAGED)] if any(averaged) else []
    return [*patches, *beside, *lines], []
