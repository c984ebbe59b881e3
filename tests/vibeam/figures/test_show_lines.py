"""Figures of lines: harmonics, spectra and what a measuring chain makes of them, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from figures import beam, forced, free, sheet
from observed import settled

import vibeam
from vibeam.figures.sheet import sheets
from vibeam.report.figures import figure

observe = vibeam.observe
CHAIN = '[measurement]\nsampling = "10 Hz"\nlow_pass = "bessel"\norder = 4\ncut_off = "0.5 Hz"'
SPECTRUM = '[show.it]\nkind = "spectrum"\nfrequency = "2.1 rad/s"\nperiods = 42'


def test_harmonics_of_a_linear_motion() -> None:
    case = free('[show.it]\nkind = "harmonics"\nhighest = 3\nsubdivision = 2')
    for found, omega in zip(sheets(case, case.shows["it"]), (1.8, 2.1), strict=True):
        assert found.frequency == pytest.approx(omega / (2 * np.pi))
        assert list(found["order"]) == [0, 0.5, 1, 1.5, 2, 2.5, 3]
        expected = np.where(found["order"] == 1, forced(omega), 0.0)
        np.testing.assert_allclose(found["harmonic"], expected, atol=1e-7 * forced(omega))  # 400 periods: e^-18
        lag = np.angle(omega**2 * 5e-4 / complex(1 - omega**2, 2 * 0.015 * omega) * -1j)
        assert np.exp(1j * found["phase"][2]) == pytest.approx(np.exp(1j * lag), abs=1e-6)


def test_harmonics_of_the_beam_are_those_of_its_orbit() -> None:
    """The orbit comes in closed form, not by settling."""
    found = sheet(beam("harmonics", frequency=["15.5 Hz"]), "beam", 15.5)
    path = settled("beam", 15.5, periods=4)[1]
    expected = observe.harmonic_amplitudes(path, "sensor", periods=4).amplitude
    np.testing.assert_allclose(found["harmonic"], np.abs(expected), rtol=1e-6)
    np.testing.assert_allclose(np.exp(1j * found["phase"]), expected / np.abs(expected), atol=1e-6)


def test_the_output_may_be_another() -> None:
    at = {
        name: sheet(beam("harmonics", frequency=["15.5 Hz"], output=name), "sdof", 15.5)
        for name in ("contact", "sensor")
    }
    system = beam("harmonics", frequency=["15.5 Hz"], output="contact").system("sdof")
    ratio = abs(float(system.contact[0] / system.output("sensor")[0]))
    np.testing.assert_allclose(at["contact"]["harmonic"], ratio * at["sensor"]["harmonic"], rtol=1e-9)


def test_a_spectrum_reads_a_sines_peak_value() -> None:
    found = sheet(free(SPECTRUM), "sdof", 2.1 / (2 * np.pi))
    line = int(np.argmax(found["displacement_line"]))
    assert found["line"][line] == pytest.approx(2.1 / (2 * np.pi), rel=1e-3)
    assert found["displacement_line"][line] == pytest.approx(forced(2.1), rel=1e-4)
    assert found["velocity_line"][line] == pytest.approx(2.1 * forced(2.1), rel=1e-4)


def test_a_chain_multiplies_a_line_by_the_filters_gain() -> None:
    found = sheet(free(SPECTRUM, CHAIN), "sdof", 2.1 / (2 * np.pi))
    gain = abs(observe.LowPass("bessel", 4, 0.5).response(2.1 / (2 * np.pi)))
    assert gain < 0.9
    line = int(np.argmax(found["displacement_line"]))
    assert found["displacement_line"][line] == pytest.approx(gain * forced(2.1), rel=1e-3)
    quotient = np.sin(2.1 / 10) / (2.1 / 10)  # of central differences
    expected = quotient * 2.1 * found["displacement_line"][line]
    assert found["velocity_line"][line] == pytest.approx(expected, rel=1e-3)


def test_a_history_through_the_chain_lags_and_shrinks() -> None:
    lines = '[show.it]\nkind = "history"\nfrequency = "2.1 rad/s"\nperiods = 5'
    found, exact = (sheet(case, "sdof", 2.1 / (2 * np.pi)) for case in (free(lines, CHAIN), free(lines)))
    assert np.diff(found["time"]) == pytest.approx(0.1)
    gain = observe.LowPass("bessel", 4, 0.5).response(2.1 / (2 * np.pi))
    omega, lag = 2.1, np.angle(2.1**2 * 5e-4 / complex(1 - 2.1**2, 2 * 0.015 * 2.1))
    expected = abs(gain) * forced(2.1) * np.sin(omega * found["time"] + lag + np.angle(gain))
    np.testing.assert_allclose(found["displacement"], expected, atol=2e-4 * forced(2.1))
    np.testing.assert_allclose(exact["displacement"], forced(2.1) * np.sin(omega * exact["time"] + lag), atol=1e-9)


def test_the_figures_are_drawn() -> None:
    for lines in (SPECTRUM, '[show.it]\nkind = "harmonics"', '[show.it]\nkind = "harmonics"\nfrequency = "2 rad/s"'):
        case = free(lines)
        made = figure(vibeam.run(case), case.shows["it"])
        assert all(axes.lines or axes.patches for axes in made.axes)
    bars = [bar.get_height() for bar in made.axes[0].patches]
    assert bars[0] == pytest.approx(forced(2.0), rel=1e-6)


def test_what_cannot_be_read_off_is_said() -> None:
    case = free(SPECTRUM, '[measurement]\nsampling = "0.001 Hz"')
    (found,) = sheets(case, case.shows["it"])
    assert found.fault == "rate: at 0.001 Hz the motion is shorter than three samples"
    assert figure(vibeam.run(case), case.shows["it"]).axes
