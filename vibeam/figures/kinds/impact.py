"""Figure kind ``impact``: what contact and mode keep of their velocities in one collision (``solvers.collision``)."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from vibeam.case.case import Case
from vibeam.case.plans import ShowPlan
from vibeam.figures.panels import is_empty, labelled, say
from vibeam.figures.sheet import Column, Columns, Comparison, Sheet, sheet_of
from vibeam.figures.style import look, looks_of, name_of
from vibeam.figures.units import units_for
from vibeam.observe.restitution import Collision
from vibeam.solvers.collision import struck
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.number_text import ratio
from vibeam_models.arrays import Array

caption = "one collision: what the contact and the mode that strikes keep of their velocity"


def sheets(case: Case, fidelity: str, plan: ShowPlan) -> list[Sheet]:
    """One sheet, by velocity."""
    return [sheet_of(fidelity, lambda: _columns(case.system(fidelity), np.array(plan.own["velocity"])))]


def _columns(system: ImpactSystem, velocity: Array) -> Columns:
    found = [struck(system, float(speed)) for speed in velocity]
    highest = float(np.max(system.omega)) / (2 * np.pi)
    time = np.array([each.duration for each in found])
    return {
        "velocity": Column(velocity, "c/s", "velocity of the contact at first touch"),
        "true_restitution": Column(_all(found, "restitution"), "1", "−v⁺/v⁻ of the contact"),
        "first_mode_restitution": Column(_all(found, "mode_restitution"), "1", "−η'⁺/η'⁻ of the mode that struck"),
        "energy_restitution": Column(_all(found, "energy_restitution"), "1", "√(E⁺/E⁻) of all modes"),
        "mode_share": Column(_all(found, "mode_share"), "1", "share of E⁺ in the mode that struck"),
        "contact_time": Column(time, "s", "duration of the first touch"),
        "contact_force": Column(_all(found, "force"), "N", "largest force of the first touch"),
        "touches": Column(_all(found, "touches"), "1", "touches of the collision"),
        "contact_periods": Column(time * highest, "1", "duration in periods of the highest mode, f_N t_c"),
        "modes": Column(np.array([float(system.size)]), "1", "number of modes"),
    }


def _all(found: list[Collision], name: str) -> Array:
    return np.array([float(getattr(each, name)) for each in found])


def size(plan: ShowPlan) -> tuple[float, float]:
    """Two panels over the velocity, one over the number of modes."""
    return (9.6, 3.8) if len(plan.fidelities) > 1 else (6.6, 3.8)


def draw(figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw restitution and contact time over velocity, and restitution over the number of modes where they differ."""
    case, units = result.case, units_for(result, "contact")
    there = [sheet for sheet in shown if not sheet.fault]
    numbers = {float(sheet["modes"][0]) for sheet in there}
    kept, lasted, *counted = figure.subplots(1, 3 if len(numbers) > 1 else 2)
    looks = looks_of(case, plan.fidelities)
    for sheet in there:
        keys, speeds = looks[sheet.fidelity].keys(1.0), sheet["velocity"] * units.speed_factor
        kept.plot(speeds, sheet["first_mode_restitution"], label=name_of(case, sheet.fidelity), **keys)
        kept.plot(speeds, sheet["true_restitution"], **keys | {"linestyle": "", "marker": "o", "markersize": 2.5})
        if np.any(sheet["contact_time"] > 0):
            lasted.plot(speeds, sheet["contact_time"] * (1e3 if units.frequency else units.time_factor), **keys)
    if is_empty(lasted):
        say(lasted, "no stop here yields")
    for axes in counted:
        _draw_modes(axes, case, there)
    for axes in (kept, lasted):
        axes.set_xscale("log")
        labelled(axes, "impact velocity", units.speed, across=True)
    labelled(kept, "restitution of the mode –, of the contact •", "")
    labelled(lasted, "contact time" if units.frequency else "contact time ω t", "ms" if units.frequency else "")


def _draw_modes(axes: Axes, case: Case, shown: list[Sheet]) -> None:
    """Draw the mode's restitution over the number of modes, a line a contact law, its range over velocity as a bar."""
    laws: dict[str, list[Sheet]] = {}
    for sheet in sorted(shown, key=lambda sheet: float(sheet["modes"][0])):
        laws.setdefault(_law(case.system(sheet.fidelity)), []).append(sheet)
    drawn = []
    for place, own in enumerate(laws.values()):
        values = [sheet["first_mode_restitution"] for sheet in own]
        low, middle, high = np.transpose([(np.min(each), np.median(each), np.max(each)) for each in values])
        counts, keys = [float(sheet["modes"][0]) for sheet in own], look(place).keys(1.0)
        spread = [middle - low, high - middle]
        drawn.append(axes.errorbar(counts, middle, yerr=spread, marker="o", markersize=3, capsize=2, **keys))
    axes.legend(drawn, list(laws), frameon=False)
    axes.set_xscale("log", base=2)
    axes.xaxis.set_major_formatter("{x:g}")
    labelled(axes, "number of modes", "", across=True)
    labelled(axes, "restitution of the mode", "")


def _law(system: ImpactSystem) -> str:
    return f"R = {ratio(system.restitution, 'g')}" if system.law is None else system.law.name
