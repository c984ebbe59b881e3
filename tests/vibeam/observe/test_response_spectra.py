"""Response spectra under noise: theory of a linear oscillator, coverage of the intervals, what two models share."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import freqz, lfilter

import vibeam
from vibeam.observe.oscillators import Oscillators, Pieces, knot_states
from vibeam_models.arrays import Array

RATE, NATURAL, ZETA = 1000.0, 60.0, 0.05
RECORDS, SAMPLES, SEGMENT = 24, 8192, 1024
observe = vibeam.observe


def noise(seed: int, records: int = RECORDS) -> Array:
    """White acceleration of density 2/RATE: unit samples, joined by straight lines."""
    return np.random.default_rng(seed).normal(size=(records, SAMPLES))


def absolute(base: Array, natural: float = NATURAL) -> Array:
    """Absolute acceleration of an oscillator at the samples, exact for straight lines between them."""
    bank = Oscillators.of(np.array([natural]), ZETA)
    rows = []
    for values in base:
        lines = np.stack([values[:-1], np.diff(values) * RATE, 0 * values[1:], 0 * values[1:]], axis=1)
        rows.append(bank.read(knot_states(Pieces(np.arange(SAMPLES) / RATE, lines), bank.rate))[0, :, 0])
    return np.array(rows)


def theory(frequency: Array, natural: float = NATURAL) -> Array:
    """Gain by the ramp-invariant filter (ISO 18431-4), which the samples obey, folding and all."""
    omega = 2 * np.pi * natural
    a, b = omega * ZETA / RATE, omega / RATE * np.sqrt(1 - ZETA**2)
    decay, turn = np.exp(-a), np.exp(-a) * np.sin(b) / b
    numerator = [1 - turn, 2 * (turn - decay * np.cos(b)), decay**2 - turn]
    return np.asarray(freqz(numerator, [1, -2 * decay * np.cos(b), decay**2], frequency, fs=RATE)[1])


def share(inside: Array) -> float:
    return float(np.mean(inside))


def test_linear_oscillator_in_white_noise_has_its_theoretical_density() -> None:
    """All lines but those next to 0 Hz, where the mean is taken off: 94 to 96 of 100 intervals hold the truth."""
    held, off = [], []
    for seed in range(6):
        found = observe.response_spectrum(absolute(noise(seed)), RATE, segment=SEGMENT)
        exact = 2 / RATE * np.abs(theory(found.frequency)) ** 2
        away = np.abs(found.frequency / NATURAL - 1) > 0.1  # leakage of the resonance: 3 lines of 1 Hz wide at 6 Hz
        held.append(share(((found.low <= exact) & (exact <= found.high))[3:][away[3:]]))
        off.append(found.density / exact)
    assert np.mean(held) == pytest.approx(0.95, abs=0.01)
    mean = np.mean(off, axis=0)[3:-1]
    assert np.abs(mean - 1).max() < 0.12  # 5σ of six ensembles; at the peak the window's width takes 3 %
    assert abs(np.mean(mean) - 1) < 0.005


def test_degrees_of_freedom_are_those_of_the_scatter() -> None:
    """Var Ŝ = 2 S²/ν over 400 ensembles of white noise; Hann's window at half overlap: 1.9 of 2 a segment."""
    rows = np.random.default_rng(0).normal(size=(400, 4, 2048))
    found = [observe.response_spectrum(each, 1.0, segment=256) for each in rows]
    densities, freedom = np.array([each.density for each in found]), found[0].freedom
    inner = slice(2, -2)
    seen = 2 * densities.mean(axis=0) ** 2 / densities.var(axis=0)
    assert np.mean(1 / seen[inner]) == pytest.approx(1 / freedom[10], rel=0.02)
    assert freedom[10] / (4 * 15 * 2) == pytest.approx(0.95, abs=0.02)
    assert freedom[-1] == freedom[0] / 2
    single = observe.response_spectrum(rows[0], 1.0, segment=256, overlap=0.0, window="boxcar")
    assert single.freedom[0] == 2 * 4 * 8


def test_transfer_function_and_coherence_hold_the_linear_ones() -> None:
    held, coherent = [], []
    for seed in range(4):
        base = noise(seed, 8)
        disturbed = absolute(base) + 0.5 * np.random.default_rng(100 + seed).normal(size=base.shape)
        found = observe.transfer_function(base, disturbed, RATE, segment=SEGMENT)
        exact = theory(found.frequency)
        away = (found.frequency > 4) & (np.abs(found.frequency / NATURAL - 1) > 0.15)
        held.append(share((np.abs(found.gain - exact) <= found.radius)[away]))
        truth = np.abs(exact) ** 2 / (np.abs(exact) ** 2 + 0.25)
        inside = (found.coherence_low <= truth) & (truth <= found.coherence_high)
        coherent.append(share(inside[away & (truth > 0.2)]))
    assert np.mean(held) == pytest.approx(0.95, abs=0.015)
    assert np.mean(coherent) == pytest.approx(0.95, abs=0.03)


def test_two_models_on_the_same_noise_differ_by_less_than_on_others() -> None:
    """An oscillator at 60 Hz and one at 61 Hz: intervals of the ratio hold the truth, and are a tenth as wide."""
    base = noise(7)
    one, other = absolute(base, 61.0), absolute(base)
    found = observe.spectrum_ratio(one, other, RATE, segment=SEGMENT)
    exact = np.abs(theory(found.frequency, 61.0) / theory(found.frequency)) ** 2
    away = (found.frequency > 4) & (np.abs(found.frequency / NATURAL - 1) > 0.15)
    alone = observe.spectrum_ratio(one, absolute(noise(8)), RATE, segment=SEGMENT)
    widths = [np.log(each.high / each.low)[away] for each in (found, alone)]
    assert np.median(widths[0]) < 0.1 * np.median(widths[1])
    held = ((alone.low <= exact) & (exact <= alone.high))[away]
    assert share(held) == pytest.approx(0.95, abs=0.035)
    noisy = one + 0.3 * np.random.default_rng(9).normal(size=one.shape)
    found = observe.spectrum_ratio(noisy, other, RATE, segment=SEGMENT)
    exact = (np.abs(theory(found.frequency, 61.0)) ** 2 + 0.09) / np.abs(theory(found.frequency)) ** 2
    assert share(((found.low <= exact) & (exact <= found.high))[away]) == pytest.approx(0.95, abs=0.035)


def test_all_that_is_wrong_is_said_at_once() -> None:
    with pytest.raises(ValueError, match="segment: 99 samples are more than a record has, 50") as told:
        observe.response_spectrum(np.zeros(50), -1.0, segment=99, overlap=1.0, window="hammer", level=2.0)
    for text in ("rate", "overlap: 1 must be below 1", "level: 2 must be below 1", "window"):
        assert text in str(told.value)
    with pytest.raises(ValueError, match="values: must be finite"):
        observe.transfer_function(np.zeros(50), np.zeros(51), 1.0)
    with pytest.raises(ValueError, match="degrees of freedom are too few"):
        observe.transfer_function(lfilter([1], [1], np.arange(50.0)), np.arange(50.0), 1.0, segment=50)
