"""Classes of motion in maps: no impact, period 1, 2, more, none; their colours, and the edges of the cells."""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.colors import ListedColormap
from numpy.typing import NDArray

from vibeam.figures.style import COLOURS
from vibeam.system.ended import Ended

if TYPE_CHECKING:
    from matplotlib.axes import Axes

RESTING = 0.999  # share of the time on the stop from which a motion has no impacts


class Class(IntEnum):
    """Class of a motion in the map."""

    NO_IMPACT = 0
    PERIOD_ONE = 1
    PERIOD_TWO = 2
    PERIOD_MORE = 3
    NOT_PERIODIC = 4
    FAILED = 5
    NOT_RUN = 6


CALLED = ("no impact", "period 1", "period 2", "period 3 … 16", "not periodic", "failed", "not computed yet")
SHADES = ("#D9D9D9", COLOURS[0], COLOURS[1], COLOURS[3], "#FFFFFF", "#333333", "#F7E9C6")


def classes(period: NDArray[Any], rest: NDArray[Any], ended: NDArray[Any]) -> NDArray[np.int_]:
    """Class of the motion at every point, of the shape of the arguments: period, share at rest, code of ``Ended``."""
    found = np.select([period > 2, period > 0], [Class.PERIOD_MORE, period], Class.NOT_PERIODIC)
    found = np.where((period < 0) | (rest > RESTING), Class.NO_IMPACT, found)
    found = np.where(ended == Ended.COMPLETE.code, found, Class.FAILED)
    return np.where(ended == Ended.NOT_RUN.code, Class.NOT_RUN, found)


def edges(centres: NDArray[np.float64]) -> NDArray[np.float64]:
    """Edges of the cells round ``centres``, (points + 1,): half-way between neighbours."""
    if len(centres) == 1:
        return np.array([centres[0] - 0.5, centres[0] + 0.5])
    inner = (centres[1:] + centres[:-1]) / 2
    return np.concatenate([[2 * centres[0] - inner[0]], inner, [2 * centres[-1] - inner[-1]]])


def draw_classes(
    axes: Axes, across: NDArray[np.float64], upward: NDArray[np.float64], found: NDArray[np.int_]
) -> None:  # fmt: skip
    """Draw a cell for each point, ``found`` (upward, across), its colour by its class."""
    axes.pcolormesh(
        edges(across), edges(upward), found, cmap=ListedColormap(SHADES), vmin=-0.5, vmax=len(SHADES) - 0.5,
        rasterized=True,
    )  # fmt: skip


def key(found: int) -> dict[str, Any]:
    """Look of a class in the legend."""
    return {
        "color": SHADES[found], "markeredgecolor": "0.4", "markeredgewidth": 0.5, "linestyle": "", "marker": "s",
        "label": CALLED[found],
    }  # fmt: skip
