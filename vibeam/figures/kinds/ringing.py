"""Figure kind ``ringing``: ringing between impacts, by a fitted damped sinusoid and by counted peaks (paper Fig. 27).

Both read the same record, the fit beside the modes above, the counting after the slow part is taken off. Sizes are the
means of the fitted envelope over an interval between impacts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.plans import ShowPlan
from vibeam.figures.axes import from_zero, is_empty, say
from vibeam.figures.outputs import motion_of
from vibeam.figures.panels import across_frequency, drawn, labelled
from vibeam.figures.settled_motion import MeasuredWindow, NoMotion, chain_or_exact, measured_window, sheet_each
from vibeam.figures.sheet import Column, Columns, Sheet
from vibeam.figures.style import looks_of, name_of
from vibeam.figures.units import units_for
from vibeam.observe.ringing import REACH, count_peaks, fit_ringing
from vibeam.observe.slow_motion import SlowPart, slow_part

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vibeam.case.case import Case
    from vibeam.figures.comparison import Comparison


PERIODS = 12

SAMPLES = 48  # samples a period of the ringing, of a motion that is not measured

GUARD = 0.2  # periods of the ringing left out next to impacts, where faster modes and the filter still act

PROMINENCE = 0.2  # prominence of a counted peak, as a share of the range


def sheets(case: Case, fidelity: str, plan: ShowPlan) -> list[Sheet]:
    """One sheet a frequency."""
    return sheet_each(plan, fidelity, lambda frequency: _columns(case, fidelity, frequency, plan))


def _columns(case: Case, name: str, frequency: float, plan: ShowPlan) -> Columns:
    near = plan.near or 0.0
    found = measured_window(
        case, name, frequency, plan, plan.periods or PERIODS, chain_or_exact(case, name, SAMPLES * near)
    )
    omega = np.sort(found.path.system.omega) / (2 * np.pi)
    below, above = int(np.sum(omega < near / REACH)), int(np.sum(omega > near * REACH))
    if below + above == len(omega):
        raise NoMotion(f"no mode near {near:g} Hz that could ring")
    if not len(found.hits):
        raise NoMotion("no impacts: nothing rings between them")
    return _read(found, slow_part(found.path.system, found.path.drive, below), near, min(above, 1))


def _read(found: MeasuredWindow, slow: SlowPart, near: float, further: int) -> Columns:
    record, shown = found.record, found.hits[:, 0] + found.delay
    guard = GUARD / near
    fit = fit_ringing(
        record.time, record.displacement, shown, slow, near=near, further=further, guard=guard
    )  # fmt: skip
    counted = count_peaks(record.time, record.displacement, shown, slow, guard=guard, prominence=PROMINENCE)
    return {
        "begin": Column(fit.begin - found.begin, "s", "begin of the interval, the drive's phase 0 at 0"),
        "ringing_frequency": Column(fit.frequency, "Hz", "fitted frequency of the damped ringing"),
        "counted_frequency": Column(counted.frequency, "Hz", "frequency from the first to the last counted peak"),
        "ringing_decay": Column(fit.decay, "s-1", "fitted decay"),
        "ringing_displacement": Column(fit.mean_displacement, "q", "mean peak displacement of the ringing"),
        "ringing_velocity": Column(fit.mean_velocity, "q/s", "mean peak velocity of the ringing"),
        "first_displacement": Column(fit.displacement, "q", "peak displacement at the interval's begin"),
        "first_velocity": Column(fit.velocity, "q/s", "peak velocity at the interval's begin"),
        "residual": Column(fit.residual, "q", "rms of what is left"),
    }


def size(plan: ShowPlan) -> tuple[float, float]:
    """Two panels, one above the other."""
    return (5.8, 5.4)


def draw(figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw frequency above, fitted solid and counted dashed; peak velocity below, on the right as displacement."""
    case, units = result.case, units_for(result)
    upper, lower = figure.subplots(2, 1, sharex=True)
    right = lower.twinx()
    factor = units.frequency_factor
    for name, look in looks_of(case, plan.fidelities).items():
        own, colour = [sheet for sheet in shown if sheet.fidelity == name], look.colour
        drawn(upper, own, "ringing_frequency", factor, factor, label=name_of(case, name), **look.keys())
        drawn(upper, own, "counted_frequency", factor, factor, color=colour, linestyle="--", marker="")
        drawn(lower, own, "ringing_velocity", units.speed_factor, factor, **look.keys())
        drawn(right, own, "ringing_displacement", units.length_factor, factor, color=colour, linestyle=":", marker="")
    for axes in (lower, right):
        from_zero(axes)
    for axes in (upper, lower):
        if is_empty(axes):
            say(axes, "nothing rings at any frequency")
    labelled(upper, "ringing: fitted –, counted - -", units.frequency)
    lower.set_ylabel(f"{motion_of(plan.output, 'velocity', units)},\nmean peak –")
    right.set_ylabel(f"{motion_of(plan.output, 'displacement', units)},\nmean peak ···")
    across_frequency(lower, units)


def caption(plan: ShowPlan) -> str:
    """Caption of the figure."""
    return "frequency and size of what rings between impacts"
