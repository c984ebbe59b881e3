"""Figure kind ``ringing``: ringing between impacts, by a fitted damped sinusoid and by counted peaks (paper Fig. 27).

Both read the same record: the fit its displacement, beside the modes above; the count its velocity, as the paper does,
after the slow part is taken off (Fig. 27c, drawn where the figure has one frequency).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

from vibeam.case.case import Case
from vibeam.case.plans import ShowPlan
from vibeam.figures.panels import (
    across_frequency,
    drawn,
    faults_at,
    from_zero,
    is_empty,
    labelled,
    say,
    sheets_at,
    titled,
)
from vibeam.figures.settled_motion import MeasuredWindow, chain_or_exact, measured_window
from vibeam.figures.sheet import Column, Columns, Comparison, NoMotion, Sheet
from vibeam.figures.style import looks_of, name_of
from vibeam.figures.units import motion_of, units_for
from vibeam.observe.ringing import REACH, CountedPeaks, count_peaks, fast_part, fit_ringing, peaks_of
from vibeam.observe.slow_motion import SlowPart, slow_part
from vibeam_models.arrays import Array

PERIODS = 12
SAMPLES = 48  # samples a period of the ringing, of a motion that is not measured
GUARD = 0.2  # periods of the ringing left out next to impacts, where faster modes and the filter still act
PROMINENCE = 0.2  # prominence of a counted peak, as a share of the range
APART = 0.7  # periods of the ringing between two counted peaks, at least: of several in noise the highest is meant


def columns(case: Case, name: str, frequency: float, plan: ShowPlan) -> Columns:
    """Frequency and size of what rings at one ``frequency``, Hz."""
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
    rate = replace(slow, degree=-1)  # a constant has none
    counted = count_peaks(
        record.time, record.velocity, shown, rate, guard=guard, prominence=PROMINENCE, apart=APART / near
    )  # fmt: skip
    return {
        "begin": Column(fit.begin - found.begin, "s", "begin of the interval, the drive's phase 0 at 0"),
        "ringing_frequency": Column(fit.frequency, "Hz", "fitted frequency of the damped ringing"),
        "ringing_decay": Column(fit.decay, "s-1", "fitted decay"),
        "ringing_displacement": Column(fit.mean_displacement, "q", "mean peak displacement of the ringing"),
        "ringing_velocity": Column(fit.mean_velocity, "q/s", "mean peak velocity of the ringing"),
        "first_displacement": Column(fit.displacement, "q", "peak displacement at the interval's begin"),
        "first_velocity": Column(fit.velocity, "q/s", "peak velocity at the interval's begin"),
        "residual": Column(fit.residual, "q", "rms of what is left"),
        **_counted(counted),
        **_first_interval(found, shown, rate, near),
    }


def _counted(counted: CountedPeaks) -> Columns:
    read = counted.frequency[np.isfinite(counted.frequency)]
    scatter = np.std(read) if len(read) > 1 else np.nan
    return {
        "counted_frequency": Column(counted.frequency, "Hz", "inverse of the mean time between counted velocity peaks"),
        "counted_scatter": Column(np.array([scatter]), "Hz", "standard deviation of it between intervals"),
        "counted_velocity": Column(counted.height, "q/s", "mean of the counted velocity peaks"),
    }


def _first_interval(found: MeasuredWindow, shown: Array, rate: SlowPart, near: float) -> Columns:
    """Velocity less its slow part over the first interval, and the peaks counted there."""
    intervals = fast_part(found.record.time, found.record.velocity, shown, rate, guard=GUARD / near)
    time, velocity = intervals[0] if intervals else (np.empty(0), np.empty(0))
    top = peaks_of(time, velocity, PROMINENCE, APART / near) if len(time) else np.empty(0, dtype=np.int64)
    clock = time - time[:1]
    return {
        "fast_time": Column(clock, "s", "time in the first interval"),
        "fast_velocity": Column(velocity, "q/s", "velocity there, less its slow part"),
        "peak_time": Column(clock[top], "s", "times of the peaks counted there"),
        "peak_velocity": Column(velocity[top], "q/s", "velocities of these peaks"),
    }


def size(plan: ShowPlan) -> tuple[float, float]:
    """Two panels, one above the other; one where the figure has one frequency."""
    return (5.8, 3.6 if len(plan.frequency) == 1 else 5.4)


def draw(figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw what rings over frequency, or over time where there is one frequency."""
    if len(plan.frequency) == 1:
        _draw_interval(figure, result, plan, shown)
    else:
        _draw_frequencies(figure, result, plan, shown)


def _draw_interval(figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw the velocity less its slow part over the first interval, a dot at each counted peak."""
    case, units, axes = result.case, units_for(result, plan.output), figure.subplots()
    titled(axes, units, plan.frequency[0])
    for sheet, look in sheets_at(case, plan.frequency[0], plan, shown):
        lines = {"fast": look.keys(1.0) | {"label": name_of(case, sheet.fidelity)}}
        lines["peak"] = {"color": look.colour, "linestyle": "", "marker": "o", "markersize": 3}
        for part, keys in lines.items():
            turns = sheet[f"{part}_time"] * plan.frequency[0]
            axes.plot(turns, sheet[f"{part}_velocity"] * units.speed_factor, **keys)
    faults_at(case, plan.frequency[0], plan, shown, axes)
    axes.axhline(0.0, color="0.6", linewidth=0.5, zorder=1)
    axes.set_xlabel("drive periods since the begin of the interval")
    labelled(axes, f"{motion_of(plan.output, 'velocity', units)}, less its slow part", "")


def _draw_frequencies(figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw frequency above, peak velocity below, on the right as displacement; fitted solid, counted dashed."""
    case, units = result.case, units_for(result, plan.output)
    upper, lower = figure.subplots(2, 1, sharex=True)
    right = lower.twinx()
    factor, speed = units.frequency_factor, units.speed_factor
    for name, look in looks_of(case, plan.fidelities).items():
        own, counted = [sheet for sheet in shown if sheet.fidelity == name], {"linestyle": "--", "marker": ""}
        counted["color"] = look.colour
        drawn(upper, own, "ringing_frequency", factor, factor, label=name_of(case, name), **look.keys())
        drawn(upper, own, "counted_frequency", factor, factor, **counted)
        drawn(lower, own, "ringing_velocity", speed, factor, **look.keys())
        drawn(lower, own, "counted_velocity", speed, factor, **counted)
        drawn(right, own, "ringing_displacement", units.length_factor, factor, **counted | {"linestyle": ":"})
    for axes in (lower, right):
        from_zero(axes)
    for axes in (upper, lower):
        if is_empty(axes):
            say(axes, "nothing rings at any frequency")
    labelled(upper, "ringing: fitted –, counted - -", units.frequency)
    lower.set_ylabel(f"{motion_of(plan.output, 'velocity', units)},\nmean peak: fitted –, counted - -")
    right.set_ylabel(f"{motion_of(plan.output, 'displacement', units)},\nmean peak ···")
    across_frequency(lower, units)


def caption(plan: ShowPlan) -> str:
    """Caption of the figure."""
    if len(plan.frequency) == 1:
        return "what rings between two impacts, and the peaks counted"
    return "frequency and size of what rings between impacts"
