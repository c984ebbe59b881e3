"""Line styles of figures: one for each fidelity, the same in all figures of a case, and one for each motion class."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, TypeVar

from vibeam.case.case import Case
from vibeam.observe.branches import MotionClass

Keys = dict[str, Any]
Thing = TypeVar("Thing")


COLOURS = ("#0072B2", "#D55E00", "#009E73", "#AA4499", "#7A5C00", "#333333")  # distinct in colour-blind vision
DASHES: tuple[Any, ...] = ("-", (0, (7, 1.8)), (0, (1.2, 1.2)), (0, (7, 1.5, 1.2, 1.5, 1.2, 1.5)))
HATCHES = ("", "////", "....", "xxxx")  # hatches of bars
GHOST_LINE: Keys = {"color": "#C4C4C4", "linewidth": 3.6, "zorder": 1}
LIGHTER = {"up": 0.0, "down": 0.58}
WIDER = {"up": 1.0, "down": 2.6}  # the sweep down lies behind, as a light band: where both agree, both are visible
BEHIND = {"up": 3.0, "down": 2.0}
ARROWS = {"up": ">", "down": "<"}
WIDEST, NARROWEST = 1.7, 0.7  # line widths of the first and the last of several curves, relative to a lone one
FEW = 3  # points of a branch up to which each is shown as a full dot


LINES: dict[MotionClass, Keys] = {
    MotionClass.PERIOD_ONE: {"linewidth": 1.2},
    MotionClass.PERIOD_MORE: {"linewidth": 0.7, "marker": "D", "markersize": 2.6, "markeredgewidth": 0.7},
    MotionClass.NO_CONTACT: {"linewidth": 0.8, "linestyle": (0, (6, 1.5, 1, 1.5))},
    MotionClass.NOT_PERIODIC: {"linestyle": "", "marker": "o", "markersize": 2.4, "markeredgewidth": 0.6},
    MotionClass.FAILED: {"linestyle": "", "marker": "x", "markersize": 3.0, "markeredgewidth": 0.8},
}

DOT: Keys = {"linestyle": "", "marker": "o", "markersize": 2.0, "markerfacecolor": "0.25"}  # isolated, of period 1
DASH: Keys = {"marker": "_", "markersize": 5.0}  # isolated, without contact
UNSTABLE: Keys = {"linewidth": 0.9, "linestyle": (0, (3, 1.6)), "zorder": 2.5}
STABLE: Keys = {"linewidth": 0.9, "zorder": 2.5}
ARROW: Keys = {"linestyle": "", "markersize": 5.0, "markeredgewidth": 0.7, "zorder": 4.0}

REFERENCE: Keys = {
    "linestyle": "",
    "marker": "+",
    "markersize": 4.5,
    "color": "black",
    "markeredgewidth": 0.5,
    "zorder": 5,
}

GAP: Keys = {"linewidth": 0.9, "linestyle": ":", "color": "black"}
KEY: Keys = {"color": "0.25", "markerfacecolor": "white", "markeredgecolor": "0.25", "linewidth": 1.2}


@dataclass(frozen=True)
class Look:
    """Colour and dashes of one curve; ``wide``: its share of the usual line width."""

    colour: str
    dash: Any = "-"
    wide: float = 1.0

    def keys(self, width: float = 1.2) -> Keys:
        """Style as matplotlib keywords."""
        return {"color": self.colour, "linestyle": self.dash, "linewidth": width * self.wide}


def look(place: int, wide: float = 1.0) -> Look:
    """Look of the curve at ``place`` (0 …): 24 in all, of six colours and four kinds of dashes."""
    turn, colour = divmod(place, len(COLOURS))
    return Look(COLOURS[colour], DASHES[turn % len(DASHES)], wide)


def looks(things: Iterable[Thing]) -> list[tuple[Thing, Look]]:
    """Look of each thing by its place among them."""
    return [(thing, look(place)) for place, thing in enumerate(things)]


def looks_of(case: Case, names: Iterable[str]) -> dict[str, Look]:
    """Looks of fidelities by their places in the case; each a narrower line than the one that it may cover."""
    order, shown = list(case.fidelities), list(names)
    places = {name: order.index(name) if name in order else 0 for name in shown}
    return {name: look(places[name], nested(index, len(shown))) for index, name in enumerate(shown)}


def nested(index: int, count: int) -> float:
    """Share of the line width of one of ``count`` overlaid curves, so that coinciding ones are all visible."""
    return 1.0 if count == 1 else WIDEST + (NARROWEST - WIDEST) * index / (count - 1)


def bar(look: Look) -> Keys:
    """Look of a bar: hatched where a line would have dashes."""
    hatch = HATCHES[DASHES.index(look.dash)]
    return {"facecolor": look.colour, "edgecolor": "white" if hatch else look.colour, "hatch": hatch, "linewidth": 0.0}


def name_of(case: Case, fidelity: str) -> str:
    """Label of a fidelity, else its name."""
    known = case.fidelities
    return (known[fidelity].label or fidelity) if fidelity in known else fidelity


def shade(colour: Any, direction: str) -> tuple[float, ...]:
    """Colour of a fidelity for the sweep up, a lighter one for the sweep down."""
    from matplotlib.colors import to_rgb

    share = LIGHTER[direction]
    return tuple((1 - share) * channel + share for channel in to_rgb(colour))


def arrow(direction: str, colour: str) -> Keys:
    """Marks of the sweep's direction: full ones up, open ones down."""
    face = colour if direction == "up" else "white"
    return ARROW | {"marker": ARROWS[direction], "markerfacecolor": face, "markeredgecolor": colour}


def line(kind: MotionClass, direction: str, own: Look, points: int, all_points: int) -> Keys:
    """Line style of a piece of ``points`` points of a branch of ``all_points``: dashes by kind, of period 1 its own.

    An isolated point of a line becomes a dot, without contact a dash.
    """
    shaded = shade(own.colour, direction)
    keys = LINES[kind] | {"color": shaded, "markerfacecolor": "white", "markeredgecolor": shaded}
    keys["zorder"] = BEHIND[direction]
    if "marker" in keys:  # rings round those of later curves: where they coincide, all are visible
        keys["markersize"] *= own.wide**0.5
    if kind is MotionClass.PERIOD_ONE:
        keys |= {"linewidth": keys["linewidth"] * WIDER[direction] * own.wide, "linestyle": own.dash}
    if points > 1 or "marker" in keys:
        return keys
    if kind is MotionClass.NO_CONTACT:
        return keys | DASH
    size = (2.0 if all_points <= FEW else 1.0) * DOT["markersize"] * own.wide**0.5
    return keys | DOT | {"markersize": size, "markerfacecolor": shaded}
