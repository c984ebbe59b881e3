"""Figure kind ``history``: displacement and velocity of the output over a few drive periods, all fidelities overlaid.

Velocities jump at impacts and are drawn so: a stray value beside an impact, as in the paper's Fig. 5, is visible. Of a
case with [record]: its input, output, impacts and contact force, over all of it and a part (``record_history``).
"""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure

from vibeam.case.case import Case
from vibeam.case.plans import ShowPlan
from vibeam.figures import record_history
from vibeam.figures.panels import faults_at, mark_stop, sheets_at, titled
from vibeam.figures.settled_motion import motion_columns
from vibeam.figures.sheet import Columns, Comparison, Sheet
from vibeam.figures.style import name_of
from vibeam.figures.units import motion_of, units_for

PERIODS = 4


def columns(case: Case, name: str, frequency: float, plan: ShowPlan) -> Columns:
    """Motion of the output at one ``frequency``, Hz."""
    return motion_columns(case, name, frequency, plan, plan.periods or PERIODS)


def caption(plan: ShowPlan) -> str:
    """Caption of the figure."""
    return "displacement and velocity over time" if plan.frequency else "histories: all of the record, and a part"


def size(plan: ShowPlan) -> tuple[float, float]:
    """One panel for each frequency, of a record two for each signal."""
    panels = len(plan.frequency)
    return record_history.SIZE if not panels else (5.8 if panels == 1 else 3.2 * panels + 0.6, 4.2)


def draw(figure: Figure, result: Any, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw displacement above velocity, a column a frequency; of coinciding motions the first is the widest line."""
    if result.case.record is not None:
        window = plan.own["window"]
        return record_history.draw_histories(figure, result, plan.fidelities, plan.output, window and tuple(window))
    return _draw_settled(figure, result, plan, shown)


def _draw_settled(figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    case, units = result.case, units_for(result, plan.output)
    grid = figure.subplots(2, len(plan.frequency), sharex=True, sharey="row", squeeze=False)
    for column, frequency in enumerate(plan.frequency):
        upper, lower = grid[:, column]
        titled(upper, units, frequency)
        for sheet, look in sheets_at(case, frequency, plan, shown):
            turns, keys = sheet["time"] * frequency, look.keys(1.0)
            upper.plot(
                turns, sheet["displacement"] * units.length_factor, label=name_of(case, sheet.fidelity), **keys
            )  # fmt: skip
            lower.plot(turns, sheet["velocity"] * units.speed_factor, **keys)
        faults_at(case, frequency, plan, shown, upper)
        faults_at(case, frequency, plan, shown, lower)
        mark_stop(case, plan, shown, upper.axhline, upper, units.length_factor)
        lower.set_xlabel("time in drive periods")
    grid[0, 0].set_ylabel(motion_of(plan.output, "displacement", units))
    grid[1, 0].set_ylabel(motion_of(plan.output, "velocity", units))
