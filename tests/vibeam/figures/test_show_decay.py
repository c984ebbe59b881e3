"""Free decay: the envelope and the spectrum of damped sinusoids known in closed form."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam.casefile.read import parse
from vibeam.exchange.faults import CaseError
from vibeam.figures.sheet import Sheet, sheets
from vibeam.observe.decay import highest_line
from vibeam.report.figures import figure

CASES = Path(__file__).parents[3] / "cases"
CASE = """units = "SI"
[sdof]
natural_frequency = "8 Hz"
damping_ratio = {zeta}
[stop]
gap = {gap}
restitution = 0.9
[drive]
amplitude = 0.5e-3
[sweep]
frequency = ["16 Hz"]
settle = 10
hold = 2
[fidelity.it]
{own}
[show.it]
kind = "decay"
start = 0.01
{more}
"""


def sheet_of(zeta: float = 0.02, gap: float = 0.0, own: str = "", more: str = "") -> Sheet:
    (sheet,) = vibeam.run(parse(CASE.format(zeta=zeta, gap=gap, own=own, more=more))).shown["it"]
    return sheet


@pytest.mark.parametrize(("zeta", "gap"), [(0.001, -1e-3), (0.02, 0.0), (0.1, 1e-3)])
def test_one_mode_decays_as_its_closed_form(zeta: float, gap: float) -> None:
    """x = x₀ e^{−σt} (cos ω_d t + (σ/ω_d) sin ω_d t), whatever the gap of a stop that is not there."""
    sheet = sheet_of(zeta, gap, more="periods = 12")
    omega = 2 * np.pi * 8
    sigma, damped = zeta * omega, omega * np.sqrt(1 - zeta**2)
    t = sheet["time"]
    exact = 0.01 * np.exp(-sigma * t) * (np.cos(damped * t) + sigma / damped * np.sin(damped * t))
    assert np.allclose(sheet["displacement"], exact, atol=1e-11)
    assert sheet["decay_damping"] == pytest.approx(zeta, rel=1e-3)
    assert sheet["decay_frequency"] == pytest.approx(damped / (2 * np.pi), rel=1e-5)
    assert np.all(np.abs(exact) <= sheet["envelope"] * (1 + 1e-3) * np.exp(sigma * np.pi / damped))


def test_the_spectrum_has_its_line_at_the_damped_frequency() -> None:
    assert sheet_of(0.017)["spectrum_frequency"] == pytest.approx(8 * np.sqrt(1 - 0.017**2), rel=1e-4)


def test_the_highest_line_of_a_parabola_is_its_vertex() -> None:
    lines = np.arange(9.0)
    assert highest_line(lines, np.exp(-((lines - 4.3) ** 2))) == pytest.approx(4.3, abs=1e-12)


def test_a_beam_is_let_go_from_its_static_deflection() -> None:
    case = vibeam.load(CASES / "experiment" / "fig30.toml", set={"sweep.frequency": ["7 Hz"], "sweep.settle": 1})
    result = vibeam.run(case)
    beam = next(sheet for sheet in result.shown["decay"] if sheet.fidelity == "beam")
    assert beam["displacement"][0] == pytest.approx(2e-3, rel=1e-12)
    system = case.system("beam")
    assert beam["decay_frequency"] == pytest.approx(float(system.omega[0]) / (2 * np.pi), rel=5e-4)
    made = figure(result, case.shows["decay"])
    assert [axes.get_xlabel() for axes in made.axes] == ["time (s)", "frequency (Hz)"]


def test_a_gauge_decays_in_strain_and_a_model_without_dimensions_in_its_own_time() -> None:
    own = {"show.it.kind": "decay", "show.it.start": "2 mm", "show.it.output": "gauge", "show.it.fidelities": ["sdof"]}
    gauge = vibeam.load(CASES / "dtu_sensors.toml", set=own)
    plain = parse(CASE.format(zeta=0.02, gap=0, own="", more="periods = 12"))
    motion, spectrum = drawn(gauge).axes
    assert (motion.get_ylabel(), max(motion.get_lines()[0].get_ydata())) == ("gauge:\nstrain (µε)", pytest.approx(2e3))
    motion, spectrum = drawn(plain).axes
    assert (motion.get_xlabel(), spectrum.get_xlabel()) == ("time ω t", "frequency")
    assert max(motion.get_lines()[0].get_xdata()) == pytest.approx(12 * 2 * np.pi, rel=1e-3)


def drawn(case: vibeam.Case) -> Any:
    plan = case.shows["it"]
    return figure(vibeam.Result(case, {}, shown={"it": sheets(case, plan)}), plan)


def test_under_its_weight_a_beam_decays_about_its_place_at_rest() -> None:
    """A constant load moves the place at rest alone; transverse gravity sags the rig by millimetres."""
    found = []
    for own in ({}, {"gravity.direction": "transverse"}):
        few = {"sweep.frequency": ["7 Hz"], "sweep.settle": 1}
        result = vibeam.run(vibeam.load(CASES / "experiment" / "fig30.toml", set=few | own))
        found.append(next(sheet for sheet in result.shown["decay"] if sheet.fidelity == "beam"))
    assert np.allclose(found[1]["displacement"], found[0]["displacement"], atol=1e-11)
    assert found[1]["decay_damping"] == pytest.approx(found[0]["decay_damping"], rel=1e-6)


@pytest.mark.parametrize(
    ("more", "fault"), [("periods = 1", "maxima are too few"), ("periods = 2", "maxima are too few")]
)
def test_too_short_a_decay_says_so(more: str, fault: str) -> None:
    result = vibeam.run(parse(CASE.format(zeta=0.02, gap=0, own="", more=more)))
    assert fault in result.shown["it"][0].fault
    assert all(axes.texts for axes in figure(result, result.case.shows["it"]).axes)


def test_a_decay_without_a_start_is_a_fault() -> None:
    text: Any = CASE.format(zeta=0.02, gap=0, own="", more="").replace("start = 0.01", "")
    with pytest.raises(CaseError, match=re.escape('show.it.start: missing: kind = "decay" needs it')):
        parse(text)
