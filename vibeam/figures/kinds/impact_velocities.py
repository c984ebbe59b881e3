"""Figure kind ``impact_velocities``: how many impacts a second are harder than a velocity, of all fidelities."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from vibeam.case.plans import ShowPlan
from vibeam.figures.panels import is_empty, labelled, say
from vibeam.figures.record import RecordResult, unit_of_signal
from vibeam.figures.sheet import Sheet
from vibeam.figures.style import Keys, looks_of, name_of
from vibeam.observe.impact_statistics import Exceedance, exceedance_of

PANELS = 4  # values of the factor that get one
ERRORS = 2  # standard errors that a band is wide, to either side
size = (8.4, 3.8)  # inches: one row of panels
caption = "impacts a second that are harder than a velocity; band: two standard errors over the realisations"


def draw(figure: Figure, result: RecordResult, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw a panel for each of some values of the factor; bands are two standard errors over the realisations."""
    places = np.unique(np.round(np.linspace(0, len(result.factors) - 1, PANELS)).astype(int)).tolist()
    grid = figure.subplots(1, len(places), sharex=True, sharey=True, squeeze=False)[0]
    every = [each for name in plan.fidelities for row in result[name].impact_velocities for each in row]
    hardest = max((float(np.max(each, initial=0.0)) for each in every), default=0.0)
    unit, factor = unit_of_signal(result.case, "m s-1", hardest)
    for axes, place in zip(grid, places, strict=True):
        for name, look in looks_of(result.case, plan.fidelities).items():
            found = exceedance(result, name, place)
            _draw(axes, found, factor, look.keys(1.0) | {"label": name_of(result.case, name)})
        if len(places) > 1:
            axes.set_title(f"{result.over} {result.factors[place]:g}")
        if is_empty(axes):
            say(axes, "no impact")
        labelled(axes, "velocity before impact", unit, across=True)
    if lines := [line for axes in grid for line in axes.lines]:
        lowest = min(float(np.min(np.asarray(each.get_ydata(), dtype=float))) for each in lines)
        grid[0].set(yscale="log", xlim=(0, None), ylim=(lowest / 2, None))
    labelled(grid[0], "impacts that are harder", "1/s")


def exceedance(result: RecordResult, name: str, place: int) -> Exceedance:
    """Exceedance of a fidelity at the ``place``-th value of the factor, over its complete motions."""
    own = result[name]
    velocities = [
        each for each, complete in zip(own.impact_velocities[place], own.complete[place], strict=True) if complete
    ]
    return exceedance_of(velocities, own.duration)


def _draw(axes: Axes, found: Exceedance, factor: float, keys: Keys) -> None:
    if not len(found.velocity):
        return
    across, rate = np.append(0.0, found.velocity * factor), np.append(found.rate[0], found.rate)
    axes.plot(across, rate, drawstyle="steps-pre", **keys)
    band = ERRORS * np.append(found.error[0], found.error)
    low = np.maximum(rate - band, rate / 100)
    axes.fill_between(across, low, rate + band, step="pre", color=keys["color"], alpha=0.15, linewidth=0)
