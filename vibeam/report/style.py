"""How figures look: colours that stay apart for every eye, and one line a kind of motion."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import cycle
from typing import Any, TypeVar

from matplotlib.colors import to_rgb

from vibeam.report.curve import Kind

Look = dict[str, Any]
Thing = TypeVar("Thing")

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#AA4499", "#7A5C00", "#333333")
GHOST = "#C4C4C4"
LIGHTER = {"up": 0.0, "down": 0.58}
WIDER = {"up": 1.0, "down": 2.6}  # the sweep down lies behind, as a light band: where both agree, both are seen
BEHIND = {"up": 3.0, "down": 2.0}
ARROWS = {"up": ">", "down": "<"}

LINES: dict[Kind, Look] = {
    Kind.PERIOD_ONE: {"linewidth": 1.2},
    Kind.PERIOD_MORE: {"linewidth": 0.7, "marker": "D", "markersize": 2.6, "markeredgewidth": 0.7},
    Kind.NO_CONTACT: {"linewidth": 0.8, "linestyle": (0, (6, 1.5, 1, 1.5))},
    Kind.NOT_PERIODIC: {"linestyle": "", "marker": "o", "markersize": 2.4, "markeredgewidth": 0.6},
    Kind.FAILED: {"linestyle": "", "marker": "x", "markersize": 3.5, "markeredgewidth": 0.8},
}
UNSTABLE: Look = {"linewidth": 0.9, "linestyle": (0, (3, 1.6)), "zorder": 2.5}
STABLE: Look = {"linewidth": 0.9, "zorder": 2.5}
ARROW: Look = {"linestyle": "", "markersize": 5.0, "markeredgewidth": 0.7, "zorder": 4.0}
REFERENCE: Look = {
    "linestyle": "",
    "marker": "+",
    "markersize": 4.5,
    "color": "black",
    "markeredgewidth": 0.5,
    "zorder": 5,
}
GAP: Look = {"linewidth": 0.9, "linestyle": ":", "color": "black"}
KEY: Look = {"color": "0.25", "markerfacecolor": "white", "markeredgecolor": "0.25", "linewidth": 1.2}


def coloured(things: Iterable[Thing]) -> list[tuple[Thing, str]]:
    """Each with a colour of its own, while they last."""
    return list(zip(things, cycle(COLOURS), strict=False))


def shade(colour: Any, direction: str) -> tuple[float, ...]:
    """A fidelity's colour for the sweep up, a lighter one for the sweep down."""
    share = LIGHTER[direction]
    return tuple((1 - share) * channel + share for channel in to_rgb(colour))


def arrow(direction: str, colour: str) -> Look:
    """Marks of the sweep's direction: full ones up, open ones down."""
    face = colour if direction == "up" else "white"
    return ARROW | {"marker": ARROWS[direction], "markerfacecolor": face, "markeredgecolor": colour}


def line(kind: Kind, direction: str, colour: str, points: int) -> Look:
    """How a piece of a branch is drawn; a lone point of what is else a line becomes a small dot."""
    shaded = shade(colour, direction)
    look = LINES[kind] | {"color": shaded, "markerfacecolor": "white", "markeredgecolor": shaded}
    look["zorder"] = BEHIND[direction]
    if kind is Kind.PERIOD_ONE:
        look["linewidth"] *= WIDER[direction]
    if points == 1 and "marker" not in look:
        look |= {"marker": "o", "markersize": 2.0, "markerfacecolor": shaded}
    return look
