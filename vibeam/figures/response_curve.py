"""Frequency-response curve as a figure: fidelities in one panel, or each in its own where there are many."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from vibeam.case.case import quantity_of
from vibeam.figures.page import PAGE, blank_page, legend, plain, titled, write_page
from vibeam.figures.panels import is_empty, say, start_upward
from vibeam.figures.response import ALONE, draw_branch
from vibeam.figures.sheet import Comparison
from vibeam.figures.style import (
    DOT,
    GAP,
    GHOST_LINE,
    KEY,
    LINES,
    REFERENCE,
    STABLE,
    UNSTABLE,
    Look,
    arrow,
    looks_of,
    name_of,
)
from vibeam.figures.units import DisplayUnits, amplitude_of, frequency_label, units_for
from vibeam.observe.branches import MotionClass, motion_pieces, pieces
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import Branches, Ended, FrequencyResponse, complete, modes_of, periodic
from vibeam_models.arrays import Array

TOGETHER = 3  # largest number of fidelities in one panel …
SCATTERED = 0.15  # … and largest share of their points that no line joins
ARROWS_A_BRANCH = 8
REFERENCES_SHOWN = 60
FAR = 2.0  # largest grazing amplitude drawn, in multiples of the curves' height


def write_frc(result: Comparison, *paths: Path, mark: str | None = None) -> None:
    """Draw amplitude against frequency; the format follows each path's ending (.png, .svg, .pdf)."""
    write_page(lambda: frc(result), paths, mark=mark)


def frc(result: Comparison) -> Figure:
    """Draw the frequency-response curve: fidelity by colour, direction by shade and arrows, class of motion by line."""
    together = len(result) < TOGETHER or (len(result) == TOGETHER and scattered(result) <= SCATTERED)
    figure, grid = _grid(1 if together else len(result), result)
    units, finest = units_for(result), result.finest
    panels = []
    for index, (name, look) in enumerate(looks_of(result.case, result).items()):
        own = look if together else Look(look.colour)  # a single fidelity: its dashes tell the class of motion
        panel = _Panel(grid.flat[0 if together else index], units, own, result, name, index if together else 0)
        panel.fill(ghost=None if together or name == finest[name] else finest[name], titled=not together)
        panels.append(panel)
    heights = dict(grazing_heights(result))
    highest = max((panel.highest for panel in panels), default=0.0)
    for panel in panels:
        panel.limit(heights.get(panel.name, 0.0), highest, len(panels) if together else 1)
    shown = list(dict.fromkeys(panel.axes for panel in panels))
    note = start_upward(shown)
    for axes in filter(is_empty, shown):
        say(axes, "no motion at any frequency")
    _label(figure, grid, result, units, note)
    legend(figure, _legend(panels, _ghost_called(result, finest), together), result.held.partition("\n")[2])
    return figure


def scattered(result: Comparison) -> float:
    """Share of the points that no line joins: motions that do not repeat, and isolated ones."""
    branches = [response for each in result.values() for _, response in each.items()]
    loose = (
        len(piece)
        for response in branches
        for piece in pieces(response)
        if piece.kind is MotionClass.NOT_PERIODIC or len(piece) == 1 < len(response)
    )
    return sum(loose) / max(sum(map(len, branches)), 1)


def _grid(count: int, result: Comparison) -> tuple[Figure, Any]:
    """Grid of axes with common scales, the last of each column numbered below."""
    columns = {1: 1, 2: 2, 3: 1, 4: 2}.get(count, 3)
    rows = ceil(count / columns)
    size = (5.8, 4.2) if count == 1 else (3.5 * columns if columns > 1 else 5.8, 2.3 * rows + 1.0)
    figure = blank_page(size, result.case.figure)
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for spare in grid.flat[count:]:
        spare.set_axis_off()
    for lowest in grid.flat[max(count - columns, 0) : count]:
        lowest.tick_params(labelbottom=True)
    return figure, grid


class _Panel:
    """One fidelity on its axes; ``drawn``: entries for the legend, ``row``: that of its failed marks."""

    def __init__(self, axes: Axes, units: DisplayUnits, look: Look, result: Comparison, name: str, row: int) -> None:
        self.axes, self.units, self.look, self.result, self.name, self.row = axes, units, look, result, name, row
        self.drawn: set[object] = set()
        self.reasons: set[str] = set()

    @property
    def label(self) -> str:
        """Name of the fidelity and its size."""
        modes, shown = modes_of(self.result[self.name]), name_of(self.result.case, self.name)
        return shown if shown != self.name else f"{shown} ({modes} mode{'s' * (modes > 1)})"

    @property
    def highest(self) -> float:
        """Largest amplitude in m, 0 without any."""
        return max(0.0, self.result[self.name].peak.amplitude)  # NaN, without any, is not larger

    def fill(self, ghost: str | None, titled: bool) -> None:
        if titled:
            self.axes.set_title(plain(self.label), color=self.look.colour)
        if ghost is not None:
            self._ghost(self.result[ghost])
        for direction, response in self.result[self.name].items():
            self.drawn.add(direction)
            self._branch(response, direction)
            self._arrows(response, direction)
        self._curves()
        self._references()
        self.axes.margins(x=0.02, y=0.08 + 0.1 * (MotionClass.FAILED in self.drawn))

    def _branch(self, response: FrequencyResponse, direction: str) -> None:
        factors = self.units.frequency_factor, self.units.length_factor
        row = 2 * self.row + (direction == "down")
        self.drawn |= draw_branch(
            self.axes, response, direction, self.look, *factors, failed_row=row, name=self.name
        )  # fmt: skip
        self.reasons |= {Ended.of_code(int(code)).value for code in response.ended[~complete(response)]}

    def _curves(self) -> None:
        """Draw all motions known to the solver: unstable ones dashed, inadmissible ones left out."""
        curves = self.result[self.name].curves
        for index, piece in enumerate([] if curves is None else motion_pieces(curves)):
            self.drawn |= set() if piece.stable else {"unstable"}
            name = f"{self.name}-curve-{index}-{'stable' if piece.stable else 'unstable'}"
            keys = STABLE if piece.stable else UNSTABLE
            self._plot(piece.frequency, piece.amplitude, gid=name, color=self.look.colour, **keys)

    def _arrows(self, response: FrequencyResponse, direction: str) -> None:
        """Draw marks of the direction on periodic points; the two directions alternate along the frequency axis."""
        turns = np.linspace(0.03, 0.97, 2 * ARROWS_A_BRANCH)[(0 if direction == "up" else 1) :: 2]
        at = np.unique((turns * (len(response) - 1)).round().astype(int))
        at = at if direction == "up" else len(response) - 1 - at
        at = at[periodic(response)[at]]
        self._plot(response.frequency[at], response.amplitude[at], **arrow(direction, self.look.colour))

    def _ghost(self, branches: Branches) -> None:
        for _, response in branches.items():
            for piece in pieces(response):
                if piece.kind in (MotionClass.PERIOD_ONE, MotionClass.PERIOD_MORE):
                    self.drawn.add("ghost")
                    alone = {"marker": "o", "markersize": 3.6, "markeredgewidth": 0} if len(piece) == 1 else {}
                    at = piece.points
                    name = f"{self.name}-ghost"
                    self._plot(response.frequency[at], response.amplitude[at], gid=name, **(GHOST_LINE | alone))

    def _references(self) -> None:
        for reference in self.result.case.references.values():
            if reference.fidelity == self.name and reference.quantity == "amplitude":
                points = [(point.frequency, point.value) for point in reference.points()]
                frequency, value = np.array(points, dtype=float).reshape(-1, 2).T  # None becomes NaN: not drawn
                self.drawn.add("reference")
                every = ceil(len(points) / REFERENCES_SHOWN)  # too many marks would hide the curve
                self._plot(frequency, value, gid=f"reference-{reference.name}", markevery=every, **REFERENCE)

    def limit(self, height: float, highest: float, shared: int) -> None:
        """Draw the amplitude at which the first mode alone reaches the stop, unless it is far above the curves.

        ``shared``: number of fidelities in the panel; where their lines coincide, their dots alternate.
        """
        if 0 < height <= FAR * highest or (height > 0 and highest == 0):
            self.drawn.add("gap")
            dots = 2.65 * self.row, (1.0, 2.65 * shared - 1.0)
            own = GAP | {"color": self.look.colour, "linestyle": dots}
            self.axes.axhline(height * self.units.length_factor, gid=f"{self.name}-gap", **own)
        elif height > 0:
            self.drawn.add("gap above")

    def _plot(self, frequency: Array, length: Array, **look: Any) -> None:
        self.axes.plot(frequency * self.units.frequency_factor, length * self.units.length_factor, **look)


def grazing_heights(result: Comparison) -> Iterator[tuple[str, float]]:
    """Amplitude of every fidelity's grazing; none of rates, where it depends on the frequency."""
    case = result.case
    if not quantity_of(case, case.sweep.output).rate:
        for name in result:
            yield name, grazing(case.system(name), case.sweep.output)


def grazing(system: ImpactSystem, output: str) -> float:
    """Amplitude of the output at which the first mode alone just reaches the stop; at most 0: it always does."""
    drawn = np.divide(system.static, system.omega**2, out=np.zeros(system.size), where=system.static != 0)
    left = system.gap - float(system.contact @ drawn)  # share of the gap, under a constant load
    return float(left * abs(system.output(output)[0] / system.contact[0]))


def _label(figure: Figure, grid: Any, result: Comparison, units: DisplayUnits, note: str) -> None:
    columns = grid.shape[1]
    for axes in [axes for axes in grid.flat if axes.axison][-columns:]:
        axes.set_xlabel(frequency_label(units))
    upward = amplitude_of(result.case.sweep.output, units)
    figure.supylabel("\n".join(filter(None, [upward, note])), fontsize=PAGE["font.size"])
    held = result.held.partition("\n")[0]
    titled(figure, result.case.figure, result.case.title, f"frequency response, {held}".removesuffix(", "))


def _ghost_called(result: Comparison, finest: Mapping[str, str]) -> str:
    names = set(finest.values())
    return name_of(result.case, names.pop()) if len(names) == 1 else "the finest of the same physics"


def _legend(panels: list[_Panel], finest: str, together: bool) -> list[Line2D]:
    """Legend entries: fidelities by colour where they share a panel, then the classes of motion, in grey."""
    drawn = set().union(*(panel.drawn for panel in panels))
    reasons = sorted(set().union(*(panel.reasons for panel in panels)))
    keys: dict[object, tuple[str, dict[str, Any]]] = {
        "up": ("sweep up", {"marker": ">", "markersize": 5, "markerfacecolor": "0.25"}),
        "down": ("sweep down", {"color": "0.75", "marker": "<", "markersize": 5, "linewidth": 3.1}),
        **{
            kind: (kind.value, LINES[kind])
            for kind in MotionClass
            if kind not in (MotionClass.PERIOD_ONE, MotionClass.FAILED)
        },
        ALONE: (ALONE, DOT),
        "unstable": ("unstable", UNSTABLE),
        "ghost": (f"{finest}, for comparison", GHOST_LINE),
        "reference": ("reference", REFERENCE),
        "gap": (f"grazing: mode 1 reaches the stop{', each in its colour' * (together and len(panels) > 1)}", GAP),
        "gap above": ("grazing: above the figure", GAP),
        MotionClass.FAILED: (f"failed, along the upper edge: {'; '.join(reasons)}", LINES[MotionClass.FAILED]),
    }
    colours = [
        Line2D([], [], label=panel.label, **panel.look.keys(2.0 if len(panels) == 1 else 1.2))
        for panel in panels
        if together
    ]
    return colours + [
        Line2D([], [], label=label, **(KEY | look)) for key, (label, look) in keys.items() if key in drawn
    ]
