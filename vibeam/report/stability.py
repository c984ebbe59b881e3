"""Stability map as a figure: types of motion by shade, boundaries by colour."""

from __future__ import annotations

from math import ceil
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from vibeam.figures.page import PAGE, blank_page, legend, plain, titled, write_page
from vibeam.figures.panels import say
from vibeam.figures.style import name_of
from vibeam.figures.units import frequency_label, units_of, with_unit
from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.contours import BoundaryCurve
from vibeam.periodic.orbit_map import OrbitMap
from vibeam.studies.stability.axes import Axis
from vibeam.studies.stability.rows import NAMES
from vibeam.studies.stability.study import ModelMap, Stability
from vibeam.system.number_text import shown_unit

SHADES = {
    "no such motion": "white",
    "through the stop between impacts": "#EDEDED",
    "unstable": "#F6D9B8",
    "stable": "#B9DCF2",
}

LOOKS: dict[Kind, dict[str, Any]] = {
    Kind.FOLD: {"color": "black"},
    Kind.GRAZING: {"color": "#009E73"},
    Kind.TOUCHING: {"color": "#7A5C00", "linestyle": (0, (4, 1.5))},
    Kind.DOUBLING: {"color": "#D55E00"},
    Kind.NEIMARK_SACKER: {"color": "#AA4499"},
}

AVERAGED: dict[str, Any] = {"color": "#0072B2", "linestyle": (0, (6, 1.5, 1, 1.5)), "linewidth": 0.9}
OWN: dict[str, Any] = {"color": "0.35", "linestyle": ":", "linewidth": 1.0}


def write_stability(found: Stability, *paths: Path) -> None:
    """Draw and write the maps; the format follows each path's ending (.png, .svg, .pdf)."""
    write_page(lambda: stability_figure(found), paths)


def stability_figure(found: Stability) -> Figure:
    """One panel a model, on the same scales."""
    count = len(found.maps)
    columns = min(count, 3)
    rows = ceil(count / columns)
    figure = blank_page((5.8, 4.2) if count == 1 else (3.4 * columns, 2.7 * rows + 1.0), found.case.figure)
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    drawn: set[object] = set()
    for axes, one in zip(grid.flat, found.maps, strict=False):
        drawn |= _panel(axes, found, one)
    for spare in grid.flat[count:]:
        spare.set_axis_off()
    _label(figure, grid, found)
    handles = _legend(drawn, found)
    legend(figure, handles, [str(handle.get_label()) for handle in handles])
    return figure


def kinds_of_points(orbits: OrbitMap) -> NDArray[np.int64]:
    """Shade index of each point (rows, columns), by the better of the two motions."""
    exists, admissible, stable = np.isfinite(orbits.velocity), orbits.admissible, orbits.stable
    return np.asarray(exists.any(axis=2).astype(int) + admissible.any(axis=2) + (stable & admissible).any(axis=2))


def _panel(axes: Axes, found: Stability, one: ModelMap) -> set[object]:
    """Draw one model; return the legend entries."""
    units, scale = units_of(found.case), _shown(found.axis)[1]
    across = one.orbits.omega / (2 * np.pi) * units.frequency_factor
    shades = ListedColormap(list(SHADES.values()))
    kinds = kinds_of_points(one.orbits)
    axes.pcolormesh(
        across, one.orbits.values * scale, kinds, cmap=shades, vmin=-0.5, vmax=len(SHADES) - 0.5,
        shading="nearest", rasterized=True,
    )  # fmt: skip
    drawn: set[object] = {name for number, name in enumerate(SHADES) if (kinds == number).any()}
    for number, curve in enumerate(one.orbits.curves):
        drawn |= _curve(axes, curve, number, units.frequency_factor / (2 * np.pi), scale)
    if one.averaged is not None:
        inside = (one.averaged >= one.orbits.values[0]) & (one.averaged <= one.orbits.values[-1])
        drawn |= {"averaged"} if inside.any() else set()
        axes.plot(across, one.averaged * scale, gid="averaged", **AVERAGED)
    axes.axhline(one.own * scale, gid="own", **OWN)
    axes.set_xlim(across[0], across[-1])
    axes.set_ylim(one.orbits.values[0] * scale, one.orbits.values[-1] * scale)
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
            place = curve.omega[part] * across, curve.value[part] * scale
            axes.plot(*place, gid=name, linewidth=1.1, **LOOKS[curve.kind])
    return drawn


def _shown(axis: Axis) -> tuple[str, float]:
    """Displayed unit, and the factor from the SI unit of the map to it."""
    return shown_unit(axis.unit, max(abs(axis.low), abs(axis.high)))


def _span(found: Stability) -> str:
    periods = found.maps[0].orbits.periods
    return "a drive period" if periods == 1 else f"in {periods} drive periods"


def _label(figure: Figure, grid: Any, found: Stability) -> None:
    for axes in [axes for axes in grid.flat if axes.axison][-grid.shape[1] :]:
        axes.set_xlabel(frequency_label(units_of(found.case)))
        axes.tick_params(labelbottom=True)
    figure.supylabel(with_unit(found.axis.name, _shown(found.axis)[0]), fontsize=PAGE["font.size"])
    shows = f"stability of motions with one impact {_span(found)}"
    titled(figure, found.case.figure, found.case.title, shows)


def _legend(drawn: set[object], found: Stability) -> list[Artist]:
    patches: list[Artist] = [
        Patch(facecolor=colour, edgecolor="0.6", linewidth=0.5, label=name)
        for name, colour in SHADES.items()
        if name in drawn
    ]
    lines = [Line2D([], [], label=NAMES[kind], linewidth=1.1, **look) for kind, look in LOOKS.items() if kind in drawn]
    averaged = [Line2D([], [], label="averaging: Δ_MAX", **AVERAGED)] if "averaged" in drawn else []
    values, own = found.maps[0].orbits.values, found.maps[0].own
    outside = "" if values[0] <= own <= values[-1] else f", outside: {found.axis.text(own)}"
    return [*patches, *lines, *averaged, Line2D([], [], label=f"the case's own{outside}", **OWN)]
