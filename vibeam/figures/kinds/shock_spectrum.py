"""Figure kind ``shock_spectrum``: largest responses to a record over natural frequency.

Of equipment, oscillators mounted at the output of each fidelity, beside those on the base itself; or of the device: the
case's own structure, its natural frequencies all multiplied so that the lowest is the one across, with its stop and
without.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from vibeam.case.case import Case, plan_of_record
from vibeam.case.plans import ShowPlan
from vibeam.figures import SHOCKED
from vibeam.figures.panels import is_empty, labelled, say
from vibeam.figures.record import RecordResult, record_motion, unit_of_signal
from vibeam.figures.sheet import Column, Columns, Sheet, sheet_of
from vibeam.figures.style import GAP, looks_of, name_of
from vibeam.flight.shock_spectrum import shock_spectrum, without_stops
from vibeam.observe.shock_spectrum import ShockSpectrum
from vibeam_models.arrays import Array

CALLED = {
    "acceleration": "largest absolute acceleration",
    "pseudo_velocity": "largest pseudo-velocity",
    "displacement": "largest relative displacement",
}
BELOW, ABOVE = 0.1, {"equipment": 100.0, "device": 10.0}  # natural frequencies where none are given, in the lowest
A_DECADE = 30  # of these
FEW = 12  # points below which each is marked


def sheets(case: Case, fidelity: str, plan: ShowPlan) -> list[Sheet]:
    """One sheet, over natural frequency."""
    return [sheet_of(fidelity, lambda: (_of_device if _is_device(plan) else _of_equipment)(case, fidelity, plan))]


def _is_device(plan: ShowPlan) -> bool:
    return bool(plan.own["response_of"] == "device")


def _of_equipment(case: Case, name: str, plan: ShowPlan) -> Columns:
    path, damping = record_motion(case, name, plan), plan.own["equipment_damping"]
    rates, record = _natural(path.system.omega, plan), path.drive
    columns = _columns(rates, shock_spectrum(path, rates, damping, output=plan.output), "shock", "equipment")
    if record.quantity == "acceleration":
        columns |= _columns(rates, shock_spectrum(record, rates, damping), "base", "equipment on the base itself")
    return columns


def _of_device(case: Case, name: str, plan: ShowPlan) -> Columns:
    system, record = case.system(name), case.input(name, *plan_of_record(case).seeds[:1])
    rates = _natural(system.omega, plan)
    held = shock_spectrum(record, rates, device=system, output=plan.output)
    free = shock_spectrum(record, rates, device=without_stops(system, record), output=plan.output)
    assert held.impacts is not None
    assert held.impact_velocity is not None
    return _columns(rates, held, "shock", "device") | _columns(rates, free, "free", "device without its stop") | {
        "shock_impacts": Column(held.impacts.astype(float), "1", "number of impacts"),
        "shock_impact_velocity": Column(held.impact_velocity, "c/s", "largest velocity just before an impact"),
    }  # fmt: skip


def _natural(omega: Array, plan: ShowPlan) -> Array:
    """Natural frequencies, Hz: the table's, or from a tenth of the fidelity's lowest on."""
    given = plan.own["natural"]
    lowest, top = float(np.min(omega)) / (2 * np.pi), ABOVE["device" if _is_device(plan) else "equipment"]
    points = 1 + round(A_DECADE * np.log10(top / BELOW))
    return np.geomspace(BELOW * lowest, top * lowest, points) if given is None else np.array(given, ndmin=1)


def _columns(rates: Array, found: ShockSpectrum, prefix: str, whose: str) -> dict[str, Column]:
    known = {f"{prefix}_{q}": Column(found.of(q), SHOCKED[q], f"{CALLED[q]} of the {whose}") for q in SHOCKED}
    return {"natural": Column(rates, "Hz", "natural frequency")} | known


def size(plan: ShowPlan) -> tuple[float, float]:
    """One panel, or two where impacts are shown."""
    return (6.4, 6.2 if _is_device(plan) else 4.4)


def draw(figure: Figure, result: RecordResult, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw the spectra; of a device a second panel with the velocity of its hardest impact."""
    case, known = result.case, [each for each in shown if not each.fault]
    measure = plan.own["measure"] or ("displacement" if _is_device(plan) else "acceleration")
    panels = figure.subplots(2 if _is_device(plan) else 1, 1, sharex=True, squeeze=False)[:, 0]
    upper, looks = panels[0], looks_of(case, plan.fidelities)
    top = max((float(np.max(each[f"shock_{measure}"], initial=0.0)) for each in known), default=0.0)
    unit, factor = unit_of_signal(case, SHOCKED[measure], top)
    _base(upper, known, measure, factor)
    for sheet in known:
        look, label = looks[sheet.fidelity], name_of(case, sheet.fidelity)
        marked = {"marker": "o", "markersize": 3.0} if len(sheet["natural"]) < FEW else {}
        upper.plot(sheet["natural"], sheet[f"shock_{measure}"] * factor, label=label, **(look.keys(1.6) | marked))
        if _is_device(plan):
            keys: dict[str, Any] = look.keys(0.9) | {"linestyle": ":", "label": f"{label}, without stop"}
            upper.plot(sheet["natural"], sheet[f"free_{measure}"] * factor, **keys)
    labelled(upper, CALLED[measure], unit)
    if _is_device(plan):
        _gap(upper, case, plan, measure, factor)
        _impacts(panels[1], case, known, looks)
    for axes in panels:
        _decades(axes, shown)
    labelled(
        panels[-1],
        "lowest natural frequency" if _is_device(plan) else "natural frequency of the equipment",
        "Hz",
        across=True,
    )


def _base(axes: Axes, known: list[Sheet], measure: str, factor: float) -> None:
    """Draw the input's own spectrum, the same for all fidelities, once."""
    own = next((each for each in known if f"base_{measure}" in each.columns), None)
    if own is not None:
        keys: dict[str, Any] = {"color": "0.6", "linewidth": 2.4, "zorder": 1.5, "label": "on the base"}
        axes.plot(own["natural"], own[f"base_{measure}"] * factor, **keys)


def _gap(axes: Axes, case: Case, plan: ShowPlan, measure: str, factor: float) -> None:
    """Mark the gap, where the output is the contact's displacement."""
    gap = abs(case.system(plan.fidelities[0]).gap)
    if plan.output == "contact" and measure == "displacement" and gap > 0:
        axes.axhline(gap * factor, label="gap", **GAP)


def _impacts(axes: Axes, case: Case, known: list[Sheet], looks: Any) -> None:
    """Draw the velocity of the hardest impact."""
    top = max((float(np.max(each["shock_impact_velocity"], initial=0.0)) for each in known), default=0.0)
    unit, factor = unit_of_signal(case, "m s-1", top)
    for sheet in known:
        upward = np.where(sheet["shock_impacts"] > 0, sheet["shock_impact_velocity"] * factor, np.nan)
        axes.plot(sheet["natural"], upward, label=name_of(case, sheet.fidelity), **looks[sheet.fidelity].keys(1.6))
    labelled(axes, "hardest impact", unit)


def _decades(axes: Axes, shown: tuple[Sheet, ...]) -> None:
    if is_empty(axes):
        say(axes, next((each.fault for each in shown if each.fault), "no impact at any natural frequency"))
        return
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.grid(visible=True, which="both", linewidth=0.3, color="0.9")


def caption(plan: ShowPlan) -> str:
    """Caption of the figure."""
    if _is_device(plan):
        return "maximax spectrum of the scaled device; dotted: without its stop"
    ratio = 0.05 if plan.own["equipment_damping"] is None else plan.own["equipment_damping"]
    return f"maximax spectrum of equipment at the {plan.output}, damping ratio {ratio:g}"
