"""Basins: which motion a start leads to; or, of random starts, how many motions are found, or their shares."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from vibeam.figures.page import plain
from vibeam.figures.style import COLOURS, name_of
from vibeam.maps.axes import edges
from vibeam.maps.motions import Labelled, counted, label
from vibeam.maps.run import MapResult
from vibeam.report.maps.labels import shown_axis
from vibeam.report.maps.plane import shade
from vibeam.system.number_text import percent

MOST = 10  # motions with a colour of their own
SHADES = (*COLOURS[:5], "#56B4E9", "#F0E442", "#8C564B", "#BCBD22", "#17BECF")
FAILED, OTHER = "#333333", "#BBBBBB"


def size_of(result: MapResult) -> tuple[float, float]:
    """Panels beside each other, one a fidelity."""
    count = len(result.responses)
    return (5.8, 4.8) if count == 1 else (3.4 * count + 0.6, 4.6)


def basins(figure: Figure, result: MapResult, exact: bool) -> tuple[list[Any], list[str]]:
    """Draw one panel a fidelity; legend and notes."""
    plan, count = result.plan, len(result.responses)
    grid = figure.subplots(1, count, sharex=True, sharey=True, squeeze=False)[0]
    names: dict[str, str] = {}
    across = shown_axis(result.case, plan.axes[-1])
    handles: list[Any] = []
    for axes, (fidelity, response) in zip(grid, result.responses.items(), strict=True):
        found = label(response, 0)
        x = response.axes[across.key] * across.factor
        if plan.starts is None:
            handles = _starts(axes, result, found, x, names)
        elif len(plan.axes) == 1:
            handles = _shares(axes, found, x, names)
        else:
            handles = _numbers(axes, result, found, x)
        axes.set_xlabel(across.label)
        axes.set_title(plain(name_of(result.case, fidelity)))
    if plan.starts is not None and len(plan.axes) == 1:
        grid[0].set_ylabel(f"share of {plan.starts} random starts")
    elif len(plan.axes) > 1:
        grid[0].set_ylabel(shown_axis(result.case, plan.axes[-2]).label)
    return handles, []


def _colours(found: Labelled, names: dict[str, str]) -> list[str]:
    """Colours of the motions, one a name in all panels."""
    for motion in found.motions:
        if motion.name not in names:
            names[motion.name] = SHADES[len(names)] if len(names) < MOST else OTHER
    return [names[motion.name] for motion in found.motions]


def _legend(names: dict[str, str], found: Labelled) -> list[Any]:
    shares = {motion.name: motion.share for motion in found.motions}
    known = {name: colour for name, colour in names.items() if colour != OTHER}
    patches = [
        Patch(facecolor=colour, label=f"{name} ({percent(shares[name])})" if name in shares else name)
        for name, colour in known.items()
    ]
    rest = len(names) - len(known)
    return patches + ([Patch(facecolor=OTHER, label=f"{rest} more motions")] if rest else [])


def _starts(axes: Axes, result: MapResult, found: Labelled, x: Any, names: dict[str, str]) -> list[Any]:
    """Draw the basins over the plane of starts, or along one axis."""
    shades = [FAILED, *_colours(found, names)]
    which = found.which if found.which.ndim == 2 else found.which[None, :]
    y = _upward(result) if len(result.plan.axes) > 1 else np.zeros(1)
    shade(axes, x, y, which + 1, shades)
    if len(y) == 1:
        axes.set_yticks([])
    failed = [Patch(facecolor=FAILED, label="starts beyond the stop, or failed")] if np.any(which < 0) else []
    return [*_legend(names, found), *failed]


def _upward(result: MapResult) -> Any:
    """Values of the axis upward as they are shown."""
    upward = shown_axis(result.case, result.plan.axes[-2])
    return next(iter(result.responses.values())).axes[upward.key] * upward.factor


def _shares(axes: Axes, found: Labelled, x: Any, names: dict[str, str]) -> list[Any]:
    """Draw the shares of the motions along one axis, one on the other."""
    colours = _colours(found, names)
    shares = [np.mean(found.which == each, axis=-1) for each in range(len(colours))]
    if shares:
        axes.stackplot(x, shares, colors=colours, step="mid", linewidth=0)
    if len(x) > 1:
        axes.set_xlim(x.min(), x.max())
    axes.set_ylim(0, 1)
    return _legend(names, found)


def _numbers(axes: Axes, result: MapResult, found: Labelled, x: Any) -> list[Any]:
    """Draw how many motions are found over a plane."""
    y, number = _upward(result), counted(found)
    most = max(int(number.max()), 1)
    shades = ["#FFFFFF", *SHADES[:most]] if most <= MOST else None
    cmap = ListedColormap(shades) if shades else "viridis"
    axes.pcolormesh(edges(x), edges(y), number, cmap=cmap, vmin=-0.5, vmax=most + 0.5, rasterized=True)
    if not shades:
        return []
    return [
        Patch(facecolor=shades[each], edgecolor="0.6", label="1 motion" if each == 1 else f"{each} motions")
        for each in np.unique(number)
    ]
