"""Sections, portraits and spectra of motions known in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from observed import OMEGA, SIZE, rectified_sine, settled

import vibeam
from vibeam.observe.periodicity import Class, classes
from vibeam.system.quantities import Ended

observe = vibeam.observe


def test_stroboscopic_section_of_a_rectified_sine() -> None:
    found = observe.stroboscopic_section(rectified_sine(), periods=3, phase=1.0)
    np.testing.assert_allclose(np.mod(2 * OMEGA * found.time, 2 * np.pi), 1.0, rtol=1e-12)
    np.testing.assert_allclose(found.displacement, -SIZE * np.sin(0.5), rtol=1e-12)
    np.testing.assert_allclose(found.velocity, -SIZE * OMEGA * np.cos(0.5), rtol=1e-12)
    assert len(found.time) == 3


def test_a_portrait_shows_both_sides_of_a_jump() -> None:
    orbit, path = settled("beam", 15.3, periods=4.4)
    found = observe.phase_portrait(path, "contact", periods=2, points=500)
    before, after = found.jumps, found.jumps + 1
    assert len(before) == 2
    np.testing.assert_array_equal(found.time[before], found.time[after])
    np.testing.assert_allclose(found.velocity[before], orbit.velocity, rtol=1e-8)
    np.testing.assert_allclose(found.velocity[after], -path.system.restitution * orbit.velocity, rtol=1e-8)
    np.testing.assert_allclose(found.displacement[before], path.system.gap, atol=1e-14)
    assert np.all(np.diff(found.time) >= 0)
    sensor = observe.phase_portrait(path, "sensor", periods=2, points=500)
    jump = orbit.impulse * path.system.output("sensor") @ path.system.contact
    np.testing.assert_allclose(sensor.velocity[after] - sensor.velocity[before], jump, rtol=1e-6)


def test_velocities_at_impact_times_are_those_after() -> None:
    path = settled("beam", 15.3, periods=30.4)[1]
    assert len(path.impact_times) == 30
    assert np.all(path.velocity_at(path.impact_times) < 0)


@pytest.mark.parametrize("window", ["boxcar", "hann", "flattop"])
def test_a_sine_reads_its_peak_value(window: str) -> None:
    t = np.arange(2000) / 1000.0
    x = 0.7 * np.sin(2 * np.pi * 50 * t) + 3.0
    found = observe.spectrum_of(t, x, window=window)
    line = np.argmin(np.abs(found.frequency - 50))
    assert found.amplitude[line] == pytest.approx(0.7, rel=1e-12)


def test_uneven_samples_are_refused() -> None:
    with pytest.raises(ValueError, match="evenly spaced"):
        observe.spectrum_of([0.0, 1.0, 3.0], [0.0, 1.0, 2.0])


def test_classes_of_motions() -> None:
    period, moving, done = np.array([-1, 1, 2, 5, 0]), np.zeros(5), np.full(5, Ended.COMPLETE.code)
    wanted = [Class.NO_IMPACT, Class.PERIOD_ONE, Class.PERIOD_TWO, Class.PERIOD_MORE, Class.NOT_PERIODIC]
    assert classes(period, moving, done).tolist() == wanted
    assert classes(period, np.ones(5), done).tolist() == [Class.NO_IMPACT] * 5  # it never leaves the stop
    assert classes(period, moving, np.full(5, Ended.NO_ORBIT.code)).tolist() == [Class.FAILED] * 5
