"""Maps over a plane: the class of the motion, or a quantity, with exact boundaries laid over."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize, TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from vibeam.figures.motion_classes import classes, draw_classes, edges, key
from vibeam.figures.page import PAGE, plain
from vibeam.report.maps.axes import Panel, ShownAxis, cells, panels, quantity_label, shown_axis
from vibeam.report.maps.boundaries import boundaries_of
from vibeam.report.stability import LOOKS
from vibeam.studies.stability.rows import NAMES

if TYPE_CHECKING:
    from vibeam.maps.run import MapResult

Handles = list[Any]

HALO = withStroke(linewidth=2.2, foreground="white", alpha=0.8)  # a boundary is seen over cells of its colour too


def size_of(result: MapResult) -> tuple[float, float]:
    """Size of the figure in inches: a row for each fidelity and way, a column for each panel."""
    shown = list(panels(result))
    columns, rows = max(each.column for each in shown) + 1, max(each.row for each in shown) + 1
    width = 5.8 if columns == 1 else 2.7 * columns + 0.8
    return width, max(3.6, 2.2 * rows + 1.3)


def period(figure: Figure, result: MapResult, exact: bool) -> tuple[Handles, list[str]]:
    """Draw the class of the motion; ``exact``: with boundaries. Returns legend and notes."""
    seen: set[int] = set()

    def draw(axes: Axes, panel: Panel, across: NDArray[Any], upward: NDArray[Any]) -> None:
        response = result[panel.fidelity]
        found = cells(classes(*(panel.of(response, name) for name in ("period", "rest", "ended"))))
        seen.update(np.unique(found).tolist())
        draw_classes(axes, across, upward, found)

    drawn, notes = _plane(figure, result, draw, exact)
    marks = [Line2D([], [], **key(each)) for each in sorted(seen)]
    return [*marks, *drawn], notes


def values(figure: Figure, result: MapResult, exact: bool) -> tuple[Handles, list[str]]:
    """Draw a quantity, all panels on one scale; as ``period``."""
    quantity = result.plan.quantity
    every = np.concatenate([each.values[quantity].ravel() for each in result.responses.values()])
    known = every[np.isfinite(every)]
    low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)
    signed = quantity == "lyapunov" and low < 0 < high
    norm = TwoSlopeNorm(0.0, low, high) if signed else Normalize(low, high)
    meshes: list[Any] = []

    def draw(axes: Axes, panel: Panel, across: NDArray[Any], upward: NDArray[Any]) -> None:
        shown = cells(panel.of(result[panel.fidelity], quantity)).astype(float)
        meshes.append(
            axes.pcolormesh(
                edges(across), edges(upward), shown, cmap="RdBu_r" if signed else "viridis", norm=norm, rasterized=True
            )
        )

    drawn, notes = _plane(figure, result, draw, exact)
    bar = figure.colorbar(meshes[0], ax=figure.axes, shrink=0.9)
    bar.set_label(quantity_label(result, quantity))
    return drawn, notes


def _plane(
    figure: Figure, result: MapResult, draw: Callable[[Axes, Panel, Any, Any], None], exact: bool
) -> tuple[Handles, list[str]]:
    """Draw every panel, its axes and, where asked for, the boundaries."""
    plan, shown = result.plan, list(panels(result))
    columns, rows = max(each.column for each in shown) + 1, max(each.row for each in shown) + 1
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    across = shown_axis(result.case, plan.axes[-1])
    upward = shown_axis(result.case, plan.axes[-2]) if len(plan.axes) > 1 else None
    lines: dict[Any, Line2D] = {}
    notes: dict[str, None] = {}
    for panel in shown:
        axes, response = grid[panel.row, panel.column], result[panel.fidelity]
        x = response.axes[across.key] * across.factor
        y = np.zeros(1) if upward is None else response.axes[upward.key] * upward.factor
        draw(axes, panel, x, y)
        axes.set_xlim(edges(x)[[0, -1]].min(), edges(x)[[0, -1]].max())
        if panel.row == 0 and panel.title:
            axes.set_title(plain(panel.title))
        if upward is not None and exact:
            _overlay(axes, result, panel, across, upward, lines, notes)
        if upward is None:
            axes.set_yticks([])
    for row in range(rows):
        side = next(each.side for each in shown if each.row == row)
        grid[row, 0].set_ylabel(plain(side) if rows > 1 else "")
    for axes in grid[-1]:
        axes.set_xlabel(across.label)
    if upward is not None:
        figure.supylabel(upward.label, fontsize=PAGE["font.size"])
    return list(lines.values()), list(notes)


def _overlay(
    axes: Axes, result: MapResult, panel: Panel, across: ShownAxis, upward: ShownAxis, lines: dict[Any, Line2D],
    notes: dict[str, None],
) -> None:  # fmt: skip
    """Lay the exact boundaries over a panel."""
    found, why = boundaries_of(result.case, panel.fidelity, result.plan.axes, panel.outer)
    limits = axes.get_xlim(), axes.get_ylim()
    for each in found:
        axes.plot(
            each.across * across.factor, each.upward * upward.factor, linewidth=1.0, path_effects=[HALO],
            **LOOKS[each.kind],
        )  # fmt: skip
        lines.setdefault(
            each.kind, Line2D([], [], linewidth=1.0, label=f"exact: {NAMES[each.kind]}", **LOOKS[each.kind])
        )
    axes.set_xlim(limits[0])
    axes.set_ylim(limits[1])
    if why:
        notes.setdefault(why)
