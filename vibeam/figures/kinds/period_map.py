"""Figure kind ``period_map``: period of the motion over drive frequency and the key that the fidelities set (Fig. 18).

A row a fidelity, a panel a direction of the sweep. Where the fidelities differ in one number, rows stand at its values.
"""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import ListedColormap
from numpy.typing import NDArray

from vibeam.case.plans import ShowPlan
from vibeam.figures.panels import across_frequency
from vibeam.figures.sheet import Sheet
from vibeam.figures.style import COLOURS, name_of
from vibeam.figures.units import units_for
from vibeam.system.response import complete

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vibeam.case.case import Case
    from vibeam.figures.comparison import Comparison
    from vibeam.system.response import FrequencyResponse


RESTING = 0.999  # share of the time on the stop from which a motion has no impacts


class Class(IntEnum):
    """Class of a motion in the map."""

    NO_IMPACT = 0
    PERIOD_ONE = 1
    PERIOD_TWO = 2
    PERIOD_MORE = 3
    NOT_PERIODIC = 4
    FAILED = 5


CALLED = ("no impact", "period 1", "period 2", "period 3 … 16", "not periodic", "failed")

SHADES = ("#D9D9D9", COLOURS[0], COLOURS[1], COLOURS[3], "#FFFFFF", "#333333")


def sheets(case: Case, fidelity: str, plan: ShowPlan) -> list[Sheet]:
    """No sheets: the sweep has the numbers."""
    return []


def classes(response: FrequencyResponse) -> NDArray[np.int_]:
    """Class of the motion at every point of a branch, (points,)."""
    period = np.asarray(response.period)
    found = np.select([period > 2, period > 0], [Class.PERIOD_MORE, period], Class.NOT_PERIODIC)
    found = np.where((period < 0) | (np.asarray(response.rest) > RESTING), Class.NO_IMPACT, found)
    return np.where(complete(response), found, Class.FAILED)


def rows_at(case: Case, names: tuple[str, ...]) -> tuple[str, NDArray[np.float64] | None]:
    """Key in which alone the fidelities differ, and its ascending values; no key and None where there is none."""
    changes = [case.fidelities[name].changes for name in names]
    differing = [key for key in changes[0] if len({repr(each.get(key)) for each in changes}) > 1]
    same_keys = all(each.keys() == changes[0].keys() for each in changes)
    if not same_keys or len(differing) != 1 or not all(isinstance(each[differing[0]], float) for each in changes):
        return "", None
    values = np.array([each[differing[0]] for each in changes])
    return (differing[0], values) if np.all(np.diff(values) > 0) else ("", None)


def size(plan: ShowPlan) -> tuple[float, float]:
    """Two panels beside each other."""
    return (7.4, 1.6 + 0.22 * max(len(plan.fidelities), 6))


def draw(figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw a cell for each point of the sweep, its colour by the period."""
    case, units = result.case, units_for(result)
    key, values = rows_at(case, plan.fidelities)
    up = np.arange(len(plan.fidelities), dtype=float) if values is None else values
    branches = [dict(result[name].items()) for name in plan.fidelities]
    grid = figure.subplots(1, len(branches[0]), sharex=True, sharey=True, squeeze=False)[0]
    seen: set[int] = set()
    for axes, direction in zip(grid, branches[0], strict=True):
        order = np.argsort(branches[0][direction].frequency)
        across = branches[0][direction].frequency[order] * units.frequency_factor
        cells = np.array([classes(each[direction])[order] for each in branches])
        seen |= set(cells.ravel().tolist())
        colours = ListedColormap(SHADES)
        axes.pcolormesh(_edges(across), _edges(up), cells, cmap=colours, vmin=-0.5, vmax=len(SHADES) - 0.5)
        axes.set_title(f"sweep {direction}")
        across_frequency(axes, units)
    if values is None:
        grid[0].set_yticks(up, [name_of(case, name) for name in plan.fidelities])
    else:
        grid[0].set_ylabel(f"{key} (SI)")
    for each in sorted(seen):
        look = {"color": SHADES[each], "markeredgecolor": "0.4", "markeredgewidth": 0.5, "linestyle": ""}
        grid[0].plot([], [], marker="s", label=CALLED[each], **look)


def _edges(centres: NDArray[np.float64]) -> NDArray[np.float64]:
    """Edges of the cells round ``centres``, (points + 1,): half-way between neighbours."""
    if len(centres) == 1:
        return np.array([centres[0] - 0.5, centres[0] + 0.5])
    inner = (centres[1:] + centres[:-1]) / 2
    return np.concatenate([[2 * centres[0] - inner[0]], inner, [2 * centres[-1] - inner[-1]]])


def caption(plan: ShowPlan) -> str:
    """Caption of the figure."""
    return "period of the motion"
