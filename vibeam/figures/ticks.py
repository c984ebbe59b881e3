"""Tick labels without overlap: fewer ticks wherever two labels would touch."""

from __future__ import annotations

from itertools import combinations
from typing import Any

from matplotlib.figure import Figure
from matplotlib.ticker import AutoLocator, FixedLocator, LogLocator, MaxNLocator
from matplotlib.transforms import Bbox

FEWER = (6, 5, 4, 3, 2, 1)  # numbers of intervals, tried in order until nothing overlaps
STEPS = [1, 2, 5, 10]
ROOM = 3.0  # points between two labels


def thin_out(figure: Figure) -> None:
    """Reduce the ticks of axes whose labels overlap, their own or a neighbour's."""
    for count in FEWER:
        crowded = crowded_axes(figure)
        for axis in crowded:
            _limit(axis, count)
        if not crowded:
            return


def crowded_axes(figure: Figure) -> list[Any]:
    """Axes (matplotlib ``Axis``) with a tick label that overlaps another one."""
    figure.draw_without_rendering()
    axes = [axis for each in figure.axes if each.axison for axis in (each.xaxis, each.yaxis)]
    boxes = [(axis, box) for axis in axes for box in _boxes(axis, ROOM * figure.dpi / 72)]
    pairs = [(one, two) for (one, box), (two, other) in combinations(boxes, 2) if box.overlaps(other)]
    alike = [pair for pair in pairs if pair[0].axis_name == pair[1].axis_name]  # fewer ticks help along one axis only
    return list(dict.fromkeys(axis for pair in alike for axis in pair))


def _boxes(axis: Any, room: float) -> list[Bbox]:
    """Boxes of the labels, in pixels; neighbours widened by half the ``room`` between two on either side."""
    if isinstance(axis.get_major_locator(), FixedLocator):
        return []
    low, high = sorted(axis.get_view_interval())
    ticks = [tick for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high]
    labels = [label for tick in ticks for label in (tick.label1, tick.label2) if label.get_visible()]
    found = [label.get_window_extent() for label in labels if label.get_text()]
    beside = room / 2 if axis.axis_name == "x" else 0.0
    return [Bbox.from_extents(box.x0 - beside, box.y0, box.x1 + beside, box.y1) for box in found]


def _limit(axis: Any, count: int) -> None:
    if axis.get_scale() == "log":
        axis.set_major_locator(LogLocator(numticks=count))
    elif isinstance(axis.get_major_locator(), AutoLocator | MaxNLocator):
        axis.set_major_locator(MaxNLocator(count, steps=STEPS, min_n_ticks=1))
