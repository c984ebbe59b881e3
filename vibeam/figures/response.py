"""Branches of a response over frequency, each piece in the style of its class of motion; a figure without a case."""

from __future__ import annotations

from collections.abc import Mapping

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import EngFormatter

from vibeam.exchange.faults import suggest
from vibeam.figures.page import ShownFigure
from vibeam.figures.panels import mark_failed
from vibeam.figures.style import COLOURS, DOT, KEY, LINES, Keys, Look, line, shade
from vibeam.observe.branches import MotionClass, pieces
from vibeam.system.quantities import LAYOUT
from vibeam.system.response import SINGLE, FrequencyResponse
from vibeam_models.arrays import Array

ALONE = "period 1, at one frequency alone"


def draw_branch(
    axes: Axes, response: FrequencyResponse, direction: str, look: Look, across: float = 1.0, upward: float = 1.0,
    values: Array | None = None, failed_row: int | None = None, name: str | None = None,
) -> set[object]:  # fmt: skip
    """Draw the amplitude, or ``values`` (points,), and return what the legend has to explain.

    ``across``, ``upward``: factors to the displayed units; ``failed_row``: that of the marks of failed points along the
    upper edge, None: left out; ``name``: with which the pieces' own names begin.
    """
    drawn = response.amplitude if values is None else values
    found: set[object] = set()
    for index, piece in enumerate(pieces(response, values)):
        keys = line(piece.kind, direction, look, len(piece), len(response))
        own = None if name is None else f"{name}-{direction}-{index}-{piece.kind.name.lower()}"
        frequency = response.frequency[piece.points] * across
        if piece.kind is not MotionClass.FAILED:
            axes.plot(frequency, drawn[piece.points] * upward, gid=own, **keys)
        elif failed_row is not None:
            mark_failed(axes, frequency, failed_row, gid=own, **keys)
        alone = piece.kind is MotionClass.PERIOD_ONE and len(piece) == 1
        found.add(ALONE if alone else piece.kind)
    return found


SHOWN = (*SINGLE, "period", "impacts", "evaluations")  # quantities with one number a point
PREFIXED = {"q": "m", "c": "m", "c/s": "m/s", "s": "s"}  # units that take a prefix


def response_figure(branches: Mapping[str, FrequencyResponse], quantity: str) -> Figure:
    """Draw the kinds of motion by line, the sweep down lighter; ValueError for an unknown quantity."""
    if quantity not in SHOWN:
        raise ValueError(f"quantity: no {quantity!r} with one number a point: {suggest(str(quantity), SHOWN)}")
    figure = ShownFigure(figsize=(5.8, 4.2), layout="constrained")
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


def _keys(branches: Mapping[str, FrequencyResponse], drawn: set[object]) -> list[Line2D]:
    directions = branches if len(branches) > 1 else ()
    swept = []
    for direction in directions:
        look: Keys = {"color": shade(COLOURS[0], direction), "linewidth": 2.5}
        swept.append(Line2D([], [], label=f"sweep {direction}", **look))
    kinds = [Line2D([], [], label=kind.value, **(KEY | LINES[kind])) for kind in MotionClass if kind in drawn]
    return swept + kinds + [Line2D([], [], label=ALONE, **(KEY | DOT))] * (ALONE in drawn)
