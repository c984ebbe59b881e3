"""Figure kind ``participation``: the modes' shares in energy, displacement, velocity and impulse."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from vibeam.case.case import Case
from vibeam.case.plans import ShowPlan
from vibeam.figures import SHARES
from vibeam.figures.panels import decades, faults_at, labelled, sheets_at, titled
from vibeam.figures.settled_motion import exact_motion, settled
from vibeam.figures.sheet import Column, Columns, Comparison, Sheet
from vibeam.figures.style import bar, name_of
from vibeam.figures.units import units_for
from vibeam.observe.harmonics import modal_participation

PERIODS = 16

MEANING = {
    "energy_share": "share of the time-mean energy",
    "displacement_share": "share of the mean square displacement of the output",
    "velocity_share": "share of the mean square velocity of the output",
    "impulse_share": "share of an impulse's velocity change at the contact, c²/S",
}

LEAST = 1e-6  # smallest share drawn


def columns(case: Case, name: str, frequency: float, plan: ShowPlan) -> Columns:
    """Shares of the modes at one ``frequency``, Hz."""
    periods = plan.periods or PERIODS
    path = exact_motion(settled(case, name, frequency, plan), periods)
    found = modal_participation(path, plan.output, periods=periods)
    order = np.argsort(found.frequency)
    return {
        "mode": Column(np.arange(1.0, len(order) + 1), "1", "number of the mode, by frequency"),
        "mode_frequency": Column(found.frequency[order], "Hz", "natural frequency of the mode"),
        "energy": Column(found.energy[order], "E", "time-mean energy of the mode"),
        **{share: Column(getattr(found, share)[order], "1", MEANING[share]) for share in SHARES},
    }


def size(plan: ShowPlan) -> tuple[float, float]:
    """One row a share, one column a frequency."""
    return (2.6 * len(plan.frequency) + 2.6, 6.4)


def draw(figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw bars side by side for the fidelities, on a logarithmic scale."""
    case, units = result.case, units_for(result, plan.output)
    grid = figure.subplots(len(SHARES), len(plan.frequency), sharex=True, sharey=True, squeeze=False)
    width = 0.8 / len(plan.fidelities)
    for column, frequency in enumerate(plan.frequency):
        titled(grid[0, column], units, frequency)
        for sheet, look in sheets_at(case, frequency, plan, shown):
            shift = plan.fidelities.index(sheet.fidelity) - (len(plan.fidelities) - 1) / 2
            for axes, share in zip(grid[:, column], SHARES, strict=True):
                label = name_of(case, sheet.fidelity)
                axes.bar(sheet["mode"] + shift * width, sheet[share], width, label=label, **bar(look))
        for axes in grid[:, column]:
            faults_at(case, frequency, plan, shown, axes)
        labelled(grid[-1, column], "mode", "", across=True)
    grid[0, 0].xaxis.set_major_locator(MaxNLocator(8, integer=True, min_n_ticks=1))
    decades(grid[0, 0], [sheet[share] for sheet in shown if not sheet.fault for share in SHARES], least=LEAST)
    for axes, share in zip(grid[:, 0], SHARES, strict=True):
        labelled(axes, share.removesuffix("_share"), "share")
