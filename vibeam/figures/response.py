"""Figure of one quantity of a response over frequency, without a case: axes in SI units with prefixes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import EngFormatter

from vibeam.case.faults import suggest
from vibeam.figures.branch_lines import ALONE, draw_branch
from vibeam.figures.style import COLOURS, DOT, KEY, LINES, Look, shade
from vibeam.observe.branches import MotionClass
from vibeam.system.quantities import LAYOUT
from vibeam.system.response import SINGLE, FrequencyResponse

SHOWN = (*SINGLE, "period", "impacts", "evaluations")  # quantities with one number a point
PREFIXED = {"q": "m", "c": "m", "c/s": "m/s", "s": "s"}  # units that take a prefix


def response_figure(branches: Mapping[str, FrequencyResponse], quantity: str) -> Figure:
    """Draw the kinds of motion by line, the sweep down lighter; ValueError for an unknown quantity."""
    if quantity not in SHOWN:
        raise ValueError(f"quantity: no {quantity!r} with one number a point: {suggest(str(quantity), SHOWN)}")
    figure = Figure(figsize=(5.8, 4.2), layout="constrained")
    axes = figure.subplots()
    drawn: set[object] = set()
    for direction, response in branches.items():
        values, row = getattr(response, quantity).astype(float), int(direction == "down")
        drawn |= draw_branch(axes, response, direction, Look(COLOURS[0]), values=values, failed_row=row)
    layout = LAYOUT[quantity]
    axes.xaxis.set_major_formatter(EngFormatter("Hz"))
    if layout.unit in PREFIXED:
        axes.yaxis.set_major_formatter(EngFormatter(PREFIXED[layout.unit]))
    axes.set_xlabel(LAYOUT["frequency"].long_name)
    axes.set_ylabel(layout.long_name)
    figure.legend(handles=_keys(branches, drawn), loc="outside lower center", ncols=3, frameon=False)
    return figure


def _colour(direction: str) -> dict[str, Any]:
    return {"color": shade(COLOURS[0], direction)}


def _keys(branches: Mapping[str, FrequencyResponse], drawn: set[object]) -> list[Line2D]:
    directions = branches if len(branches) > 1 else ()
    swept = [
        Line2D([], [], label=f"sweep {direction}", **_colour(direction), linewidth=2.5) for direction in directions
    ]
    kinds = [Line2D([], [], label=kind.value, **(KEY | LINES[kind])) for kind in MotionClass if kind in drawn]
    return swept + kinds + [Line2D([], [], label=ALONE, **(KEY | DOT))] * (ALONE in drawn)
