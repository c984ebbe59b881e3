"""Axis limits that hold all that is drawn, marks of failed points, and notes on empty axes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.transforms import Bbox

from vibeam.figures.page import plain
from vibeam_models.arrays import Array

DECADES = 10  # decades below the largest value: smaller values are round-off
ROW = 0.028  # height of a row of marks of failed points, in axes
SLIGHT, MARGIN = 1e-3, 0.1  # relative range below which all points coincide; margin around one
TOP = 0.4  # share of the largest value that the range of all values is below, for an axis that does not start at 0
CUT = ((-1.0, -0.5), (1.0, 0.5))  # stroke of the mark of such an axis
NOT_FROM_ZERO = "the axis does not start at 0"


def start_upward(panels: Sequence[Axes]) -> str:
    """Start upward axes of one scale at 0, or mark them where all that is drawn lies in their upper part.

    Return what their label has to add: nothing, or that they do not start at 0.
    """
    boxes = [axes.dataLim for axes in panels if not is_empty(axes)]
    low, high = (min(box.y0 for box in boxes), max(box.y1 for box in boxes)) if boxes else (0.0, 0.0)
    if not SLIGHT * high < high - low < TOP * high:
        for axes in panels:
            from_zero(axes)
        return ""
    for axes in panels:
        for height in (0.03, 0.05):
            axes.plot(
                0, height, transform=axes.transAxes, clip_on=False, marker=CUT, markersize=7, color="black",
                markeredgewidth=0.8, gid="not-from-zero",
            )  # fmt: skip
    return NOT_FROM_ZERO


def from_zero(axes: Axes) -> None:
    """Start the upward axis at 0; its upper end goes on to scale with whatever is drawn."""
    (anchor,) = axes.plot([], [], linestyle="")
    anchor.sticky_edges.y.append(0.0)
    axes.update_datalim([(0.0, 0.0)], updatex=False)
    axes.autoscale(enable=True, axis="y")


def decades(axes: Axes, values: list[Array], least: float = 0.0) -> None:
    """Logarithmic upward axis, ten decades at most below the largest of ``values``, and not below ``least``."""
    known = np.concatenate([np.empty(0), *values])
    known = known[np.isfinite(known) & (known > 0)]
    if not len(known):
        return
    axes.set_yscale("log")
    top = float(known.max())
    bottom = max(float(known[known >= top * 10.0**-DECADES].min()) / 2, least)
    axes.set_ylim(min(bottom, top / 10), 2 * top)


def around(panels: Sequence[Axes]) -> None:
    """Widen shared limits where all points coincide, so that round-off does not fill the figure."""
    boxes = [axes.dataLim for axes in panels if not is_empty(axes)]
    if not boxes:
        return
    box = Bbox.union(boxes)
    for low, high, limit in ((box.x0, box.x1, panels[0].set_xlim), (box.y0, box.y1, panels[0].set_ylim)):
        size = max(abs(low), abs(high))
        if high - low <= SLIGHT * size:
            limit(low - MARGIN * size, high + MARGIN * size)


def mark_failed(axes: Axes, frequency: Array, row: int, **look: Any) -> None:
    """Mark frequencies without a motion, in rows along the upper edge."""
    if len(frequency):
        height = np.full(len(frequency), 1 - ROW * (row + 0.7))
        axes.plot(frequency, height, transform=axes.get_xaxis_transform(), **look)


def is_empty(axes: Axes) -> bool:
    """True where no point, line or bar lies on these axes."""
    return not bool(np.all(np.isfinite(axes.dataLim.get_points())))


def say(axes: Axes, text: str) -> None:
    """Write a note in the middle of axes."""
    axes.text(0.5, 0.5, plain(text), transform=axes.transAxes, ha="center", va="center", color="0.35", wrap=True)
