"""Planes of two keys: panels on one scale, cells by class or quantity, exact boundaries and the case's own line."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, Normalize, TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from vibeam.figures.page import PAGE, plain
from vibeam.figures.style import COLOURS, name_of
from vibeam.maps.axes import cells, edges, own_value
from vibeam.maps.boundaries import KINDS, PlaneBoundary, boundaries_of
from vibeam.maps.evaluate import GridResponse
from vibeam.maps.result import MapResult
from vibeam.observe.periodicity import classes
from vibeam.periodic.bifurcation_functions import Kind
from vibeam.report.maps.labels import ShownAxis, quantity_label, shown_axis
from vibeam_models.arrays import Array

BOUNDARIES: dict[Kind, dict[str, Any]] = {
    Kind.FOLD: {"color": "black"},
    Kind.GRAZING: {"color": "#009E73"},
    Kind.TOUCHING: {"color": "#7A5C00", "linestyle": (0, (4, 1.5))},
    Kind.DOUBLING: {"color": "#D55E00"},
    Kind.NEIMARK_SACKER: {"color": "#AA4499"},
}
HALO = withStroke(linewidth=2.2, foreground="white", alpha=0.8)  # a boundary is seen over cells of its colour too
OWN: dict[str, Any] = {"color": "0.35", "linestyle": ":", "linewidth": 1.0}
COLUMNS = 3  # models beside each other
LETTERS = "abcdefghijklmnopqrstuvwxyz"
SHADES = {
    "no impact": "#D9D9D9",
    "period 1": COLOURS[0],
    "period 2": COLOURS[1],
    "period 3 … 16": COLOURS[3],
    "not periodic": "#FFFFFF",
    "failed": "#333333",
}  #: classes of the motion, in the order of ``observe.periodicity.Class``

Handles = list[Any]
Draw = Callable[[Axes, Array, Array], None]


@dataclass(frozen=True)
class PlanePanel:
    """One panel: its place, title, the name of its row, what draws its cells, and boundaries to lay over them."""

    row: int
    column: int
    title: str
    draw: Draw
    boundaries: Sequence[PlaneBoundary] = ()
    side: str = ""


@dataclass(frozen=True)
class MapPanel:
    """One fidelity and way, at one value of the outer axis where there are three: where it stands, what it shows."""

    row: int
    column: int
    title: str
    side: str
    fidelity: str
    way: int
    outer: tuple[tuple[str, float], ...] = ()
    index: int | None = None  # along the outer axis

    def of(self, response: GridResponse, quantity: str) -> NDArray[Any]:
        """One quantity of this panel, over the last two axes."""
        values = response.values[quantity][self.way]
        return np.asarray(values if self.index is None else values[self.index])


def panels(result: MapResult) -> Iterator[MapPanel]:
    """Panels of a map: a row for each fidelity and way, a column for each value of the outer axis."""
    outer = result.plan.axes[0] if len(result.plan.axes) == 3 else None
    shown = None if outer is None else shown_axis(result.case, outer)
    ways = [
        (fidelity, way, called) for fidelity, each in result.responses.items() for way, called in enumerate(each.ways)
    ]
    for row, (fidelity, way, called) in enumerate(ways):
        side = name_of(result.case, fidelity) + ("" if called == "apart" else f", {called}")
        if outer is None or shown is None:
            yield MapPanel(row, 0, "", side, fidelity, way)
            continue
        for column, value in enumerate(outer.values):
            title = f"({LETTERS[column % 26]}) {shown.text(value)}"
            yield MapPanel(row, column, title, side, fidelity, way, ((outer.key, value),), column)


def place_of(number: int) -> tuple[int, int]:
    """Row and column of a model's panel."""
    return divmod(number, COLUMNS)


def page_size(rows: int, columns: int, around: float = 1.3) -> tuple[float, float]:
    """Size of the figure in inches; ``around``: for titles and legend."""
    return 5.8 if columns == 1 else 2.7 * columns + 0.8, max(3.6, 2.2 * rows + around)


def size_of(result: MapResult) -> tuple[float, float]:
    """Size of the figure of a swept map."""
    shown = list(panels(result))
    return page_size(max(each.row for each in shown) + 1, max(each.column for each in shown) + 1)


def draw_planes(figure: Figure, result: MapResult, shown: Sequence[PlanePanel]) -> Handles:
    """Draw all panels with their boundaries and the case's own value; return the legend of these lines."""
    rows, columns = max(each.row for each in shown) + 1, max(each.column for each in shown) + 1
    grid: Any = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    page = _Page.of(result)
    for panel in shown:
        page.draw(grid[panel.row, panel.column], panel, first=panel.column == 0 and rows > 1)
    taken = {(panel.row, panel.column) for panel in shown}
    for row, column in np.ndindex(rows, columns):
        if (row, column) not in taken:
            grid[row, column].set_axis_off()
        elif (row + 1, column) not in taken:
            grid[row, column].set_xlabel(page.across.label)
            grid[row, column].tick_params(labelbottom=True)
    if page.upward is not None:
        figure.supylabel(page.upward.label, fontsize=PAGE["font.size"])
    return page.legend()


@dataclass
class _Page:
    """Axes that all panels share, and what is drawn in any of them."""

    across: ShownAxis
    upward: ShownAxis | None
    x: Array
    y: Array
    own: float
    kinds: set[Kind] = field(default_factory=set)

    @classmethod
    def of(cls, result: MapResult) -> _Page:
        """Axes of a map as they are shown."""
        case, axes = result.case, result.plan.axes
        known = next(iter(result.responses.values())).axes
        across = shown_axis(case, axes[-1])
        x = known[across.key] * across.factor
        if len(axes) == 1:
            return cls(across, None, x, np.zeros(1), float("nan"))
        upward = shown_axis(case, axes[-2])
        own = own_value(case, upward.key) * upward.factor
        return cls(across, upward, x, known[upward.key] * upward.factor, own)

    def draw(self, axes: Axes, panel: PlanePanel, first: bool) -> None:
        panel.draw(axes, self.x, self.y)
        axes.set_title(plain(panel.title))
        axes.set_ylabel(plain(panel.side) if first else "")
        axes.set_xlim(edges(self.x)[[0, -1]].min(), edges(self.x)[[0, -1]].max())
        axes.set_ylim(edges(self.y)[[0, -1]].min(), edges(self.y)[[0, -1]].max())
        if self.upward is None:
            axes.set_yticks([])
            return
        for number, each in enumerate(panel.boundaries):
            for part in each.parts():
                self._line(axes, each, part, f"{each.kind.name.lower()}-{number}-{part[0]}")
        if self.inside:
            axes.axhline(self.own, gid="own", path_effects=[HALO], **OWN)

    @property
    def inside(self) -> bool:
        """Test whether the case's own value lies on the map."""
        return bool(self.y.min() <= self.own <= self.y.max())

    def _line(self, axes: Axes, each: PlaneBoundary, part: NDArray[np.int64], name: str) -> None:
        """Draw a piece of a boundary, one of a single point as a dot."""
        alone: dict[str, Any] = {"marker": ".", "markersize": 4.0} if len(part) == 1 else {}
        up = self.upward.factor if self.upward else 1.0
        axes.plot(
            each.frequency[part] * self.across.factor, each.value[part] * up, linewidth=1.1, path_effects=[HALO],
            gid=name, **BOUNDARIES[each.kind], **alone,
        )  # fmt: skip
        self.kinds.add(each.kind)

    def legend(self) -> Handles:
        """Entries of the boundaries that are drawn, and of the case's own value."""
        lines = [
            Line2D([], [], label=f"exact: {KINDS[kind]}", linewidth=1.1, **look)
            for kind, look in BOUNDARIES.items()
            if kind in self.kinds
        ]
        own = self.upward is not None and self.inside
        return [*lines, *([Line2D([], [], label="the case's own", **OWN)] if own else [])]


def shade(axes: Axes, x: Array, y: Array, found: NDArray[Any], colours: Iterable[str]) -> None:
    """Draw a cell for each point, ``found`` (upward, across): the number of its colour."""
    shades = list(colours)
    axes.pcolormesh(
        edges(x), edges(y), found, cmap=ListedColormap(shades), vmin=-0.5, vmax=len(shades) - 0.5, rasterized=True
    )


def swatch(colour: str, label: str) -> Artist:
    """Legend entry of a class."""
    return Patch(facecolor=colour, edgecolor="0.6", linewidth=0.5, label=label)


def period(figure: Figure, result: MapResult, exact: bool) -> tuple[Handles, list[str]]:
    """Draw the class of the motion; ``exact``: with boundaries. Returns legend and notes."""
    seen: set[int] = set()

    def draw(axes: Axes, panel: MapPanel, x: Array, y: Array) -> None:
        response = result[panel.fidelity]
        found = cells(classes(*(panel.of(response, name) for name in ("period", "rest", "ended"))))
        seen.update(np.unique(found).tolist())
        shade(axes, x, y, found, SHADES.values())

    drawn, notes = _swept(figure, result, draw, exact)
    marks = [swatch(colour, name) for number, (name, colour) in enumerate(SHADES.items()) if number in seen]
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

    def draw(axes: Axes, panel: MapPanel, x: Array, y: Array) -> None:
        shown = cells(panel.of(result[panel.fidelity], quantity)).astype(float)
        colours = "RdBu_r" if signed else "viridis"
        meshes.append(axes.pcolormesh(edges(x), edges(y), shown, cmap=colours, norm=norm, rasterized=True))

    drawn, notes = _swept(figure, result, draw, exact)
    bar = figure.colorbar(meshes[0], ax=figure.axes, shrink=0.9)
    bar.set_label(quantity_label(result, quantity))
    return drawn, notes


def _swept(
    figure: Figure, result: MapResult, draw: Callable[[Axes, MapPanel, Array, Array], None], exact: bool
) -> tuple[Handles, list[str]]:
    """Draw every panel of a swept map, with boundaries where asked for."""
    notes: dict[str, None] = {}
    shown = []
    for panel in panels(result):
        found: list[PlaneBoundary] = []
        if exact and len(result.plan.axes) > 1:
            found, why = boundaries_of(result.case, panel.fidelity, result.plan.axes, panel.outer)
            notes.update({why: None} if why else {})
        drawn = lambda axes, x, y, panel=panel: draw(axes, panel, x, y)  # noqa: E731
        shown.append(PlanePanel(panel.row, panel.column, panel.title, drawn, found, panel.side))
    return draw_planes(figure, result, shown), list(notes)
