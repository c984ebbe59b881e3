"""Figure kind ``boundaries``: existence limits over the sweep (``solvers.existence_limits``; paper eq. 24, 26).

Averaging's are drawn beside the exact ones; beside Q* the reach of the motions, beside Δ_MAX the gap.
"""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from vibeam.case.case import Case
from vibeam.case.plans import ShowPlan
from vibeam.extensions.paper.existence_limits import limits as numbers
from vibeam.figures.panels import across_frequency, from_zero, is_empty, labelled, say
from vibeam.figures.sheet import Column, Comparison, Sheet
from vibeam.figures.style import FEW, GAP, STABLE, UNSTABLE, Look, arrow, looks_of, name_of
from vibeam.figures.units import DisplayUnits, units_for
from vibeam.observe.branches import motion_pieces
from vibeam.periodic.modal_sums import fault
from vibeam.system.impact_system import ImpactSystem

CURE = "name other fidelities, or omit the table; vibeam.follow follows a motion along the gap or the drive"
CALLED = {"least_stable_reach": "least stable reach Q* of the contact", "largest_gap": "largest |gap| Δ_MAX"}


def sheets(case: Case, fidelity: str, plan: ShowPlan) -> list[Sheet]:
    """One sheet over the sweep's frequencies; NaN where the motion has no such limit."""
    frequency, quantity = np.array(plan.frequency), plan.quantity or ""
    columns = {
        "frequency": Column(frequency, "Hz", "drive frequency, Ω/2π"),
        "value": Column(numbers(case, fidelity, frequency, quantity), "c", CALLED[quantity]),
    }
    return [Sheet(fidelity, float("nan"), columns)]


def refusal(case: Case, fidelity: str, system: ImpactSystem) -> str:
    """Why a fidelity of this ``system`` has no such limit at all; empty where it may have one."""
    if case.fidelities[fidelity].solver == "averaging":
        return ""
    if system.beyond_plain:
        return f"no closed form of the folds knows {' or '.join(system.beyond_plain)}: {CURE}"
    return fault(system)


def draw(figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw the limit over frequency."""
    case, units, axes = result.case, units_for(result, "contact"), figure.subplots()
    looks = looks_of(case, plan.fidelities)
    for sheet in shown:
        averaged = case.fidelities[sheet.fidelity].solver == "averaging"
        across, upward = sheet["frequency"] * units.frequency_factor, sheet["value"] * units.length_factor
        keys = looks[sheet.fidelity].keys() | ({"marker": "o", "markersize": 3.5} if len(across) <= FEW else {})
        without = "" if np.isfinite(upward).any() else ": no such limit at any frequency"
        label = f"{name_of(case, sheet.fidelity)}{', averaged' if averaged else ''}{without}"
        axes.plot(across, upward, label=label, **keys)
        _motions(axes, result, sheet.fidelity, plan.quantity or "", looks[sheet.fidelity], units)
    from_zero(axes)
    if is_empty(axes):
        say(axes, "no such limit at any frequency")
    across_frequency(axes, units)
    labelled(axes, CALLED[plan.quantity or ""], units.length)


def _motions(axes: Axes, result: Comparison, name: str, quantity: str, look: Look, units: DisplayUnits) -> None:
    """Draw what the limit is one of: the gap, or the reach of all known motions, else of the swept ones as dots."""
    if quantity == "largest_gap":
        height = abs(result.case.system(name).gap) * units.length_factor
        axes.axhline(height, label="|gap| of the case", **(GAP | {"color": look.colour}))
        return
    curves, called = result[name].curves, f"{name_of(result.case, name)}, reach"
    for each in [] if curves is None else motion_pieces(curves, "reach"):
        keys = (STABLE if each.stable else UNSTABLE) | {"color": look.colour, "linewidth": 0.6}
        keys |= {"label": called if each.stable else f"{called}, unstable"}
        axes.plot(each.frequency * units.frequency_factor, each.amplitude * units.length_factor, **keys)
    for direction, response in result[name].items() if curves is None else ():
        keys = arrow(direction, look.colour) | {"markersize": 2.4, "label": f"{called}, sweep {direction}"}
        upward = np.where(response.impacts_per_period > 0, response.reach, np.nan)
        axes.plot(response.frequency * units.frequency_factor, upward * units.length_factor, **keys)


def caption(plan: ShowPlan) -> str:
    """Caption of the figure."""
    return f"{CALLED[plan.quantity or '']}: averaging's beside the exact one"
