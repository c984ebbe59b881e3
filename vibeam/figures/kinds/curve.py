"""Figure kind ``curve``: frequency-response curve of another quantity than the amplitude."""

from __future__ import annotations

from collections import defaultdict

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from vibeam.case.plans import ShowPlan
from vibeam.case.response_quantities import values_of
from vibeam.figures.panels import across_frequency, is_empty, labelled, say
from vibeam.figures.response import draw_branch
from vibeam.figures.sheet import Comparison, Sheet
from vibeam.figures.style import KEY, LINES, looks_of, name_of
from vibeam.figures.units import DisplayUnits, units_for
from vibeam.observe.branches import MotionClass
from vibeam.system.response import complete
from vibeam_models.outputs import DISPLACEMENT

LENGTHS = ("amplitude", "reach", "output_reach", "maximum", "minimum")
OF_CONTACT = ("reach", "impact_velocity")

OF_OUTPUT = {
    "amplitude": "amplitude ½(max − min)",
    "output_reach": "reach Q = Δ − min",
    "maximum": "maximum",
    "minimum": "minimum",
}

CALLED = {
    "reach": "reach of the contact Q = Δ − min q",
    "impact_velocity": "mean impact velocity of the contact",
    "impacts_per_period": "impacts a drive period",
    "period": "period (0: none, −1: no contact)",
}


NOTHING = defaultdict(lambda: "no motion at any frequency", impact_velocity="no impact at any frequency")


def draw(figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw all fidelities on the same axes, as in the frequency-response curve."""
    case, name = result.case, plan.quantity or "amplitude"
    units = units_for(result, "contact" if name in OF_CONTACT else None)
    unit, factor = (units.length, units.length_factor) if name in LENGTHS else ("", 1.0)
    unit, factor = (units.speed, units.speed_factor) if name == "impact_velocity" else (unit, factor)
    axes, drawn = figure.subplots(), set[object]()
    for row, (fidelity, look) in enumerate(looks_of(case, plan.fidelities).items()):
        known = False
        for direction, response in result[fidelity].items():
            values, place = values_of(case, fidelity, response, name), 2 * row + (direction == "down")
            known |= bool(np.isfinite(values[complete(response)]).any())
            drawn |= draw_branch(axes, response, direction, look, units.frequency_factor, factor, values, place)
        axes.plot([], [], label=name_of(case, fidelity) + ("" if known else f": {NOTHING[name]}"), **look.keys())
    if MotionClass.FAILED in drawn:
        axes.plot([], [], label="failed, along the upper edge", **(KEY | LINES[MotionClass.FAILED]))
        axes.margins(y=0.15)
    if name == "period":
        axes.yaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))
    if is_empty(axes):
        say(axes, NOTHING[name])
    across_frequency(axes, units)
    labelled(axes, _called(name, case.sweep.output, units), unit)


def caption(plan: ShowPlan) -> str:
    """Caption of the figure."""
    name = plan.quantity or "amplitude"
    return OF_OUTPUT.get(name, CALLED.get(name, name)).split(" (")[0]


def _called(name: str, output: str, units: DisplayUnits) -> str:
    whose = f"{output} " if units.frequency else ""
    whose += f"{units.quantity} " if units.quantity != DISPLACEMENT.name else ""
    return f"{whose}{OF_OUTPUT[name]}" if name in OF_OUTPUT else CALLED[name]
