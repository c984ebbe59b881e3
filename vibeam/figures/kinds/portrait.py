"""Figure kind ``portrait``: velocity over displacement of the output, with the stop and the impacts marked."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray

from vibeam.case.case import Case
from vibeam.case.plans import ShowPlan
from vibeam.figures.panels import faults_at, mark_stop, sheets_at, titled
from vibeam.figures.settled_motion import motion_columns
from vibeam.figures.sheet import Columns, Comparison, Sheet
from vibeam.figures.style import Look, name_of
from vibeam.figures.units import DisplayUnits, motion_of, units_for

PERIODS = 16
ROUNDING = 1e-13
NEAR = 0.01  # tolerance, as a share of the range, for a closed orbit
REPEATS = 8  # largest period, in drive periods, of a closed orbit
SHADES, LEAST_SHADE = 8.0, 0.12  # opacity of an aperiodic motion's lines: first over their number, second at least


def columns(case: Case, name: str, frequency: float, plan: ShowPlan) -> Columns:
    """Motion of the output at one ``frequency``, Hz."""
    return motion_columns(case, name, frequency, plan, plan.periods or PERIODS)


def draw(figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw a panel a frequency."""
    case, units = result.case, units_for(result, plan.output)
    grid = figure.subplots(1, len(plan.frequency), sharex=True, sharey=True, squeeze=False)[0]
    for axes, frequency in zip(grid, plan.frequency, strict=True):
        titled(axes, units, frequency)
        for sheet, look in sheets_at(case, frequency, plan, shown):
            _path(axes, sheet, look, units, name_of(case, sheet.fidelity))
        faults_at(case, frequency, plan, shown, axes)
        mark_stop(case, plan, shown, axes.axvline, axes, units.length_factor)
        axes.set_xlabel(motion_of(plan.output, "displacement", units))
    grid[0].set_ylabel(motion_of(plan.output, "velocity", units))


def _path(axes: Axes, sheet: Sheet, look: Look, units: DisplayUnits, label: str) -> None:
    displacement, velocity = sheet["displacement"] * units.length_factor, sheet["velocity"] * units.speed_factor
    before = np.searchsorted(sheet["time"], sheet["impact_time"] * (1 - ROUNDING))  # first of the two samples
    loops = _loops(sheet)
    faded = max(LEAST_SHADE, SHADES / len(loops)) if len(loops) > REPEATS else 1.0
    if faded < 1:  # one line a period: the shade grows darker where many pass
        axes.plot([], [], label=label, **look.keys(0.8))
        paths = [np.stack([displacement[each], velocity[each]], axis=1) for each in loops]
        axes.add_collection(LineCollection(paths, color=look.colour, linewidth=0.5, alpha=faded, rasterized=True))
        axes.autoscale_view()
    else:
        axes.plot(displacement, velocity, label=label, **look.keys(0.8))
    size = 2.6 if faded == 1 else 1.2
    axes.plot(displacement[before], velocity[before], linestyle="", marker="o", markersize=size, color=look.colour,
              markeredgewidth=0, alpha=faded**0.5)  # fmt: skip


def _loops(sheet: Sheet) -> list[slice]:
    """Samples of each drive period, with the first of the next; one period of the motion alone if it is periodic."""
    turns = sheet["time"] * sheet.frequency
    last = max(round(float(turns[-1])), 1)
    cuts = np.searchsorted(turns, np.arange(last) * (1 - ROUNDING))
    loops = [slice(int(first), int(end) + 1) for first, end in pairwise([*cuts, len(turns)])]
    return loops[:REPEATS] if _repeats(sheet, cuts) else loops


def _repeats(sheet: Sheet, cuts: NDArray[np.int64]) -> bool:
    """Test whether the motion returns after some of the first drive periods, and repeats from there."""
    rows = [sheet[name] for name in ("displacement", "velocity")]
    states = np.stack([row[cuts] / max(float(np.ptp(row)), 1e-300) for row in rows], axis=1)
    back = (np.abs(states[each:] - states[:-each]).max() < NEAR for each in range(1, min(REPEATS + 1, len(states))))
    return any(back)
