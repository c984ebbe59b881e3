"""Ringing and apparent restitution: signals with known parameters, and what PHYSICS §4 says of the DTU beam."""

from __future__ import annotations

import numpy as np
import pytest
from observed import settled

import vibeam

observe = vibeam.observe
BESSEL = observe.LowPass("bessel", 4, 500.0)
ELLIPTIC = observe.LowPass("elliptic", 6, 500.0, 0.1, 60.0)


def ringing_signal() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Three flights of a parabola with 103 Hz, 12/s, 0.05 mm from each impact on."""
    t = np.arange(0, 0.21, 1 / 5000)
    hits = np.array([0.01, 0.075, 0.14, 0.2])
    since = t - hits[np.maximum(np.searchsorted(hits, t, side="right") - 1, 0)]
    slow = 1e-3 * (-3 * since + 40 * since**2)
    return t, slow + 5e-5 * np.exp(-12 * since) * np.cos(2 * np.pi * 103 * since + 0.3), hits


@pytest.mark.parametrize("near", [None, 95.0])
def test_a_damped_sinusoid_is_found_exactly(near: float | None) -> None:
    t, x, hits = ringing_signal()
    found = observe.fit_ringing(t, x, hits, observe.SlowPart(2), near=near)
    assert found.found.all()
    assert len(found.frequency) == 3
    np.testing.assert_allclose(found.frequency, 103.0, rtol=1e-7)
    np.testing.assert_allclose(found.decay, 12.0, rtol=1e-5)
    lag = found.begin - hits[:-1]
    np.testing.assert_allclose(found.displacement, 5e-5 * np.exp(-12 * lag), rtol=1e-6)
    np.testing.assert_allclose(found.velocity / found.displacement, np.hypot(12.0, 2 * np.pi * 103), rtol=1e-7)
    span = found.end - found.begin
    np.testing.assert_allclose(found.mean_displacement / found.displacement, -np.expm1(-12 * span) / 12 / span)
    np.testing.assert_allclose(found.damping_ratio, 12 / np.hypot(12, 2 * np.pi * 103), rtol=1e-5)
    assert found.residual.max() < 1e-11


def test_peaks_closer_than_asked_for_count_once() -> None:
    """103 Hz for 60 ms from each impact on: six or seven maxima; a tone of 900 Hz beside it adds its own."""
    t, _, hits = ringing_signal()
    since = t - hits[np.maximum(np.searchsorted(hits, t, side="right") - 1, 0)]
    tone = np.cos(2 * np.pi * 103 * since + 0.3)
    mixed = tone + 0.3 * np.cos(2 * np.pi * 900 * since)
    clean = observe.count_peaks(t, tone, hits[:3], guard=1e-3, prominence=0.2)
    np.testing.assert_allclose(clean.frequency, 103, atol=0.8)
    np.testing.assert_allclose(clean.height, 1, atol=5e-3)
    assert (observe.count_peaks(t, mixed, hits[:3], guard=1e-3, prominence=0.05).peaks > 2 * clean.peaks).all()
    apart = observe.count_peaks(t, mixed, hits[:3], guard=1e-3, prominence=0.05, apart=7e-3)
    np.testing.assert_array_equal(apart.peaks, clean.peaks)


def test_further_sinusoids_are_told_apart() -> None:
    t, x, hits = ringing_signal()
    since = t - hits[np.maximum(np.searchsorted(hits, t, side="right") - 1, 0)]
    x = x + 2e-5 * np.exp(-30 * since) * np.cos(2 * np.pi * 140 * since)
    alone = observe.fit_ringing(t, x, hits, observe.SlowPart(2), near=103.0)
    both = observe.fit_ringing(t, x, hits, observe.SlowPart(2), near=103.0, further=1)
    assert np.abs(alone.frequency - 103).min() > 0.05
    np.testing.assert_allclose(both.frequency, 103.0, rtol=1e-6)


def test_short_intervals_are_not_fitted() -> None:
    t, x, _ = ringing_signal()
    found = observe.fit_ringing(t, x, [0.01, 0.0104, 0.06], observe.SlowPart(1))
    assert list(found.found) == [False, True]
    t, x, hits = ringing_signal()
    assert not observe.fit_ringing(t, x, hits, observe.SlowPart(2), near=30.0).found.any()  # 103 Hz is not near 30
    with pytest.raises(ValueError, match="nothing in it"):
        observe.SlowPart(-1)


OF_CONTACT = {"stop__restitution_of": "contact"}  # R = 0.72 of the contact, of which mode 1 sees 0.602


def ringing_of_the_beam(frequency: float, low_pass: observe.LowPass | None) -> tuple[float, float, np.ndarray]:
    """Fitted and counted frequency, and the fitted velocity in mm/s, of mode 2 between impacts."""
    _, path = settled("beam", frequency, periods=12.4, **OF_CONTACT)
    record = observe.measure(path, observe.Chain(5000.0, low_pass))
    hits = path.impact_times[3:-1] + (low_pass.delay() if low_pass else 0.0)
    slow = observe.slow_part(path.system, path.drive)
    fit = observe.fit_ringing(record.time, record.displacement, hits, slow, near=103.0, further=1, guard=2e-3)
    counted = observe.count_peaks(record.time, record.displacement, hits, slow, guard=2e-3, prominence=0.2)
    return float(np.mean(fit.frequency)), float(np.mean(counted.frequency)), 1e3 * fit.velocity


def test_the_beams_ringing_is_mode_2_and_counting_peaks_misreads_it() -> None:
    _, path = settled("beam", 15.3)
    damped = path.system.omega[1] * np.sqrt(1 - path.system.zeta[1] ** 2) / (2 * np.pi)
    fits, counts = [], []
    for frequency in (14.5, 15.5, 16.0, 16.75):
        for low_pass in (None, BESSEL):
            fitted, counted, _ = ringing_of_the_beam(frequency, low_pass)
            fits.append(fitted - damped)
            counts.append(counted - damped)
    assert np.abs(fits).max() < 0.02
    assert 0.5 < np.abs(counts).max() < 3.0  # PHYSICS §4: about 1 Hz
    assert np.sqrt(np.mean(np.square(counts))) > 20 * np.sqrt(np.mean(np.square(fits)))


def test_the_ringing_is_as_strong_as_measured_where_mode_2_lies_on_a_harmonic() -> None:
    speed = ringing_of_the_beam(14.5, None)[2]  # 7 × 14.5 Hz = 101.5 Hz; the paper: mean peak 35 mm/s
    assert 25 < speed.mean() < 40
    assert ringing_of_the_beam(15.5, None)[2].mean() < 20


def test_damping_by_stiffness_kills_the_ringing() -> None:
    share = {}
    for damping in ("constant", "stiffness"):
        _, path = settled("beam", 15.3, periods=6.4, beam__damping=damping)
        t = np.arange(path.impact_times[2] + 0.02, path.impact_times[3], 1 / 5000)
        left = path.at(t, "sensor") - np.polyval(np.polyfit(t - t[0], path.at(t, "sensor"), 4), t - t[0])
        share[damping] = np.ptp(left) / np.ptp(path.at(t, "sensor"))
    assert share["stiffness"] < 0.15 * share["constant"]


def read(
    picked: str,
    low_pass: observe.LowPass | None,
    name: str = "sdof",
    frequency: float = 15.3,
    skip: int = 1,
    **keys: str,
) -> float:
    """The apparent restitution by one picking at 5 kHz."""
    _, path = settled(name, frequency, periods=16.4, **keys)
    record = observe.measure(path, observe.Chain(5000.0, low_pass))
    delay, hits = low_pass.delay() if low_pass else 0.0, path.impact_times[4:-2]
    if picked == "adjacent":
        return observe.adjacent_restitution(record.time, record.velocity, hits, skip=skip, delay=delay).mean
    if picked == "extremum":
        return observe.extremum_restitution(record.time, record.velocity, hits, window=5e-3, delay=delay).mean
    slow = observe.slow_part(path.system, path.drive)
    beside = observe.further_modes(path.system) if name == "beam" else None
    return observe.extrapolated_restitution(
        record.time, record.displacement, hits, slow, window=0.06, guard=1e-3, delay=delay, beside=beside
    ).mean


def test_true_restitution_is_the_contacts() -> None:
    _, path = settled("beam", 15.3, periods=16.4, **OF_CONTACT)
    np.testing.assert_allclose(observe.true_restitution(path).coefficient, 0.72, rtol=1e-9)
    assert observe.first_mode_restitution(path.system) == pytest.approx(0.602474, abs=1e-6)
    one = settled("sdof", 15.3)[1]
    assert observe.first_mode_restitution(one.system) == pytest.approx(0.72)
    np.testing.assert_allclose(observe.mode_restitution(one).coefficient, 0.72, rtol=1e-9)


def test_pickings_of_the_one_mode_model() -> None:
    """PHYSICS §4: which of them are unbiased, and what a sharp filter does."""
    r = 0.72
    assert read("adjacent", None) == pytest.approx(r, abs=0.005)
    assert read("extremum", None) == pytest.approx(r, abs=0.005)
    assert read("extremum", BESSEL) == pytest.approx(r, abs=0.015)
    assert read("extrapolated", None) == pytest.approx(r, abs=1e-6)
    assert read("extrapolated", BESSEL) == pytest.approx(r, abs=0.002)
    assert read("extremum", ELLIPTIC) == pytest.approx(r + 0.2 * (1 + r), abs=0.04)


def test_differences_that_reach_over_the_impact_are_biased() -> None:
    _, path = settled("sdof", 15.3, periods=16.4)
    record = observe.measure(path, observe.Chain(5000.0))
    over = observe.adjacent_restitution(record.time, record.velocity, path.impact_times[4:-2], skip=0).coefficient
    assert np.ptp(over) > 0.1
    assert np.abs(over - 0.72).max() > 0.1


def test_an_extremum_moves_with_the_contact_by_tenths_a_millimetre_and_a_fit_with_the_first_mode() -> None:
    extremes, fits, truths = [], [], []
    for position in ("132 mm", "133 mm"):
        keys = {"stop__position": position, "beam__damping": "stiffness"}
        extremes.append(read("extremum", None, "beam", **keys))
        fits.append(read("extrapolated", None, "beam", **keys))
        truths.append(observe.mode_restitution(settled("beam", 15.3, periods=16.4, **keys)[1]).mean)
    assert 0.2 < abs(extremes[1] - extremes[0]) < 0.35
    np.testing.assert_allclose(fits, truths, atol=0.01)


def test_the_sensor_of_a_beam_sees_no_jump_at_the_instant_of_impact() -> None:
    """The impulse reaches it as a bending wave; what a record seems to show is slower: R₁, not the contact's R."""
    _, path = settled("beam", 15.3, periods=16.4, **OF_CONTACT)
    assert observe.true_restitution(path, "sensor").mean == pytest.approx(-0.98, abs=0.01)
    slow = read("extrapolated", None, "beam", **OF_CONTACT)
    assert slow == pytest.approx(observe.mode_restitution(path).mean, abs=0.01)
    assert slow < 0.72 - 0.05


def test_a_fit_without_the_ringing_beside_it_is_pulled() -> None:
    _, path = settled("beam", 14.5, periods=16.4)
    record, hits = observe.measure(path, observe.Chain(5000.0)), path.impact_times[4:-2]
    slow = observe.slow_part(path.system, path.drive)
    alone = observe.extrapolated_restitution(record.time, record.displacement, hits, slow, window=0.06).mean
    truth = observe.mode_restitution(path).mean
    assert truth - alone > 0.1
    assert read("extrapolated", None, "beam", 14.5) == pytest.approx(truth, abs=0.01)
