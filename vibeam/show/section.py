"""The kind ``section``: the state of the output once a drive period, at the drive's phase 0 (a Poincaré section)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.observe.section import stroboscopic_section
from vibeam.report.units import rates_of, units_of
from vibeam.response import Ended
from vibeam.show.motion import NoMotion, Settled, exact_motion, settled, sheet_each
from vibeam.show.panels import labelled, sheets_at, titled
from vibeam.show.plan import Column, Columns, Sheet, ShowPlan
from vibeam.state import State

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vibeam.case import Case
    from vibeam.result import Result

Array = NDArray[np.float64]
PERIODS = 500


def sheets(case: Case, fidelity: str, plan: ShowPlan) -> list[Sheet]:
    """One a frequency."""
    return sheet_each(plan, fidelity, lambda frequency: _columns(case, fidelity, frequency, plan))


def _columns(case: Case, name: str, frequency: float, plan: ShowPlan) -> Columns:
    begin, periods = settled(case, name, frequency, plan), plan.periods or PERIODS
    if begin.state is None:
        raise NoMotion(begin.fault)
    if hasattr(begin.solver, "motion"):
        place, speed = _stepped(begin, begin.state, periods, plan.output)
    else:
        found = stroboscopic_section(exact_motion(begin, periods), plan.output, periods=periods)
        place, speed = found.displacement, found.velocity
    return {
        "displacement": Column(place, "q", "displacement of the output at the drive's phase 0"),
        "velocity": Column(speed, "q/s", "velocity of the output at the drive's phase 0"),
    }


def _stepped(begin: Settled, state: State, periods: int, output: str) -> tuple[Array, Array]:
    """Period by period, by the solver itself."""
    row, points = begin.system.output(output), []
    omega = np.array([begin.drive.omega])
    for _ in range(periods):
        points.append([row @ state.displacement, row @ state.velocity])
        response, state = begin.solver.steady(omega, begin.drive.amplitude, state, 0, 1, output)
        ended = Ended.of_code(int(response.ended[0]))
        if ended is not Ended.COMPLETE:
            raise NoMotion(ended.value)
    place, speed = np.array(points, dtype=float).T
    return place, speed


def draw(figure: Figure, result: Result, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """A panel a frequency."""
    units, rate = units_of(result.case), rates_of(result.case)
    grid = figure.subplots(1, len(plan.frequency), sharex=True, sharey=True, squeeze=False)[0]
    for axes, frequency in zip(grid, plan.frequency, strict=True):
        titled(axes, units, frequency)
        for sheet, colour in sheets_at(frequency, plan, shown):
            place, speed = sheet.of("displacement") * units.length_factor, sheet.of("velocity") * rate.factor
            axes.plot(place, speed, ".", markersize=2.5, color=colour, label=sheet.label)
        axes.margins(0.1)
        labelled(axes, "displacement at phase 0", units.length, across=True)
    labelled(grid[0], "velocity at phase 0", rate.name)
