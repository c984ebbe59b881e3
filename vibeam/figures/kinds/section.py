"""Figure kind ``section``: Poincaré section of the output, once a drive period at the drive's phase 0."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from vibeam.case.case import Case
from vibeam.case.plans import ShowPlan
from vibeam.figures.panels import around, faults_at, sheets_at, titled
from vibeam.figures.settled_motion import Settled, exact_motion, settled
from vibeam.figures.sheet import Column, Columns, Comparison, NoMotion, Sheet
from vibeam.figures.style import name_of
from vibeam.figures.units import motion_of, units_for
from vibeam.observe.phase_plane import stroboscopic_section
from vibeam.system.response import Ended
from vibeam_models.arrays import Array

PERIODS = 500
PLACES = 32  # largest number of points drawn with large marks
caption = "stroboscopic section: one point a drive period"


def columns(case: Case, name: str, frequency: float, plan: ShowPlan) -> Columns:
    """Points of the section at one ``frequency``, Hz."""
    begin, periods = settled(case, name, frequency, plan), plan.periods or PERIODS
    if begin.samples:
        displacement, velocity = _stepped(begin, periods, plan.output)
    else:
        found = stroboscopic_section(exact_motion(begin, periods), plan.output, periods=periods)
        displacement, velocity = found.displacement, found.velocity
    return {
        "displacement": Column(displacement, "q", "displacement of the output at the drive's phase 0"),
        "velocity": Column(velocity, "q/s", "velocity of the output at the drive's phase 0"),
    }


def _stepped(begin: Settled, periods: int, output: str) -> tuple[Array, Array]:
    """Section by the solver itself, period by period."""
    row, points, state = begin.system.output(output), [], begin.reached
    omega = np.array([begin.drive.omega])
    for _ in range(periods):
        points.append([row @ state.displacement, row @ state.velocity])
        response, state = begin.solver.steady(omega, begin.drive.amplitude, state, 0, 1, output)
        ended = Ended.of_code(int(response.ended[0]))
        if ended is not Ended.COMPLETE:
            raise NoMotion(ended.value)
    displacement, velocity = np.array(points, dtype=float).T
    return displacement, velocity


def draw(figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw a panel a frequency."""
    case, units = result.case, units_for(result, plan.output)
    grid = figure.subplots(1, len(plan.frequency), sharex=True, sharey=True, squeeze=False)[0]
    for axes, frequency in zip(grid, plan.frequency, strict=True):
        titled(axes, units, frequency)
        axes.margins(0.1)
        for sheet, look in sheets_at(case, frequency, plan, shown):
            displacement, velocity = sheet["displacement"] * units.length_factor, sheet["velocity"] * units.speed_factor
            marks = {"markersize": _size(displacement, velocity) * look.wide, "color": look.colour}
            axes.plot(displacement, velocity, ".", label=name_of(case, sheet.fidelity), **marks)
        faults_at(case, frequency, plan, shown, axes)
        axes.set_xlabel(f"{motion_of(plan.output, 'displacement', units)}\nat phase 0")
    around(grid)
    grid[0].set_ylabel(f"{motion_of(plan.output, 'velocity', units)} at phase 0")


def _size(displacement: Array, velocity: Array) -> float:
    """Size of the marks, in points: large for few distinct places, small for many."""
    steps = [np.round(row / max(float(np.abs(row).max()), 1e-300), 6) for row in (displacement, velocity)]
    return 7.0 if len(np.unique(np.stack(steps), axis=1).T) <= PLACES else 2.0
