"""Figure of an uncertainty study: bands on the curves above the sensitivity of the finest one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.plans import FigurePlan
from vibeam.figures.page import blank_page, legend, titled
from vibeam.figures.style import look, looks_of, name_of
from vibeam.figures.units import DisplayUnits, amplitude_of, frequency_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from vibeam.studies.uncertainty.study import UncertaintyStudy


def bands(study: UncertaintyStudy, units: DisplayUnits, plan: FigurePlan) -> Figure:
    """Bands on the curve of each fidelity above the total indices of the finest one's amplitude."""
    figure = blank_page((7.0, 6.0), plan)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[2, 1])
    _draw_bands(study, upper, units)
    frequency = study.frequency * units.frequency_factor
    for place, each in enumerate(study.uncertain):
        keys = look(len(study.rows) + place).keys(1.2)  # no colour of a fidelity
        lower.plot(frequency, study.over_frequency.total[place], label=f"total index of {each.key}", **keys)
    totals = study.over_frequency.total
    low, high = (float(bound(totals[np.isfinite(totals)], initial=edge)) for bound, edge in ((np.min, 0), (np.max, 1)))
    lower.set_ylim(low - 0.05 * (low < 0), high + 0.05)  # scatter of samples passes 0 and 1
    lower.set_ylabel("share of the variance")
    lower.set_xlabel(frequency_label(units))
    caption = (
        f"nine of ten (light) and half (dark) of {study.finest.samples} samples; dashed ends: of the other fidelities"
    )
    titled(figure, plan, study.case.title, caption)
    handles = [each for axes in (upper, lower) for each in axes.get_legend_handles_labels()[0]]
    legend(figure, handles, [str(each.get_label()) for each in handles])
    return figure


def _draw_bands(study: UncertaintyStudy, axes: Axes, units: DisplayUnits) -> None:
    frequency = study.frequency * units.frequency_factor
    own = looks_of(study.case, [row.fidelity for row in study.rows])
    for row in study.rows:
        edges, colour = row.bands * units.length_factor, own[row.fidelity].colour
        label = name_of(study.case, row.fidelity)
        if row is study.finest:
            axes.fill_between(frequency, edges[0], edges[-1], color=colour, alpha=0.18, linewidth=0)
            axes.fill_between(frequency, edges[1], edges[-2], color=colour, alpha=0.30, linewidth=0)
        else:
            for edge in (edges[0], edges[-1]):
                axes.plot(frequency, edge, color=colour, linewidth=0.7, linestyle=(0, (3, 2)))
        axes.plot(frequency, row.nominal * units.length_factor, label=label, **own[row.fidelity].keys(1.2))
    axes.set_ylim(bottom=0)
    axes.set_ylabel(amplitude_of(study.case.sweep.output, units))
