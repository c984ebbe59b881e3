"""Waterfall of spectra: one line a value of the axis, each above the one before, over multiples of the drive."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from vibeam.figures.page import plain
from vibeam.figures.style import COLOURS, name_of
from vibeam.figures.units import amplitude_of, units_of
from vibeam.maps.run import MapResult
from vibeam.maps.spectra import LineSpectrum, spectra_along
from vibeam.report.maps.labels import shown_axis

HIGHEST = 6.0  # multiples of the drive frequency shown
DECADES = 4.0  # below the largest line
HEIGHT = 4.0  # of the largest line, in distances between spectra


def size_of(result: MapResult) -> tuple[float, float]:
    """A panel for each fidelity and way, beside each other."""
    count = sum(len(each.ways) for each in result.responses.values())
    return max(5.4, 3.2 * count + 0.6), 5.6


def spectra(figure: Figure, result: MapResult, exact: bool) -> tuple[list[Any], list[str]]:
    """Draw a panel for each fidelity and way; no legend, notes."""
    shown = [(name, way) for name, response in result.responses.items() for way in range(len(response.ways))]
    grid = figure.subplots(1, len(shown), sharex=True, sharey=True, squeeze=False)[0]
    across = shown_axis(result.case, result.plan.axes[0])
    every = {place: spectra_along(result, *place) for place in shown}
    largest = max(
        (float(each.amplitude.max()) for lines in every.values() for each in lines if len(each.order)), default=1
    )
    for axes, ((name, way), lines) in zip(grid, every.items(), strict=True):
        _waterfall(axes, lines, largest or 1.0, across.factor)
        axes.set_title(plain(f"{name_of(result.case, name)}, {result[name].ways[way]}"))
        axes.set_xlabel("frequency over drive frequency")
    grid[0].set_ylabel(across.label)
    units = units_of(result.case, length=largest)
    said = amplitude_of(result.plan.output, units).replace(", ½(max − min)", "")
    return [], [
        f"lines: {said}, logarithmic, {DECADES:g} decades below {largest * units.length_factor:.3g} {units.length}"
    ]


def _waterfall(axes: Axes, lines: list[LineSpectrum], largest: float, factor: float) -> None:
    """Draw the spectra from the back, the last value, to the front, each covering what is behind it."""
    values = np.array([each.value for each in lines]) * factor
    step = float(np.ptp(values)) / max(len(values) - 1, 1) or 1.0
    for depth, each in enumerate(sorted(lines, key=lambda line: -line.value)):
        inside = each.order <= HIGHEST
        level = np.log10(np.maximum(each.amplitude[inside], largest * 10**-DECADES) / largest) / DECADES + 1
        base = each.value * factor
        axes.fill_between(
            each.order[inside], base, base + HEIGHT * step * level, facecolor="white", edgecolor=COLOURS[0],
            linewidth=0.5, zorder=2 + depth * 1e-3,
        )  # fmt: skip
    axes.set_xlim(0, HIGHEST)
    axes.set_ylim(values.min() - step, values.max() + (HEIGHT + 1) * step)
