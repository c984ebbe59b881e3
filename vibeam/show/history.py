"""The kind ``history``: displacement and velocity of the output over a few drive periods, the fidelities laid together.

Velocities jump at impacts and are drawn so: a stray value beside an impact, as in the paper's Fig. 5, would be seen.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from vibeam.report.style import GAP, GHOST
from vibeam.report.units import rates_of, units_of
from vibeam.show.motion import motion_columns, sheet_each
from vibeam.show.panels import labelled, sheets_at, stop_at, titled
from vibeam.show.plan import Sheet, ShowPlan

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vibeam.case import Case
    from vibeam.result import Result

PERIODS = 4


def sheets(case: Case, fidelity: str, plan: ShowPlan) -> list[Sheet]:
    """One a frequency."""
    periods = plan.periods or PERIODS
    return sheet_each(plan, fidelity, lambda frequency: motion_columns(case, fidelity, frequency, plan, periods))


def draw(figure: Figure, result: Result, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Displacement above velocity, a column a frequency; the first fidelity lies behind as a band."""
    units, rate = units_of(result.case), rates_of(result.case)
    grid = figure.subplots(2, len(plan.frequency), sharex=True, sharey="row", squeeze=False)
    for column, frequency in enumerate(plan.frequency):
        upper, lower = grid[:, column]
        titled(upper, units, frequency)
        for order, (sheet, colour) in enumerate(sheets_at(frequency, plan, shown)):
            look = {"color": GHOST, "linewidth": 3.2} if order == 0 and len(plan.fidelities) > 1 else {"color": colour}
            turns = sheet.of("time") * frequency
            upper.plot(turns, sheet.of("displacement") * units.length_factor, label=sheet.label, **look)
            lower.plot(turns, sheet.of("velocity") * rate.factor, **look)
        for height in stop_at(result.case, plan):
            upper.axhline(height * units.length_factor, **GAP)
        lower.set_xlabel("time in drive periods")
    labelled(grid[0, 0], "displacement", units.length)
    labelled(grid[1, 0], "velocity", rate.name)
