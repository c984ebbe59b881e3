"""Maps over a plane: the class of the motion, or a quantity, with exact boundaries drawn over it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, Normalize, TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from vibeam.case.grid_keys import FREQUENCY, GAP, LEVELS
from vibeam.figures.page import PAGE, plain
from vibeam.figures.style import COLOURS
from vibeam.maps.closed_form import boundaries_over
from vibeam.observe.periodicity import classes
from vibeam.periodic.bifurcation_functions import Kind
from vibeam.report.maps.axes import MapPanel, ShownAxis, cells, edges, panels, quantity_label, shown_axis
from vibeam.report.planes import BOUNDARIES, boundary_keys
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.fidelity import Model
    from vibeam.case.grid_keys import AxisPlan
    from vibeam.maps.run import MapResult
    from vibeam.system.impact_system import ImpactSystem


FEWEST, MOST = 41, 81  # points of the grid along each axis, on which boundaries are looked for


@dataclass(frozen=True)
class DrawnBoundary:
    """Part of a boundary with an admissible motion: values of the last axis and of the one above, SI."""

    kind: Kind
    across: Array
    upward: Array


def boundaries_of(
    case: Case, fidelity: str, axes: Sequence[AxisPlan], outer: Sequence[tuple[str, float]]
) -> tuple[list[DrawnBoundary], str]:
    """Boundaries over the last two of ``axes``, the others as in ``outer``; or why there are none.

    They are known over the drive frequency and either the level of the drive or the gap, on a platform too.
    """
    upward, across = axes[-2:]
    if across.key != FREQUENCY or upward.key not in (GAP, *LEVELS):
        return [], "no exact boundaries: they are known over frequency and drive or gap"
    own = case.model(fidelity).at(dict(outer))
    system = own.system()
    if system.beyond_plain:
        return [], f"no exact boundaries of {fidelity}: no closed form knows {' or '.join(system.beyond_plain)}"
    omega = 2 * np.pi * _grid(across.values)
    if upward.key != GAP:
        return _over_level(own.at({upward.key: 1.0}), system, omega, np.sort(upward.values))
    low, high = (own.at({GAP: value}).system().gap for value in (min(upward.values), max(upward.values)))
    gaps, slope = np.linspace(low, high, len(_grid(upward.values))), np.ptp(upward.values) / (high - low)
    if not np.all(own.amplitude(omega)):
        return [], "no exact boundaries: a drive above 0 is needed"
    found = boundaries_over(system, "gap", omega, gaps, low, lambda at_: np.asarray(own.amplitude(at_)))
    return [
        DrawnBoundary(each.kind, each.frequency, min(upward.values) + slope * (each.value - low)) for each in found
    ], ""


def _over_level(unit: Model, system: ImpactSystem, omega: Array, levels: Array) -> tuple[list[DrawnBoundary], str]:
    """Boundaries over frequency and a level of the drive, ``unit``: the model with a level of 1."""
    known = levels[levels > 0]
    if len(known) < 2 or not np.all(unit.amplitude(omega)):
        return [], "no exact boundaries: a range of drives above 0 is needed"
    rows = np.linspace(known[0], known[-1], len(_grid(levels)))
    found = boundaries_over(system, "amplitude", omega, rows, system.gap, lambda at: np.asarray(unit.amplitude(at)))
    return [DrawnBoundary(each.kind, each.frequency, each.value) for each in found], ""


def _grid(values: Sequence[float] | Array) -> Array:
    """Even grid over the range of an axis, ascending."""
    return np.linspace(min(values), max(values), min(max(len(values), FEWEST), MOST))


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

    def draw(axes: Axes, panel: MapPanel, across: NDArray[Any], upward: NDArray[Any]) -> None:
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

    def draw(axes: Axes, panel: MapPanel, across: NDArray[Any], upward: NDArray[Any]) -> None:
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
    figure: Figure, result: MapResult, draw: Callable[[Axes, MapPanel, Any, Any], None], exact: bool
) -> tuple[Handles, list[str]]:
    """Draw every panel, its axes and, where asked for, the boundaries."""
    plan, shown = result.plan, list(panels(result))
    columns, rows = max(each.column for each in shown) + 1, max(each.row for each in shown) + 1
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    across = shown_axis(result.case, plan.axes[-1])
    upward = shown_axis(result.case, plan.axes[-2]) if len(plan.axes) > 1 else None
    lines: dict[Kind, None] = {}
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
    return [key for kind in lines for key in boundary_keys([kind], 1.0, "exact: ")], list(notes)


def _overlay(
    axes: Axes, result: MapResult, panel: MapPanel, across: ShownAxis, upward: ShownAxis, lines: dict[Kind, None],
    notes: dict[str, None],
) -> None:  # fmt: skip
    """Lay the exact boundaries over a panel."""
    found, why = boundaries_of(result.case, panel.fidelity, result.plan.axes, panel.outer)
    limits = axes.get_xlim(), axes.get_ylim()
    for each in found:
        axes.plot(
            each.across * across.factor, each.upward * upward.factor, linewidth=1.0, path_effects=[HALO],
            **BOUNDARIES[each.kind],
        )  # fmt: skip
        lines.setdefault(each.kind)
    axes.set_xlim(limits[0])
    axes.set_ylim(limits[1])
    if why:
        notes.setdefault(why)


CALLED = ("no impact", "period 1", "period 2", "period 3 … 16", "not periodic", "failed", "not computed yet")
SHADES = ("#D9D9D9", COLOURS[0], COLOURS[1], COLOURS[3], "#FFFFFF", "#333333", "#F7E9C6")


def draw_classes(
    axes: Axes, across: NDArray[np.float64], upward: NDArray[np.float64], found: NDArray[np.int_]
) -> None:  # fmt: skip
    """Draw a cell for each point, ``found`` (upward, across), its colour by its class."""
    axes.pcolormesh(
        edges(across), edges(upward), found, cmap=ListedColormap(SHADES), vmin=-0.5, vmax=len(SHADES) - 0.5,
        rasterized=True,
    )  # fmt: skip


def key(found: int) -> dict[str, Any]:
    """Look of a class in the legend."""
    return {
        "color": SHADES[found], "markeredgecolor": "0.4", "markeredgewidth": 0.5, "linestyle": "", "marker": "s",
        "label": CALLED[found],
    }  # fmt: skip
