"""Planes of drive frequency and a further key as figures: panels on one scale, cells by class, boundaries, legend."""

from __future__ import annotations

from collections.abc import Iterable
from math import ceil
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from vibeam.case.case import Case
from vibeam.figures.page import PAGE, blank_page
from vibeam.figures.units import frequency_label, units_of, with_unit
from vibeam.periodic.bifurcation_functions import Kind
from vibeam.studies.stability.rows import NAMES
from vibeam_models.arrays import Array

BOUNDARIES: dict[Kind, dict[str, Any]] = {
    Kind.FOLD: {"color": "black"},
    Kind.GRAZING: {"color": "#009E73"},
    Kind.TOUCHING: {"color": "#7A5C00", "linestyle": (0, (4, 1.5))},
    Kind.DOUBLING: {"color": "#D55E00"},
    Kind.NEIMARK_SACKER: {"color": "#AA4499"},
}

OWN: dict[str, Any] = {"color": "0.35", "linestyle": ":", "linewidth": 1.0}
COLUMNS = 3  # panels in a row


def panels(case: Case, count: int, high: float, around: float, name: str, unit: str) -> tuple[Figure, list[Axes]]:
    """Figure of ``count`` panels, ``high`` inches each and ``around`` for titles and legend; ``name``: upward."""
    columns = min(count, COLUMNS)
    rows = ceil(count / columns)
    figure = blank_page((3.4 * columns, high * rows + around) if count > 1 else (5.8, 4.2), case.figure)
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).flat
    for spare in grid[count:]:
        spare.set_axis_off()
    for axes in grid[max(count - columns, 0) : count]:
        axes.set_xlabel(frequency_label(units_of(case)))
        axes.tick_params(labelbottom=True)
    figure.supylabel(with_unit(name, unit), fontsize=PAGE["font.size"])
    return figure, list(grid[:count])


def shade(axes: Axes, across: Array, upward: Array, classes: NDArray[np.int64], colours: Iterable[str]) -> None:
    """Draw a cell for each point, ``classes`` (upward, across) of it, in their colours."""
    shades = list(colours)
    axes.pcolormesh(
        across, upward, classes, cmap=ListedColormap(shades), vmin=-0.5, vmax=len(shades) - 0.5, shading="nearest",
        rasterized=True,
    )  # fmt: skip


def frame(axes: Axes, across: Array, upward: Array, own: float) -> None:
    """End the axes with the cells, and mark the case's ``own`` value where it lies between."""
    axes.set_xlim(across[0], across[-1])
    axes.set_ylim(upward[0], upward[-1])
    if upward[0] <= own <= upward[-1]:
        axes.axhline(own, gid="own", **OWN)


def draw_boundary(axes: Axes, kind: Kind, across: Array, upward: Array, **keys: Any) -> None:
    """Draw a piece of a boundary, one of a single point as a dot."""
    alone: dict[str, Any] = {"marker": ".", "markersize": 4.0} if len(across) == 1 else {}
    axes.plot(across, upward, linewidth=1.1, **BOUNDARIES[kind], **alone, **keys)


def swatch(colour: str, label: str) -> Artist:
    """Legend entry of a class."""
    return Patch(facecolor=colour, edgecolor="0.6", linewidth=0.5, label=label)


def boundary_keys(drawn: Iterable[object], wide: float = 1.1, prefix: str = "") -> list[Artist]:
    """Legend entries of the kinds of boundary that are ``drawn``."""
    kinds = set(drawn)
    return [
        Line2D([], [], label=prefix + NAMES[kind], linewidth=wide, **look)
        for kind, look in BOUNDARIES.items()
        if kind in kinds
    ]
