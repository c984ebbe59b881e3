"""Figure kind ``boundaries``: existence limits by averaging beside the exact folds (paper eq. 24, 26).

At each frequency of the sweep, for an averaging fidelity: Q*, the least stable reach at the fidelity's gap, or Δ_MAX,
the largest gap, loose or tight, at its drive; beside Q* the reach of its motions, beside Δ_MAX its gap. For any other
fidelity the exact ones: both are folds of the orbit
with one impact a drive period, Q* its reach where it folds as the drive grows weaker, Δ_MAX the gap at which it folds.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.plans import ShowPlan
from vibeam.figures.axes import from_zero, is_empty, say
from vibeam.figures.branches import motion_pieces
from vibeam.figures.panels import across_frequency, labelled
from vibeam.figures.sheet import Column, Sheet
from vibeam.figures.style import FEW, GAP, STABLE, UNSTABLE, Look, arrow, looks_of, name_of
from vibeam.figures.units import Units, units_for
from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.boundaries import Boundary, boundaries
from vibeam.periodic.modal_sums import fault
from vibeam.periodic.orbit import orbits
from vibeam.solvers.averaging.solver import slow_flow
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from vibeam.case.case import Case
    from vibeam.figures.comparison import Comparison


Options = Mapping[str, str | float]
BESIDE = 1e-6  # step off a fold, as a share of the drive: the mean of both roots there is its reach
STRONGER = 1e3  # upper end of the search for the weakest drive with orbits, in multiples of the case's drive
CURE = "name other fidelities, or leave the table away"
CALLED = {"least_stable_reach": "least stable reach Q* of the contact", "largest_gap": "largest |gap| Δ_MAX"}


def sheets(case: Case, fidelity: str, plan: ShowPlan) -> list[Sheet]:
    """One sheet over the sweep's frequencies; NaN where the motion has no such limit."""
    frequency, quantity = np.array(plan.frequency), plan.quantity or ""
    columns = {
        "frequency": Column(frequency, "Hz", "drive frequency, Ω/2π"),
        "value": Column(limits(case, fidelity, frequency, quantity), "c", CALLED[quantity]),
    }
    return [Sheet(fidelity, float("nan"), columns)]


def refusal(case: Case, fidelity: str, system: ImpactSystem) -> str:
    """Why a fidelity of this ``system`` has no such limit at all; empty where it may have one."""
    if case.fidelities[fidelity].solver == "averaging":
        return ""
    if system.beyond_plain:
        return f"no closed form of the folds knows {' or '.join(system.beyond_plain)}: {CURE}"
    return fault(system)


def limits(case: Case, fidelity: str, frequency: Array, quantity: str) -> Array:
    """Limit (points,) of one fidelity at ``frequency`` (points,) Hz, NaN where the motion has none."""
    system, omegas = case.system(fidelity), 2 * np.pi * frequency
    amplitudes = np.broadcast_to(case.amplitude_of(fidelity, omegas), omegas.shape)
    averaged = case.fidelities[fidelity].solver == "averaging"
    found = (_averaged if averaged else _exact)(system, amplitudes, omegas, quantity, case.fidelities[fidelity].options)
    return np.asarray(found, dtype=float)


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


def _motions(axes: Axes, result: Comparison, name: str, quantity: str, look: Look, units: Units) -> None:
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


def _averaged(system: ImpactSystem, amplitudes: Array, omegas: Array, quantity: str, options: Options) -> Array:
    chosen: dict[str, Any] = {key: options[key] for key in ("resonance", "damping") if key in options}
    found = []
    for amplitude, omega in zip(amplitudes, omegas, strict=True):
        flow, unit = slow_flow(system, float(amplitude), **chosen)
        limit = flow.largest_gap if quantity == "largest_gap" else flow.least_stable
        found.append(limit(float(omega) / unit))
    values = np.array(found)
    return np.where(values > 0, values, np.nan)


def _exact(system: ImpactSystem, amplitudes: Array, omegas: Array, quantity: str, options: Options) -> Array:
    periods = int(str(options.get("periods", 1)))
    limit = _gap_at_fold if quantity == "largest_gap" else _reach_at_fold
    drives = zip(amplitudes, omegas, strict=True)
    return np.array([limit(system, float(amplitude), float(omega), periods) for amplitude, omega in drives])


def _gap_at_fold(system: ImpactSystem, amplitude: float, omega: float, periods: int) -> float:
    far = 100 * amplitude * float(np.abs(system.contact @ system.load))
    folds = boundaries(system, amplitude, omega, periods, gap=(-far, far), points=1001, kinds=(Kind.FOLD,))
    return max((abs(fold.gap) for fold in folds if fold.clear), default=float("nan"))


def _reach_at_fold(system: ImpactSystem, amplitude: float, omega: float, periods: int) -> float:
    # the motion scales with drive and gap together, so that the weakest drive may lie anywhere
    for most in (amplitude, STRONGER * amplitude):
        folds = boundaries(system, (most * 1e-4, most), omega, periods, points=2001, kinds=(Kind.FOLD,))
        if folds and folds[0].clear:
            return _reach(system, folds[0], omega)
    return float("nan")


def _reach(system: ImpactSystem, fold: Boundary, omega: float) -> float:
    found = orbits(system, Drive(omega, fold.amplitude * (1 + BESIDE)), fold.periods)
    return float(np.mean([orbit.reach for orbit in found])) if len(found) == 2 else float("nan")
