"""Figure kind ``decay``: free motion without drive and stop, from rest in a static deflection (paper Fig. 30a–b).

The beam is drawn aside at the contact until the output is by ``start`` beside its place at rest, from which
displacements are counted, and let go. What is read off it is in ``observe.decay``.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from vibeam.case.case import Case, quantity_of
from vibeam.case.plans import ShowPlan
from vibeam.case.response_quantities import static_shape
from vibeam.figures.panels import decades, is_empty, labelled, say
from vibeam.figures.settled_motion import chain_or_exact
from vibeam.figures.sheet import Column, Columns, Comparison, NoMotion, Sheet, sheet_of
from vibeam.figures.style import Look, looks_of, name_of
from vibeam.figures.units import DisplayUnits, motion_of, units_of
from vibeam.flight.trajectory import simulate
from vibeam.observe.decay import free_decay
from vibeam.observe.measuring_chain import MeasuredRecord, measure
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State
from vibeam_models.arrays import Array

PERIODS = 40  # of the mode that the output shows most
SAMPLES = 256  # samples a natural period, of a motion that is not measured
AWAY = 1e3  # gap, in contact displacements at the start, of a stop that is not there
LEAST_LINE = 1e-7  # smallest line shown, as a share of the largest displacement
SHOWN = 4  # largest frequency shown, in multiples of the mode's
size = (7.6, 3.6)  # inches: motion beside spectrum


def sheets(case: Case, fidelity: str, plan: ShowPlan) -> list[Sheet]:
    """One sheet."""
    return [sheet_of(fidelity, lambda: _columns(case, fidelity, plan))]


def _columns(case: Case, name: str, plan: ShowPlan) -> Columns:
    record, natural = _record(case, name, plan)
    found = free_decay(record, natural)
    return {
        "time": Column(record.time, "s", "time since the release"),
        "displacement": Column(record.displacement, "q", "displacement of the output from its place at rest"),
        "envelope": Column(found.envelope, "q", "fitted envelope"),
        "line": Column(found.spectrum.frequency, "Hz", "frequency of the line"),
        "displacement_line": Column(found.spectrum.amplitude, "q", "amplitude of the displacement"),
        "decay_frequency": Column(np.array([found.frequency]), "Hz", "frequency by the maxima"),
        "decay_damping": Column(np.array([found.damping_ratio]), "1", "damping ratio by the envelope"),
        "spectrum_frequency": Column(np.array([found.line]), "Hz", "frequency of the highest line"),
    }


def _record(case: Case, name: str, plan: ShowPlan) -> tuple[MeasuredRecord, float]:
    """Record of the free motion, and the natural frequency (Hz) of the mode that the output shows most."""
    system = case.system(name)
    row, shape = system.output(plan.output), static_shape(system, system.contact)
    place = shape * plan.own["start"] / float(row @ shape)
    omega = float(system.omega[int(np.argmax(np.abs(row * place)))])
    if not omega > 0:
        raise NoMotion("a free body has no static deflection to be let go from")
    span = (plan.periods or PERIODS) * 2 * np.pi / omega
    rest = static_shape(system, system.static)
    path = simulate(without_stop(system, place, rest), Drive(omega, 0.0), span, State(rest + place, 0 * place))
    record = measure(path, chain_or_exact(case, name, SAMPLES * omega / (2 * np.pi)), plan.output)
    return replace(record, displacement=record.displacement - float(row @ rest)), omega / (2 * np.pi)


def without_stop(system: ImpactSystem, place: Array, rest: Array) -> ImpactSystem:
    """System whose stop is out of reach of a free motion from ``place`` beside its place at ``rest``."""
    far = AWAY * float(np.abs(system.contact) @ (np.abs(place) + np.abs(rest)))
    return replace(system, gap=far, law=None, second_gap=None)


def draw(figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw the motion with its envelope beside the spectrum."""
    case, there = result.case, [sheet for sheet in shown if not sheet.fault]
    largest = max((float(np.abs(sheet["displacement"]).max()) for sheet in there), default=float("nan"))
    units = units_of(case, largest, quantity=quantity_of(case, plan.output).name)
    looks = looks_of(case, plan.fidelities)
    motion, spectrum = figure.subplots(1, 2)
    for sheet in there:
        _draw_one(motion, spectrum, sheet, looks[sheet.fidelity], units, name_of(case, sheet.fidelity))
    for axes in filter(is_empty, (motion, spectrum)):
        say(axes, "no decay to show")
    lines = [sheet["displacement_line"] * units.length_factor for sheet in there]
    decades(spectrum, lines, least=LEAST_LINE * largest * units.length_factor)
    motion.set_xlabel("time (s)" if units.frequency else "time ω t")
    motion.set_ylabel(motion_of(plan.output, "displacement", units))
    labelled(spectrum, "frequency", units.frequency, across=True)


def _draw_one(motion: Axes, spectrum: Axes, sheet: Sheet, look: Look, units: DisplayUnits, name: str) -> None:
    time, factor = sheet["time"] * units.time_factor, units.length_factor
    motion.plot(time, sheet["displacement"] * factor, label=name, **look.keys(0.8))
    for side in (1.0, -1.0):
        motion.plot(time, side * sheet["envelope"] * factor, linestyle=":", linewidth=0.8, color=look.colour)
    inside = (sheet["line"] > 0) & (sheet["line"] <= SHOWN * sheet["decay_frequency"][0])
    line, height = sheet["line"][inside] * units.frequency_factor, sheet["displacement_line"][inside] * factor
    spectrum.plot(line, height, **look.keys(0.8))
