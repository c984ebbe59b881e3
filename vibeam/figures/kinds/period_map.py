"""Figure kind ``period_map``: period of the motion over drive frequency and the key that the fidelities set (Fig. 18).

A row a fidelity, a panel a direction of the sweep. Where the fidelities differ in one number, rows stand at its values.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.case.plans import ShowPlan
from vibeam.figures.motion_classes import classes, draw_classes
from vibeam.figures.motion_classes import key as key_of
from vibeam.figures.panels import across_frequency
from vibeam.figures.sheet import Sheet
from vibeam.figures.style import name_of
from vibeam.figures.units import units_for

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vibeam.case.case import Case
    from vibeam.figures.comparison import Comparison
    from vibeam.system.response import FrequencyResponse


def sheets(case: Case, fidelity: str, plan: ShowPlan) -> list[Sheet]:
    """No sheets: the sweep has the numbers."""
    return []


def classes_of(response: FrequencyResponse) -> NDArray[np.int_]:
    """Class of the motion at every point of a branch, (points,)."""
    return classes(np.asarray(response.period), np.asarray(response.rest), np.asarray(response.ended))


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
        cells = np.array([classes_of(each[direction])[order] for each in branches])
        seen |= set(cells.ravel().tolist())
        draw_classes(axes, across, up, cells)
        axes.set_title(f"sweep {direction}")
        across_frequency(axes, units)
    if values is None:
        grid[0].set_yticks(up, [name_of(case, name) for name in plan.fidelities])
    else:
        grid[0].set_ylabel(f"{key} (SI)")
    for each in sorted(seen):
        grid[0].plot([], [], **key_of(each))


def caption(plan: ShowPlan) -> str:
    """Caption of the figure."""
    return "period of the motion"
