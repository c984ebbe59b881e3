"""Limits of axes that hold all that is drawn, marks of what failed, and words where nothing is drawn."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.transforms import Bbox
from numpy.typing import NDArray

from vibeam.figures.page import plain

Array = NDArray[np.float64]

DECADES = 10  # below the largest value: what is smaller is round-off

ROW = 0.028  # height of a row of marks of failed points, in axes

SLIGHT, MARGIN = 1e-3, 0.1  # a range so small beside its place is that of a point; margin around one


def from_zero(axes: Axes) -> None:
    """Let the upward axis begin at 0 and go on to scale itself to whatever is drawn, before or after."""
    (anchor,) = axes.plot([], [], linestyle="")
    anchor.sticky_edges.y.append(0.0)
    axes.update_datalim([(0.0, 0.0)], updatex=False)
    axes.autoscale(enable=True, axis="y")


def decades(axes: Axes, values: list[Array], least: float = 0.0) -> None:
    """A logarithmic axis upward, ten decades at most below the largest of ``values``, and not below ``least``."""
    known = np.concatenate([np.empty(0), *values])
    known = known[np.isfinite(known) & (known > 0)]
    if not len(known):
        return
    axes.set_yscale("log")
    top = float(known.max())
    bottom = max(float(known[known >= top * 10.0**-DECADES].min()) / 2, least)
    axes.set_ylim(min(bottom, top / 10), 2 * top)


def around(panels: Sequence[Axes]) -> None:
    """Widen shared limits where all points lie at one place: its round-off is not to fill the figure."""
    boxes = [axes.dataLim for axes in panels if not is_empty(axes)]
    if not boxes:
        return
    box = Bbox.union(boxes)
    for low, high, limit in ((box.x0, box.x1, panels[0].set_xlim), (box.y0, box.y1, panels[0].set_ylim)):
        size = max(abs(low), abs(high))
        if high - low <= SLIGHT * size:
            limit(low - MARGIN * size, high + MARGIN * size)


def mark_failed(axes: Axes, frequency: Array, row: int, **look: Any) -> None:
    """Marks at frequencies without a motion, in rows along the upper edge: they have no height."""
    if len(frequency):
        height = np.full(len(frequency), 1 - ROW * (row + 0.7))
        axes.plot(frequency, height, transform=axes.get_xaxis_transform(), **look)


def is_empty(axes: Axes) -> bool:
    """Whether no point, line or bar has a place on these axes."""
    return not bool(np.all(np.isfinite(axes.dataLim.get_points())))


def say(axes: Axes, text: str) -> None:
    """Words in the middle of axes."""
    axes.text(0.5, 0.5, plain(text), transform=axes.transAxes, ha="center", va="center", color="0.35", wrap=True)
