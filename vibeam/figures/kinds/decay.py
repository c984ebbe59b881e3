"""Figure kind ``decay``: free motion without drive and stop, from rest in a static deflection (paper Fig. 30a–b).

The beam is drawn aside at the contact until the output is by ``start`` beside its place at rest, from which
displacements are counted, and let go. What is read is what the paper reads: the damping ratio off the envelope, here
the slope of the logarithms of the maxima over time, and the frequency off the times of the maxima and off the highest
line of the spectrum, refined by a parabola through its neighbours. Both slopes are weighted by the maxima's heights, so
that noise on the low ones counts for as much as it is.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.case.plans import ShowPlan
from vibeam.case.response_quantities import static_shape
from vibeam.figures.axes import decades, is_empty, say
from vibeam.figures.outputs import motion_of
from vibeam.figures.panels import labelled
from vibeam.figures.settled_motion import chain_or_exact
from vibeam.figures.sheet import Column, Columns, Sheet
from vibeam.figures.style import Look, looks_of, name_of
from vibeam.figures.units import DisplayUnits, units_of
from vibeam.flight.trajectory import simulate
from vibeam.observe.harmonics import spectrum_of
from vibeam.observe.measuring_chain import MeasuredRecord, measure
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from vibeam.case.case import Case
    from vibeam.figures.comparison import Comparison


PERIODS = 40  # of the mode that the output shows most
SAMPLES = 256  # samples a natural period, of a motion that is not measured
AWAY = 1e3  # gap, in contact displacements at the start, of a stop that is not there
LEAST = 3  # maxima for an envelope
LEAST_LINE = 1e-7  # smallest line shown, as a share of the largest displacement
SHOWN = 4  # largest frequency shown, in multiples of the mode's


def sheets(case: Case, fidelity: str, plan: ShowPlan) -> list[Sheet]:
    """One sheet."""
    try:
        return [Sheet(fidelity, float("nan"), _columns(case, fidelity, plan))]
    except ValueError as reason:  # of an observer: too few samples
        return [Sheet(fidelity, float("nan"), fault=str(reason))]


def _columns(case: Case, name: str, plan: ShowPlan) -> Columns:
    record, natural = _record(case, name, plan)
    time, height = maxima(record, natural)
    slope, level = np.polyfit(time, np.log(height), 1, w=height)
    turns = np.round((time - time[0]) * natural)
    rate = 2 * np.pi / float(np.polyfit(turns, time, 1, w=height)[0])
    spectrum = spectrum_of(record.time, record.displacement)
    return {
        "time": Column(record.time, "s", "time since the release"),
        "displacement": Column(record.displacement, "q", "displacement of the output from its place at rest"),
        "envelope": Column(np.exp(level + slope * record.time), "q", "fitted envelope"),
        "line": Column(spectrum.frequency, "Hz", "frequency of the line"),
        "displacement_line": Column(spectrum.amplitude, "q", "amplitude of the displacement"),
        "decay_frequency": Column(np.array([rate / (2 * np.pi)]), "Hz", "frequency by the maxima"),
        "decay_damping": Column(np.array([-slope / np.hypot(slope, rate)]), "1", "damping ratio by the envelope"),
        "spectrum_frequency": Column(
            np.array([highest_line(spectrum.frequency, spectrum.amplitude)]), "Hz", "frequency of the highest line"
        ),
    }


def _record(case: Case, name: str, plan: ShowPlan) -> tuple[MeasuredRecord, float]:
    """Record of the free motion, and the natural frequency (Hz) of the mode that the output shows most."""
    system = case.system(name)
    shape = static_shape(system, system.contact)
    row = system.output(plan.output)
    place = shape * (plan.start or 0.0) / float(row @ shape)
    omega = float(system.omega[int(np.argmax(np.abs(row * place)))])
    span = (plan.periods or PERIODS) * 2 * np.pi / omega
    rest = static_shape(system, system.static)
    path = simulate(without_stop(system, place, rest), Drive(omega, 0.0), span, State(rest + place, 0 * place))
    record = measure(path, chain_or_exact(case, name, SAMPLES * omega / (2 * np.pi)), plan.output)
    return replace(record, displacement=record.displacement - float(row @ rest)), omega / (2 * np.pi)


def without_stop(system: ImpactSystem, place: Array, rest: Array) -> ImpactSystem:
    """System whose stop is out of reach of a free motion from ``place`` beside its place at ``rest``."""
    far = AWAY * float(np.abs(system.contact) @ (np.abs(place) + np.abs(rest)))
    return replace(system, gap=far, law=None, second_gap=None)


def maxima(record: MeasuredRecord, natural: float) -> tuple[Array, Array]:
    """Times and heights of the maxima, one a natural period, by parabolas; ValueError for fewer than three."""
    from scipy.signal import find_peaks

    x = record.displacement
    top = find_peaks(x, distance=max(1, round(0.6 * record.rate / natural)))[0]
    top = top[x[top] > 0]
    if len(top) < LEAST:
        raise ValueError(f"{len(top)} maxima are too few for an envelope: show more periods")
    shift, height = _vertex(x, top)
    return record.time[top] + shift / record.rate, height


def highest_line(frequency: Array, amplitude: Array) -> float:
    """Frequency of the highest line, refined by a parabola through the logarithms of its neighbours."""
    top = 1 + int(np.argmax(amplitude[1:-1]))
    shift, _ = _vertex(np.log(np.maximum(amplitude, 1e-300)), np.array([top]))
    return float(frequency[top] + shift[0] * (frequency[1] - frequency[0]))


def _vertex(values: Array, at: NDArray[np.int64]) -> tuple[Array, Array]:
    """Place (in steps from ``at``) and height of the vertex of the parabola through three neighbours."""
    left, middle, right = values[at - 1], values[at], values[at + 1]
    bend = left - 2 * middle + right
    shift = (left - right) / (2 * bend)
    return shift, middle - (left - right) * shift / 4


def size(plan: ShowPlan) -> tuple[float, float]:
    """Motion beside spectrum."""
    return (7.6, 3.6)


def draw(figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw the motion with its envelope beside the spectrum."""
    case, there = result.case, [sheet for sheet in shown if not sheet.fault]
    largest = max((float(np.abs(sheet["displacement"]).max()) for sheet in there), default=float("nan"))
    units, looks = units_of(case, largest), looks_of(case, plan.fidelities)
    motion, spectrum = figure.subplots(1, 2)
    for sheet in there:
        _draw_one(motion, spectrum, sheet, looks[sheet.fidelity], units, name_of(case, sheet.fidelity))
    for axes in (motion, spectrum):
        if is_empty(axes):
            say(axes, "no decay to show")
    lines = [sheet["displacement_line"] * units.length_factor for sheet in there]
    decades(spectrum, lines, least=LEAST_LINE * largest * units.length_factor)
    motion.set_xlabel("time (s)" if units.frequency else "time")
    motion.set_ylabel(motion_of(plan.output, "displacement", units))
    labelled(spectrum, "frequency", units.frequency, across=True)


def _draw_one(motion: Axes, spectrum: Axes, sheet: Sheet, look: Look, units: DisplayUnits, name: str) -> None:
    time, factor = sheet["time"], units.length_factor
    motion.plot(time, sheet["displacement"] * factor, label=name, **look.keys(0.8))
    for side in (1.0, -1.0):
        motion.plot(time, side * sheet["envelope"] * factor, linestyle=":", linewidth=0.8, color=look.colour)
    inside = (sheet["line"] > 0) & (sheet["line"] <= SHOWN * sheet["decay_frequency"][0])
    across = sheet["line"][inside] * units.frequency_factor
    spectrum.plot(across, sheet["displacement_line"][inside] * factor, **look.keys(0.8))
