"""Figure kind ``coordinates``: motion of one mode in physical and in transformed coordinates (paper Fig. 5–6).

With the side ±1 of z, which changes at every impact, and K = (1 − R)/(1 + R):

    Zhuravlev:  q = Δ − |z|, q̇ = −ż sgn z,                            ż jumps at an impact by (1 − R) q̇₋  (eq. 4–9)
    Ivanov:     q = Δ − |z|, q̇ = −K_N s sgn z, K_N = 1 − K sgn(zs),   s does not jump                     (eq. 11–13)

while q̇ jumps by (1 + R) q̇₋ (eq. 3). A fidelity by ``ivanov`` is shown in Ivanov's coordinates, any other in
Zhuravlev's.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from vibeam.case.case import Case
from vibeam.case.plans import ShowPlan
from vibeam.figures.panels import faults_at, mark_stop, sheets_at, titled
from vibeam.figures.settled_motion import exact_columns, settled
from vibeam.figures.sheet import Column, Columns, Comparison, NoMotion, Sheet
from vibeam.figures.style import Look, name_of
from vibeam.figures.units import DisplayUnits, motion_of, units_for
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array

PERIODS = 3
ROUNDING = 1e-13
TRANSFORMED: dict[str, Any] = {"linestyle": (0, (4, 1.4)), "linewidth": 1.0}


def columns(case: Case, name: str, frequency: float, plan: ShowPlan) -> Columns:
    """Motion of the contact in both coordinates at one ``frequency``, Hz."""
    begin = settled(case, name, frequency, replace(plan, output="contact"))
    if begin.system.size != 1:
        raise NoMotion(f"one mode alone has these coordinates, this model has {begin.system.size}")
    begin.system.require_plain("coordinates")
    found = exact_columns(begin, plan.periods or PERIODS, "contact")
    rows = {each: found[each].values for each in ("time", "displacement", "velocity", "impact_time")}
    first = _first_after(rows["time"], rows["impact_time"])
    ivanov = case.fidelities[name].solver == "ivanov"
    place, rate = transformed(begin.system, rows["displacement"], rows["velocity"], first, ivanov)
    struck = np.abs(found["impact_velocity"].values)
    inside = first < len(rows["time"])
    return dict(found) | {
        "unfolded": Column(place, "c", "unfolded displacement z"),
        "unfolded_velocity": Column(rate, "c/s", "Zhuravlev's ż, or Ivanov's s"),
        "physical_jump": Column(_jumps(rows["velocity"], first, inside) / struck[inside], "1", "jump of q̇ over |q̇₋|"),
        "unfolded_jump": Column(_jumps(rate, first, inside) / struck[inside], "1", "jump of ż or s over |q̇₋|"),
    }


def transformed(
    system: ImpactSystem, displacement: Array, velocity: Array, first: NDArray[np.int64], ivanov: bool
) -> tuple[Array, Array]:
    """Displacement z and velocity ż, or Ivanov's s, of a contact's motion (m,); ``first``: sample after each impact."""
    turns = np.zeros(len(displacement) + 1, dtype=int)
    np.add.at(turns, first, 1)
    side = (-1.0) ** np.cumsum(turns)[:-1]
    k = (1 - system.restitution) / (1 + system.restitution) if ivanov else 0.0
    return side * (system.gap - displacement), -side * velocity / (1 + k * np.sign(velocity))


def _first_after(time: Array, struck: Array) -> NDArray[np.int64]:
    """Index of the first sample after each impact, of which one of two at the same time is the second."""
    index = np.searchsorted(time, struck * (1 - ROUNDING))
    following = time[np.minimum(index + 1, len(time) - 1)]
    return np.minimum(index + (following <= struck * (1 + ROUNDING)), len(time))


def _jumps(rate: Array, first: NDArray[np.int64], inside: NDArray[np.bool_]) -> Array:
    return np.asarray(np.abs(rate[first[inside]] - rate[first[inside] - 1]))


def size(plan: ShowPlan) -> tuple[float, float]:
    """One column a frequency."""
    return (max(5.8, 3.2 * len(plan.frequency) + 0.6), 7.4)


def draw(figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw displacement and velocity over time above the portrait, a column a frequency."""
    case, units = result.case, units_for(result, "contact")
    rows, contact = {"height_ratios": (1.0, 1.0, 1.6)}, replace(plan, output="contact")
    grid = figure.subplots(3, len(plan.frequency), sharey="row", squeeze=False, gridspec_kw=rows)
    for column, frequency in enumerate(plan.frequency):
        titled(grid[0, column], units, frequency)
        for sheet, look in sheets_at(case, frequency, plan, shown):
            _draw_one(grid[:, column], sheet, look, units, name_of(case, sheet.fidelity))
        for axes in grid[:, column]:
            faults_at(case, frequency, plan, shown, axes)
        mark_stop(case, contact, shown, grid[0, column].axhline, grid[0, column], units.length_factor)
        mark_stop(case, contact, shown, grid[2, column].axvline, grid[2, column], units.length_factor)
        grid[1, column].set_xlabel("time in drive periods")
        grid[2, column].set_xlabel(motion_of("contact", "displacement q or z", units))
    grid[0, 0].set_ylabel(motion_of("contact", "displacement", units))
    for row in (1, 2):
        grid[row, 0].set_ylabel(motion_of("contact", "velocity", units))


def _draw_one(panels: Any, sheet: Sheet, look: Look, units: DisplayUnits, name: str) -> None:
    turns, plain = sheet["time"] * sheet.frequency, look.keys(0.9)
    for kind, keys in (("", plain), ("unfolded_", {"color": look.colour, **TRANSFORMED})):
        place = sheet["unfolded" if kind else "displacement"] * units.length_factor
        rate = sheet[f"{kind}velocity"] * units.speed_factor
        panels[0].plot(turns, place, label=f"{name}, {'transformed' if kind else 'physical'}", **keys)
        panels[1].plot(turns, rate, **keys)
        panels[2].plot(place, rate, **keys)
