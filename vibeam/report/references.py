"""References beside the model: one panel each, missed points marked, the registered curve dashed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import ceil
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from vibeam.case.case import Case
from vibeam.case.plans import Reference
from vibeam.figures.page import blank_page, legend, plain, titled
from vibeam.figures.panels import from_zero
from vibeam.figures.style import COLOURS, shade
from vibeam.figures.units import DisplayUnits, frequency_label, units_of_branches, with_unit
from vibeam.studies.regression.references import COVERAGE, CheckRow, Match, matched, pieces_of
from vibeam.system.response import Branches

POINT: dict[str, Any] = {
    "linestyle": "",
    "marker": "o",
    "markersize": 3.0,
    "color": "black",
    "markerfacecolor": "white",
}

MISSED: dict[str, Any] = POINT | {"color": COLOURS[1], "markerfacecolor": COLOURS[1]}
MOVED: dict[str, Any] = {"color": "0.35", "linestyle": (0, (4, 1.6)), "linewidth": 0.9, "zorder": 2.4}
SHOWN = 150  # points drawn of a reference, at most


def references_figure(case: Case, rows: Sequence[CheckRow], at: Mapping[str, Branches]) -> Figure:
    """One panel a reference: branches ``at`` it, points with twice their uncertainty, those that are missed."""
    shown = {row.reference: row for row in rows if row.reference in case.references}
    columns = 1 if len(shown) == 1 else 2
    lines = ceil(len(shown) / columns)
    figure = blank_page((5.8, 4.2) if len(shown) == 1 else (3.6 * columns, 2.5 * lines + 0.8), case.figure)
    grid = figure.subplots(lines, columns, squeeze=False)
    for spare in grid.flat[len(shown) :]:
        spare.set_axis_off()
    units, drawn = units_of_branches(case, at.values()), dict[str, Line2D]()
    for axes, (name, row) in zip(grid.flat, shown.items(), strict=False):
        _panel(axes, case.references[name], row, (at[name], units), drawn)
    titled(figure, case.figure, case.title, "references and model")
    legend(figure, drawn)
    return figure


def _panel(
    axes: Axes, reference: Reference, row: CheckRow, of: tuple[Branches, DisplayUnits], drawn: dict[str, Line2D]
) -> None:
    branches, units = of
    factor, unit = _unit(reference, units)
    matches = list(matched(reference, reference.points(), branches))
    for direction, _ in branches.items():
        look: dict[str, Any] = {"color": shade(COLOURS[0], direction), "linewidth": 1.2 if direction == "up" else 2.4}
        drawn[f"model, {direction}"] = Line2D([], [], **look)
        for frequency, value in pieces_of(branches, direction, reference.quantity):
            axes.plot(frequency * units.frequency_factor, value * factor, **look)
    if row.registration is not None and row.registration.separable:
        _moved(axes, reference, row, (branches, units, factor))
        drawn["model without its shift and amplitude error"] = Line2D([], [], **MOVED)
    for missed, marks in ((False, POINT), (True, MISSED)):
        own = [each for each in matches if each.point.value is not None and (each.excess > 1) == missed]
        judged = missed and reference.tolerance is not None
        _points(axes, own, marks if judged else POINT, (units.frequency_factor, factor))
        if own:
            drawn["reference, missed" if judged else "reference"] = Line2D([], [], **(marks if judged else POINT))
    axes.set_xlabel(frequency_label(units))
    axes.set_ylabel(with_unit(reference.quantity.replace("_", " "), unit))
    verdict = {True: "passed", False: "missed", None: "compared"}[row.passed]
    axes.set_title(plain(f"{reference.name}, {reference.fidelity}: {verdict}"), loc="left")
    if reference.quantity in ("amplitude", "reach"):
        from_zero(axes)


def _unit(reference: Reference, units: DisplayUnits) -> tuple[float, str]:
    """Factor and unit of a quantity's axis."""
    if reference.quantity == "impact_velocity":
        return units.speed_factor, units.speed
    plainly = reference.quantity in ("period", "impacts_per_period")
    return (1.0, "") if plainly else (units.length_factor, units.length)


def _moved(axes: Axes, reference: Reference, row: CheckRow, of: tuple[Branches, DisplayUnits, float]) -> None:
    assert row.registration is not None
    branches, units, factor = of
    over = units.frequency_factor / (1 + row.registration.shift)
    up = factor / (1 + row.registration.amplitude)
    for direction, _ in branches.items():
        for frequency, value in pieces_of(branches, direction, reference.quantity):
            axes.plot(frequency * over, value * up, **MOVED)


def _points(axes: Axes, matches: Sequence[Match], look: Mapping[str, Any], factors: tuple[float, float]) -> None:
    every = ceil(len(matches) / SHOWN) or 1
    points = [each.point for each in matches[::every]]
    frequency = np.array([point.frequency for point in points]) * factors[0]
    value = np.array([point.value for point in points], dtype=float) * factors[1]
    spread = np.array([np.nan if p.uncertainty is None else p.uncertainty for p in points]) * factors[1] * COVERAGE
    axes.errorbar(frequency, value, spread, elinewidth=0.6, zorder=5, **look)
