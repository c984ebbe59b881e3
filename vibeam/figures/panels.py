"""Common parts of the figures: titles, axis labels, looks of the fidelities, mark of the stop."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.lines import Line2D

from vibeam.case.case import quantity_of
from vibeam.figures.axes import is_empty, say
from vibeam.figures.outputs import frequency_label, with_unit
from vibeam.figures.sheet import Sheet
from vibeam.figures.style import GAP, Look, looks_of, name_of
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from vibeam.case.case import Case
    from vibeam.case.plans import ShowPlan
    from vibeam.figures.units import DisplayUnits


def means(sheets: Sequence[Sheet], column: str) -> tuple[Array, Array, Array]:
    """Frequencies (Hz), mean and standard deviation of a column's finite entries, NaN where there are none."""
    rows = []
    for sheet in sheets:
        values = sheet.of(column)
        values = values[np.isfinite(values)]
        rows.append((sheet.frequency, *((np.mean(values), np.std(values)) if len(values) else (np.nan, np.nan))))
    frequency, mean, spread = np.array(sorted(rows), dtype=float).reshape(-1, 3).T
    return frequency, mean, spread


def drawn(axes: Axes, sheets: Sequence[Sheet], column: str, factor: float, across: float, **look: Any) -> bool:
    """Draw the mean of a column over frequency, its spread between impacts as a band; False without data."""
    frequency, mean, spread = means(sheets, column)
    if not np.isfinite(mean).any():
        return False
    marks: dict[str, Any] = {"marker": "o", "markersize": 2.4} if len(frequency) < 40 else {}
    marks["linewidth"] = 1.0
    axes.plot(frequency * across, mean * factor, **(marks | look))
    axes.fill_between(
        frequency * across, (mean - spread) * factor, (mean + spread) * factor, color=look["color"], alpha=0.15,
        linewidth=0,
    )  # fmt: skip
    return True


def across_frequency(axes: Axes, units: DisplayUnits) -> None:
    """Label the frequency axis."""
    axes.set_xlabel(frequency_label(units))


STOP = "stop"  # legend entry of the stop
FAR = 3.0  # distance, in largest displacements, beyond which a stop is not drawn


def titled(axes: Axes, units: DisplayUnits, frequency: float) -> None:
    """Title a panel with its frequency (Hz)."""
    number = f"{frequency * units.frequency_factor:.5g}"
    axes.set_title(f"{number} {units.frequency}" if units.frequency else f"Ω/ω = {number}")


def labelled(axes: Axes, what: str, unit: str, across: bool = False) -> None:
    """Label an axis with its unit, the one across or the one upward."""
    (axes.set_xlabel if across else axes.set_ylabel)(with_unit(what, unit))


def sheets_at(case: Case, frequency: float, plan: ShowPlan, shown: Sequence[Sheet]) -> list[tuple[Sheet, Look]]:
    """Sheets of one frequency (Hz) that have numbers, in the plan's order, with the looks of their fidelities."""
    sheets = {sheet.fidelity: sheet for sheet in reversed(shown) if sheet.frequency == frequency and not sheet.fault}
    looks = looks_of(case, plan.fidelities)
    return [(sheets[name], looks[name]) for name in plan.fidelities if name in sheets]


def faults_at(case: Case, frequency: float, plan: ShowPlan, shown: Sequence[Sheet], axes: Axes) -> None:
    """Note in an empty panel of one frequency (Hz) why there is no motion."""
    faults = {sheet.fault: None for sheet in shown if sheet.frequency == frequency and sheet.fault}
    if is_empty(axes):
        say(axes, "\n".join(faults) or "nothing to show")


def name_faults(case: Case, plan: ShowPlan, shown: Sequence[Sheet]) -> dict[str, Any]:
    """Legend entries of fidelities without a motion at some frequencies: where, unless everywhere, and why."""
    looks = looks_of(case, plan.fidelities)
    found: dict[str, Any] = {}
    for name in plan.fidelities:
        own = [sheet for sheet in shown if sheet.fidelity == name]
        for fault in dict.fromkeys(sheet.fault for sheet in own if sheet.fault):
            some = sum(sheet.fault == fault for sheet in own)
            where = "" if some == len(own) else f" at {some} of {len(own)} frequencies"
            handle = Line2D([], [], **looks[name].keys())
            found[f"{name_of(case, name)}{where}: {fault}"] = handle
    return found


def stop_at(case: Case, plan: ShowPlan) -> list[float]:
    """Output displacement at contact with the stop, each value once; none where modes leave it undetermined."""
    found = set()
    for name in plan.fidelities if not quantity_of(case, plan.output).rate else ():
        system = case.system(name)
        row = system.output(plan.output)
        if system.size == 1:
            found.add(float(system.gap * row[0] / system.contact[0]))
        elif plan.output == "contact":
            found.add(float(system.gap))
    return sorted(found)


def mark_stop(case: Case, plan: ShowPlan, shown: Sequence[Sheet], mark: Any, axes: Axes, factor: float) -> None:
    """Draw the stop by ``mark`` (axhline or axvline), unless it is so far away that the motion would look flat."""
    largest = max((float(np.abs(sheet["displacement"]).max()) for sheet in shown if not sheet.fault), default=0.0)
    places = stop_at(case, plan)
    near = [place for place in places if largest == 0 or abs(place) <= FAR * largest]
    for place in near:
        mark(place * factor, label=STOP, **GAP)
    if len(near) < len(places):
        axes.plot([], [], label=f"{STOP}: beyond the figure", **GAP)
