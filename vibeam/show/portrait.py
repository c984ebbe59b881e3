"""The kind ``portrait``: velocity over displacement of the output, with the stop and the impacts marked."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vibeam.report.style import GAP
from vibeam.report.units import rates_of, units_of
from vibeam.show.motion import motion_columns, sheet_each
from vibeam.show.panels import labelled, sheets_at, stop_at, titled
from vibeam.show.plan import Sheet, ShowPlan

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from vibeam.case import Case
    from vibeam.report.units import Rates, Units
    from vibeam.result import Result

PERIODS = 16
ROUNDING = 1e-13


def sheets(case: Case, fidelity: str, plan: ShowPlan) -> list[Sheet]:
    """One a frequency."""
    periods = plan.periods or PERIODS
    return sheet_each(plan, fidelity, lambda frequency: motion_columns(case, fidelity, frequency, plan, periods))


def draw(figure: Figure, result: Result, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """A panel a frequency."""
    units, rate = units_of(result.case), rates_of(result.case)
    grid = figure.subplots(1, len(plan.frequency), sharex=True, sharey=True, squeeze=False)[0]
    for axes, frequency in zip(grid, plan.frequency, strict=True):
        titled(axes, units, frequency)
        for sheet, colour in sheets_at(frequency, plan, shown):
            _path(axes, sheet, colour, units, rate)
        for place in stop_at(result.case, plan):
            axes.axvline(place * units.length_factor, **GAP)
        labelled(axes, "displacement", units.length, across=True)
    labelled(grid[0], "velocity", rate.name)


def _path(axes: Axes, sheet: Sheet, colour: str, units: Units, rate: Rates) -> None:
    if sheet.fault:
        axes.plot([], [], color=colour, label=sheet.label)
        return
    place, speed = sheet["displacement"] * units.length_factor, sheet["velocity"] * rate.factor
    axes.plot(place, speed, color=colour, linewidth=0.8, label=sheet.label)
    before = np.searchsorted(sheet["time"], sheet["impact_time"] * (1 - ROUNDING))  # the first of the two samples
    axes.plot(place[before], speed[before], linestyle="", marker="o", markersize=2.6, color=colour)
