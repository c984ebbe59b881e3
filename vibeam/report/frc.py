"""The frequency-response curve as a figure: fidelities in one panel, or each in its own where there are many."""

from __future__ import annotations

from collections.abc import Mapping
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from vibeam.compare import finest_of, modes_of, periodic
from vibeam.references import reference_points
from vibeam.report.curve import Kind, motion_pieces, pieces
from vibeam.report.page import PAGE, write_page
from vibeam.report.style import GAP, GHOST, KEY, LINES, REFERENCE, STABLE, UNSTABLE, arrow, coloured, line
from vibeam.report.units import Units, percent, units_of
from vibeam.response import Array, FrequencyResponse

if TYPE_CHECKING:
    from vibeam.response import Branches
    from vibeam.result import Result
    from vibeam.system import ImpactSystem

TOGETHER = 3  # so many fidelities share a panel
ARROWS_A_BRANCH = 8
REFERENCES_SHOWN = 60


def write_frc(result: Result, *paths: Path) -> None:
    """Draw amplitude against frequency; the format follows each path's ending (.png, .svg, .pdf)."""
    write_page(lambda: frc(result), paths)


def frc(result: Result) -> Figure:
    """The figure: fidelity by colour, direction by shade and arrows, kinds of motion by line."""
    together = len(result) <= TOGETHER
    figure, grid = _grid(1 if together else len(result))
    units, finest = units_of(result.case), {name: finest_of(result, name) for name in result}
    panels = []
    for index, (name, colour) in enumerate(coloured(result)):
        panel = _Panel(grid.flat[0 if together else index], units, colour, result, name)
        panel.fill(ghost=None if together or name == finest[name] else finest[name], titled=not together)
        panels.append(panel)
    _label(figure, grid, result, units)
    handles = _legend(panels, _ghost_called(finest), together)
    figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False, columnspacing=1.5)
    return figure


def _grid(count: int) -> tuple[Figure, Any]:
    """Axes that share their scales, the last of each column numbered below."""
    columns = 1 if count == 1 else 2 if count <= 4 else 3
    rows = ceil(count / columns)
    size = (5.8, 4.2) if count == 1 else (3.5 * columns, 2.3 * rows + 1.0)
    figure = Figure(figsize=size, layout="constrained")
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for spare in grid.flat[count:]:
        spare.set_axis_off()
    for lowest in grid.flat[max(count - columns, 0) : count]:
        lowest.tick_params(labelbottom=True)
    return figure, grid


class _Panel:
    """One fidelity on its axes; ``drawn`` collects what the legend must explain."""

    def __init__(self, axes: Axes, units: Units, colour: str, result: Result, name: str) -> None:
        self.axes, self.units, self.colour, self.result, self.name = axes, units, colour, result, name
        self.drawn: set[object] = set()

    @property
    def label(self) -> str:
        """The fidelity and its size."""
        modes = modes_of(self.result[self.name])
        study = self.result.accuracy
        if study is not None:
            return f"within {percent(study.within)} of {study.finest}"
        return f"{self.name} ({modes} mode{'s' * (modes > 1)})"

    def fill(self, ghost: str | None, titled: bool) -> None:
        if titled:
            self.axes.set_title(self.label, color=self.colour)
        if ghost is not None:
            self._ghost(self.result[ghost])
        for direction, response in self.result[self.name].items():
            self.drawn.add(direction)
            self._branch(response, direction)
            self._arrows(response, direction)
        self._curves()
        self._references()
        self._gap()
        self.axes.margins(x=0.02, y=0.08)
        self.axes.set_ylim(bottom=0)

    def _branch(self, response: FrequencyResponse, direction: str) -> None:
        for index, piece in enumerate(pieces(response)):
            self.drawn.add(piece.kind)
            look = line(piece.kind, direction, self.colour, len(piece.frequency))
            name = f"{self.name}-{direction}-{index}-{piece.kind.name.lower()}"
            failed = piece.kind is Kind.FAILED  # has no amplitude: a cross on the axis
            height = np.zeros_like(piece.amplitude) if failed else piece.amplitude
            self._plot(piece.frequency, height, gid=name, clip_on=not failed, **look)

    def _curves(self) -> None:
        """All motions that the solver knows: unstable ones dashed, those through the stop left out."""
        curves = self.result[self.name].curves
        for index, piece in enumerate([] if curves is None else motion_pieces(curves)):
            self.drawn |= set() if piece.stable else {"unstable"}
            name = f"{self.name}-curve-{index}-{'stable' if piece.stable else 'unstable'}"
            look = STABLE if piece.stable else UNSTABLE
            self._plot(piece.frequency, piece.amplitude, gid=name, color=self.colour, **look)

    def _arrows(self, response: FrequencyResponse, direction: str) -> None:
        """Marks of the direction on periodic points; the two directions take turns along the frequency axis."""
        turns = np.linspace(0.03, 0.97, 2 * ARROWS_A_BRANCH)[(0 if direction == "up" else 1) :: 2]
        at = np.unique((turns * (len(response) - 1)).round().astype(int))
        at = at if direction == "up" else len(response) - 1 - at
        at = at[periodic(response)[at]]
        self._plot(response.frequency[at], response.amplitude[at], **arrow(direction, self.colour))

    def _ghost(self, branches: Branches) -> None:
        self.drawn.add("ghost")
        for _, response in branches.items():
            for piece in pieces(response):
                if piece.kind in (Kind.PERIOD_ONE, Kind.PERIOD_MORE):
                    self._plot(piece.frequency, piece.amplitude, color=GHOST, linewidth=3.6, zorder=1)

    def _references(self) -> None:
        for reference in self.result.case.references.values():
            if reference.fidelity == self.name and reference.quantity == "amplitude":
                points = [(point.frequency, point.value) for point in reference_points(reference)]
                frequency, value = np.array(points, dtype=float).reshape(-1, 2).T  # None becomes NaN: not drawn
                self.drawn.add("reference")
                every = ceil(len(points) / REFERENCES_SHOWN)  # all of them would hide the curve
                self._plot(frequency, value, gid=f"reference-{reference.name}", markevery=every, **REFERENCE)

    def _gap(self) -> None:
        case = self.result.case
        study = self.result.accuracy
        height = grazing(case.system(self.name if study is None else study.finest), case.sweep.output)
        if height > 0:
            self.drawn.add("gap")
            self.axes.axhline(height * self.units.length_factor, gid=f"{self.name}-gap", **GAP)

    def _plot(self, frequency: Array, length: Array, **look: Any) -> None:
        self.axes.plot(frequency * self.units.frequency_factor, length * self.units.length_factor, **look)


def grazing(system: ImpactSystem, output: str) -> float:
    """The amplitude of the output at which the first mode alone just reaches the stop; at most 0: it always does."""
    drawn = np.divide(system.static, system.omega**2, out=np.zeros(system.size), where=system.static != 0)
    left = system.gap - float(system.contact @ drawn)  # of the gap, under a constant load
    return float(left * abs(system.output(output)[0] / system.contact[0]))


def _label(figure: Figure, grid: Any, result: Result, units: Units) -> None:
    names = {"contact": "the contact", "sensor": "the sensor", "tip": "the tip", "platform": "the platform"}
    where = names.get(result.case.sweep.output, "")
    across, upward = "drive frequency Ω/2π (Hz)", f"amplitude at {where}, ½(max − min) (mm)"
    if not units.frequency:
        across, upward = "drive frequency Ω/ω", "amplitude ½(max − min)"
    columns = grid.shape[1]
    for axes in [axes for axes in grid.flat if axes.axison][-columns:]:
        axes.set_xlabel(across)
    figure.supylabel(upward, fontsize=PAGE["font.size"])
    if result.case.title:
        figure.suptitle(result.case.title, fontsize=9.5)


def _ghost_called(finest: Mapping[str, str]) -> str:
    names = set(finest.values())
    return names.pop() if len(names) == 1 else "the finest of the same physics"


def _legend(panels: list[_Panel], finest: str, together: bool) -> list[Line2D]:
    """The fidelities by colour where they share a panel, then whatever occurs, in grey."""
    drawn = set().union(*(panel.drawn for panel in panels))
    keys: dict[object, tuple[str, dict[str, Any]]] = {
        "up": ("sweep up", {"marker": ">", "markersize": 5, "markerfacecolor": "0.25"}),
        "down": ("sweep down", {"color": "0.75", "marker": "<", "markersize": 5, "linewidth": 3.1}),
        **{kind: (kind.value, LINES[kind]) for kind in Kind if kind is not Kind.PERIOD_ONE},
        "unstable": ("unstable", UNSTABLE),
        "ghost": (f"{finest}, for comparison", {"color": GHOST, "linewidth": 3.6}),
        "reference": ("reference", REFERENCE),
        "gap": ("grazing: first mode just reaches the stop", GAP),
    }
    colours = [Line2D([], [], label=panel.label, color=panel.colour, linewidth=2.5) for panel in panels if together]
    return colours + [
        Line2D([], [], label=label, **(KEY | look)) for key, (label, look) in keys.items() if key in drawn
    ]
