"""The kind ``curve``: another quantity of the frequency-response curve than its amplitude."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from vibeam.report.curve import Kind, pieces
from vibeam.report.style import coloured, line
from vibeam.report.units import rates_of, units_of
from vibeam.show.over import across_frequency
from vibeam.show.panels import labelled
from vibeam.show.plan import Sheet, ShowPlan

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vibeam.case import Case
    from vibeam.result import Result

LENGTHS = ("amplitude", "reach", "maximum", "minimum")
CALLED = {
    "reach": "reach Q = Δ − min q",
    "impact_velocity": "mean impact velocity",
    "impacts_per_period": "impacts a drive period",
    "period": "period (0: none, −1: no contact)",
}


def sheets(case: Case, fidelity: str, plan: ShowPlan) -> list[Sheet]:
    """None: the sweep has them."""
    return []


def draw(figure: Figure, result: Result, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """All fidelities on the same axes, drawn as in the frequency-response curve."""
    units, rate, name = units_of(result.case), rates_of(result.case), plan.quantity or "amplitude"
    unit, factor = (units.length, units.length_factor) if name in LENGTHS else ("", 1.0)
    unit, factor = (rate.name, rate.factor) if name == "impact_velocity" else (unit, factor)
    axes = figure.subplots()
    for fidelity, colour in coloured(plan.fidelities):
        axes.plot([], [], color=colour, label=fidelity)
        for direction, response in result[fidelity].items():
            seen = replace(response, amplitude=np.asarray(getattr(response, name), dtype=float))
            for piece in pieces(seen):
                if piece.kind is not Kind.FAILED:
                    look = line(piece.kind, direction, colour, len(piece.frequency))
                    axes.plot(piece.frequency * units.frequency_factor, piece.amplitude * factor, **look)
    across_frequency(axes, units)
    labelled(axes, CALLED.get(name, name), unit)
