"""Figure kind ``harmonics``: amplitudes of the output at multiples of the drive frequency (paper Fig. 20).

Frequencies that the table names are drawn as bars, a panel each; without, the orders are lines over the sweep's. Each
frequency begins at static equilibrium.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from vibeam.case.case import Case
from vibeam.case.plans import ShowPlan
from vibeam.figures.page import plain
from vibeam.figures.panels import across_frequency, decades, faults_at, is_empty, labelled, say, sheets_at, titled
from vibeam.figures.settled_motion import exact_motion, settled
from vibeam.figures.sheet import Column, Columns, Comparison, Sheet
from vibeam.figures.style import bar, name_of
from vibeam.figures.style import look as style
from vibeam.figures.units import DisplayUnits, motion_of, units_for
from vibeam.observe.harmonics import harmonic_amplitudes

HIGHEST = 8
PERIODS = 8  # default highest order, times the subdivision
FEW = 12  # largest number of frequencies drawn as bars
MARKED = 25  # points of a line below which each is marked
caption = "amplitudes at multiples of the drive frequency"


def columns(case: Case, name: str, frequency: float, plan: ShowPlan) -> Columns:
    """Amplitudes by order at one ``frequency``, Hz."""
    parts = plan.own["subdivision"] or 1
    periods = plan.periods or PERIODS * parts
    path = exact_motion(settled(case, name, frequency, plan), periods)
    found = harmonic_amplitudes(
        path, plan.output, periods=periods, highest=plan.own["highest"] or HIGHEST, subdivision=parts
    )  # fmt: skip
    return {
        "order": Column(found.order, "1", "multiple of the drive frequency"),
        "harmonic": Column(np.abs(found.amplitude), "q", "amplitude, of order 0 the mean's size"),
        "phase": Column(np.angle(found.amplitude), "1", "phase before the drive's, rad, x = Re Σ X e^{ikΩt}"),
    }


def size(plan: ShowPlan) -> tuple[float, float]:
    """One panel for each frequency named, or one a fidelity."""
    panels = len(plan.frequency) if _few(plan) else len(plan.fidelities)
    return (2.9 * panels + 0.8 if panels > 1 else 5.8, 4.2)


def draw(figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw bars at few frequencies, lines over many; the mean (order 0) is in the numbers alone."""
    units = units_for(result, plan.output)
    grid = (_bar_panels if _few(plan) else _line_panels)(figure, result, plan, shown, units)
    heights = [sheet["harmonic"][sheet["order"] > 0] * units.length_factor for sheet in shown if not sheet.fault]
    decades(grid[0], heights)
    grid[0].set_ylabel(motion_of(plan.output, "amplitude", units))


def _few(plan: ShowPlan) -> bool:
    return len(plan.frequency) <= FEW


def _bar_panels(
    figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...], units: DisplayUnits
) -> Any:
    """Draw a panel a frequency, bars side by side for the fidelities."""
    grid = figure.subplots(1, len(plan.frequency), sharey=True, squeeze=False)[0]
    width = 0.8 / len(plan.fidelities) / (plan.own["subdivision"] or 1)
    for axes, frequency in zip(grid, plan.frequency, strict=True):
        titled(axes, units, frequency)
        for sheet, look in sheets_at(result.case, frequency, plan, shown):
            shift = plan.fidelities.index(sheet.fidelity) - (len(plan.fidelities) - 1) / 2
            height, label = sheet["harmonic"][1:] * units.length_factor, name_of(result.case, sheet.fidelity)
            axes.bar(sheet["order"][1:] + shift * width, height, width, label=label, **bar(look))
        labelled(axes, "multiple of the drive frequency", "", across=True)
        faults_at(result.case, frequency, plan, shown, axes)
    return grid


def _line_panels(
    figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...], units: DisplayUnits
) -> Any:
    """Draw a panel a fidelity, a line an order."""
    grid = figure.subplots(1, len(plan.fidelities), sharey=True, squeeze=False)[0]
    for axes, name in zip(grid, plan.fidelities, strict=True):
        axes.set_title(plain(name_of(result.case, name)))
        _lines(axes, [sheet for sheet in shown if sheet.fidelity == name and not sheet.fault], units)
        across_frequency(axes, units)
        if is_empty(axes):
            say(axes, "no motion at any frequency")
    return grid


def _lines(axes: Axes, sheets: list[Sheet], units: DisplayUnits) -> None:
    """Draw each order where it is above round-off."""
    if not sheets:
        return
    across = np.array([sheet.frequency for sheet in sheets]) * units.frequency_factor
    for index, order in enumerate(sheets[0]["order"]):
        if order:
            height = np.array([sheet["harmonic"][index] for sheet in sheets])
            keys = style(index - 1).keys(0.9) | ({"marker": "o", "markersize": 2.4} if len(across) < MARKED else {})
            axes.plot(across, height * units.length_factor, label=f"{order:g} Ω", **keys)
