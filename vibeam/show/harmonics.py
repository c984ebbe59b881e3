"""The kind ``harmonics``: amplitudes of the output at multiples of the drive frequency (paper Fig. 20).

Frequencies that the table names are drawn as bars, a panel each; without, the orders are lines over the sweep's. Each
frequency begins at static equilibrium.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vibeam.observe.harmonics import harmonic_amplitudes
from vibeam.report.style import COLOURS
from vibeam.report.units import units_of
from vibeam.show.motion import exact_motion, settled, sheet_each
from vibeam.show.over import across_frequency
from vibeam.show.panels import labelled, sheets_at, titled
from vibeam.show.plan import Column, Columns, Sheet, ShowPlan

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from vibeam.case import Case
    from vibeam.report.units import Units
    from vibeam.result import Result

HIGHEST = 8
PERIODS = 8  # times the subdivision
FEW = 12  # frequencies that are drawn as bars
STYLES = ("-", "--", "-.", ":")


def sheets(case: Case, fidelity: str, plan: ShowPlan) -> list[Sheet]:
    """One a frequency."""
    return sheet_each(plan, fidelity, lambda frequency: _columns(case, fidelity, frequency, plan))


def _columns(case: Case, name: str, frequency: float, plan: ShowPlan) -> Columns:
    parts = plan.subdivision or 1
    periods = plan.periods or PERIODS * parts
    path = exact_motion(settled(case, name, frequency, plan), periods)
    found = harmonic_amplitudes(
        path, plan.output, periods=periods, highest=plan.highest or HIGHEST, subdivision=parts
    )  # fmt: skip
    return {
        "order": Column(found.order, "1", "multiple of the drive frequency"),
        "harmonic": Column(np.abs(found.amplitude), "q", "amplitude, of order 0 the mean's size"),
        "phase": Column(np.angle(found.amplitude), "1", "phase before the drive's, rad, x = Re Σ X e^{ikΩt}"),
    }


def size(plan: ShowPlan) -> tuple[float, float]:
    """A panel for each frequency that is named, or one a fidelity."""
    panels = len(plan.frequency) if _few(plan) else len(plan.fidelities)
    return (2.9 * panels + 0.8 if panels > 1 else 5.8, 4.2)


def draw(figure: Figure, result: Result, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Bars at few frequencies, lines over many; the mean (order 0) is in the numbers alone."""
    units = units_of(result.case)
    if _few(plan):
        grid = figure.subplots(1, len(plan.frequency), sharey=True, squeeze=False)[0]
        for axes, frequency in zip(grid, plan.frequency, strict=True):
            titled(axes, units, frequency)
            _bars(axes, sheets_at(frequency, plan, shown), plan, units)
            labelled(axes, "multiple of the drive frequency", "", across=True)
    else:
        grid = figure.subplots(1, len(plan.fidelities), sharey=True, squeeze=False)[0]
        for axes, name in zip(grid, plan.fidelities, strict=True):
            axes.set_title(name)
            _lines(axes, [sheet for sheet in shown if sheet.fidelity == name and not sheet.fault], units)
            across_frequency(axes, units)
    grid[0].set_yscale("log")
    labelled(grid[0], "amplitude", units.length)


def _few(plan: ShowPlan) -> bool:
    return len(plan.frequency) <= FEW


def _bars(axes: Axes, sheets: list[tuple[Sheet, str]], plan: ShowPlan, units: Units) -> None:
    width = 0.8 / len(plan.fidelities) / (plan.subdivision or 1)
    for index, (sheet, colour) in enumerate(sheets):
        order, height = sheet.of("order")[1:], sheet.of("harmonic")[1:]
        place = order + (index - (len(sheets) - 1) / 2) * width
        axes.bar(place, height * units.length_factor, width, color=colour, label=sheet.label)


def _lines(axes: Axes, sheets: list[Sheet], units: Units) -> None:
    if not sheets:
        return
    across = np.array([sheet.frequency for sheet in sheets]) * units.frequency_factor
    for index, order in enumerate(sheets[0]["order"]):
        if order:
            height = np.array([sheet["harmonic"][index] for sheet in sheets])
            colour = COLOURS[index % len(COLOURS)]
            style = STYLES[index // len(COLOURS) % len(STYLES)]
            axes.plot(across, height * units.length_factor, style, color=colour, linewidth=0.9, label=f"{order:g} Ω")
