"""Stability maps: their sheet, and their figure with types of motion by shade, boundaries by colour."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from vibeam.figures.page import legend, plain, titled
from vibeam.figures.panels import say
from vibeam.figures.style import name_of
from vibeam.figures.units import METRIC, DisplayUnits, units_of
from vibeam.periodic.contours import BoundaryCurve
from vibeam.periodic.orbit_map import OrbitMap
from vibeam.report.output import StudySheet
from vibeam.report.planes import OWN, boundary_keys, draw_boundary, frame, panels, shade, swatch
from vibeam.report.tables import ReportTable, blank
from vibeam.studies.stability.axes import StabilityAxis
from vibeam.studies.stability.rows import Crossing
from vibeam.studies.stability.study import ModelMap, Stability
from vibeam.system.number_text import shown_unit

SHADES = {
    "no such motion": "white",
    "through the stop between impacts": "#EDEDED",
    "unstable": "#F6D9B8",
    "stable": "#B9DCF2",
}

AVERAGED: dict[str, Any] = {"color": "#0072B2", "linestyle": (0, (6, 1.5, 1, 1.5)), "linewidth": 0.9}


def sheet(found: Stability) -> StudySheet:
    """Sheet of the maps: the boundaries along the case's own frequencies, the points of all boundaries as CSV."""
    units = units_of(found.case, speed=max((each.velocity for each in found.crossings), default=0.0))
    return StudySheet(
        "",
        [crossings(found.crossings, found.axis.text(found.maps[0].own), units)],
        notes=found.notes,
        data={"crossings": found.crossings, "maps": found.shares, "remarks": found.notes},
        rows=found.points,
        draw=lambda: stability_figure(found),
    )


def crossings(rows: Sequence[Crossing], own: str, units: DisplayUnits = METRIC) -> ReportTable:
    """Table of the boundaries along the case's own frequency range."""
    table = blank(f"Boundaries at the case's own {own}", "fidelity", "boundary", "motion", "at|", "velocity|", heads=2)
    table.add("multipliers|")
    table.caption = "of motions with one impact a span that keep clear of the stop between; velocity: of the impact"
    for row in rows:
        numbers = (
            f"{row.frequency * units.frequency_factor:.10g} {units.frequency}".strip(),
            units.speeds(row.velocity),
        )
        table.add_row(row.fidelity, row.boundary, row.motion, *numbers, row.multipliers)
    return table


def stability_figure(found: Stability) -> Figure:
    """One panel a model, on the same scales."""
    figure, grid = panels(found.case, len(found.maps), 2.7, 1.0, found.axis.name, _shown(found.axis)[0])
    drawn: set[object] = set()
    for axes, one in zip(grid, found.maps, strict=True):
        drawn |= _panel(axes, found, one)
    shows = f"stability of motions with one impact {_span(found)}"
    titled(figure, found.case.figure, found.case.title, shows)
    legend(figure, _legend(drawn, found))
    return figure


def kinds_of_points(orbits: OrbitMap) -> NDArray[np.int64]:
    """Shade index of each point (rows, columns), by the better of the two motions."""
    exists, admissible, stable = np.isfinite(orbits.velocity), orbits.admissible, orbits.stable
    return np.asarray(exists.any(axis=2).astype(int) + admissible.any(axis=2) + (stable & admissible).any(axis=2))


def _panel(axes: Axes, found: Stability, one: ModelMap) -> set[object]:
    """Draw one model; return the legend entries."""
    units, scale = units_of(found.case), _shown(found.axis)[1]
    across, upward = one.orbits.omega / (2 * np.pi) * units.frequency_factor, one.orbits.values * scale
    kinds = kinds_of_points(one.orbits)
    shade(axes, across, upward, kinds, SHADES.values())
    drawn: set[object] = {name for number, name in enumerate(SHADES) if (kinds == number).any()}
    for number, curve in enumerate(one.orbits.curves):
        drawn |= _curve(axes, curve, number, units.frequency_factor / (2 * np.pi), scale)
    if one.averaged is not None:
        inside = (one.averaged >= one.orbits.values[0]) & (one.averaged <= one.orbits.values[-1])
        drawn |= {"averaged"} if inside.any() else set()
        axes.plot(across, one.averaged * scale, gid="averaged", **AVERAGED)
    frame(axes, across, upward, one.own * scale)
    if not kinds.any():
        say(axes, f"no motion with one impact {_span(found)} anywhere in this range")
    names = ", ".join(name_of(found.case, name) for name in one.fidelities)
    axes.set_title(plain(f"{names} ({one.modes} mode{'s' * (one.modes > 1)})"))
    return drawn


def _curve(axes: Axes, curve: BoundaryCurve, number: int, across: float, scale: float) -> set[object]:
    """Parts of a boundary with an admissible motion."""
    drawn: set[object] = set()
    for part in np.split(np.arange(len(curve)), np.flatnonzero(np.diff(curve.clear)) + 1):
        if curve.clear[part[0]]:
            drawn.add(curve.kind)
            name = f"{curve.kind.name.lower()}-{number}-{part[0]}"
            draw_boundary(axes, curve.kind, curve.omega[part] * across, curve.value[part] * scale, gid=name)
    return drawn


def _shown(axis: StabilityAxis) -> tuple[str, float]:
    """Displayed unit, and the factor from the SI unit of the map to it."""
    return shown_unit(axis.unit, max(abs(axis.low), abs(axis.high)))


def _span(found: Stability) -> str:
    periods = found.maps[0].orbits.periods
    return "a drive period" if periods == 1 else f"in {periods} drive periods"


def _legend(drawn: set[object], found: Stability) -> list[Artist]:
    patches = [swatch(colour, name) for name, colour in SHADES.items() if name in drawn]
    averaged = [Line2D([], [], label="averaging: Δ_MAX", **AVERAGED)] if "averaged" in drawn else []
    values, own = found.maps[0].orbits.values, found.maps[0].own
    outside = "" if values[0] <= own <= values[-1] else f", outside: {found.axis.text(own)}"
    return [*patches, *boundary_keys(drawn), *averaged, Line2D([], [], label=f"the case's own{outside}", **OWN)]
