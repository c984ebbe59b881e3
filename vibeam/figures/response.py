"""Figure of one quantity of a response over frequency, without a case: axes in SI units with prefixes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import EngFormatter

from vibeam.case.faults import suggest
from vibeam.figures.branches import MotionClass, pieces
from vibeam.figures.style import BEHIND, COLOURS, KEY, LINES, WIDER, shade
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
    kinds = {kind for direction, response in branches.items() for kind in _draw(axes, response, direction, quantity)}
    layout = LAYOUT[quantity]
    axes.xaxis.set_major_formatter(EngFormatter("Hz"))
    if layout.unit in PREFIXED:
        axes.yaxis.set_major_formatter(EngFormatter(PREFIXED[layout.unit]))
    axes.set_xlabel(LAYOUT["frequency"].long_name)
    axes.set_ylabel(layout.long_name)
    figure.legend(handles=_keys(branches, kinds), loc="outside lower center", ncols=3, frameon=False)
    return figure


def _draw(axes: Axes, response: FrequencyResponse, direction: str, quantity: str) -> set[MotionClass]:
    """Draw one branch in pieces of one class of motion; failed points have no value and are left out."""
    drawn = set()
    for piece in pieces(replace(response, amplitude=getattr(response, quantity).astype(float))):
        drawn.add(piece.kind)
        axes.plot(piece.frequency, piece.amplitude, **_look(piece.kind, direction, len(piece.frequency)))
    return drawn


def _look(kind: MotionClass, direction: str, points: int) -> dict[str, Any]:
    colour = shade(COLOURS[0], direction)
    look: dict[str, Any] = {"color": colour, "markerfacecolor": "white", "markeredgecolor": colour} | LINES[kind]
    look |= {"zorder": BEHIND[direction]}
    if kind is MotionClass.PERIOD_ONE:
        look |= {"linewidth": look["linewidth"] * WIDER[direction]}
    return look | ({"marker": "o", "markersize": 2.0} if points == 1 and "marker" not in look else {})


def _colour(direction: str) -> dict[str, Any]:
    return {"color": shade(COLOURS[0], direction)}


def _keys(branches: Mapping[str, FrequencyResponse], kinds: set[MotionClass]) -> list[Line2D]:
    directions = branches if len(branches) > 1 else ()
    swept = [
        Line2D([], [], label=f"sweep {direction}", **_colour(direction), linewidth=2.5) for direction in directions
    ]
    return swept + [Line2D([], [], label=kind.value, **(KEY | LINES[kind])) for kind in MotionClass if kind in kinds]
