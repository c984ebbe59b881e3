"""Shift in frequency and error in amplitude told apart: known shifts and factors of closed-form curves come back."""

from __future__ import annotations

import numpy as np
import pytest

from vibeam.studies.regression.registration import register

GRID = np.linspace(10.0, 20.0, 801)
POINTS = np.linspace(12.0, 18.0, 61)


def receptance(f: np.ndarray) -> np.ndarray:
    """A linear resonance at 15 Hz, 2 % damping; about 1 mm in static deflection."""
    r = f / 15.0
    return np.asarray(1e-3 / np.hypot(1 - r**2, 0.04 * r))


@pytest.mark.parametrize(("shift", "error"), [(0.01, 0.0), (-0.03, 0.0), (0.0, 0.1), (0.0, -0.3), (0.02, 0.15)])
def test_a_known_shift_and_a_known_factor_come_back(shift: float, error: float) -> None:
    """The reference is the curve at f/(1+s), over 1+e, by construction; what remains is the chords of the grid."""
    found = register([(GRID, receptance(GRID))], POINTS, receptance(POINTS * (1 + shift)) / (1 + error))
    assert found is not None
    assert found.separable
    assert (found.shift, found.amplitude) == pytest.approx((shift, error), abs=4e-4)
    assert found.shift_hz == pytest.approx(15.0 * shift, abs=6e-3)
    assert found.residual < 1e-4 < 1e-3 < found.before


def test_a_shifted_peak_is_no_amplitude_error_though_it_is_pointwise() -> None:
    value = receptance(POINTS * 1.02)
    assert np.max(np.abs(receptance(POINTS) / value - 1)) > 0.4
    found = register([(GRID, receptance(GRID))], POINTS, value)
    assert found is not None
    assert "0.3 Hz (2 % ± 0" in found.sentence
    assert "too high in frequency" in found.sentence


@pytest.mark.slow
def test_intervals_cover_the_truth_of_noisy_curves() -> None:
    """Of 40 sets with 2 % noise at least 33 of the 95 % intervals hold the truth (binomial: 99.9 %), of each error."""
    covered = np.zeros(2, int)
    for seed in range(40):
        noise = 1 + 0.02 * np.random.default_rng(seed).standard_normal(len(POINTS))
        found = register([(GRID, receptance(GRID))], POINTS, receptance(POINTS * 1.01) / 1.05 * noise)
        assert found is not None
        covered += [abs(found.shift - 0.01) <= found.shift_interval,
                    abs(found.amplitude - 0.05) <= found.amplitude_interval]  # fmt: skip
    assert (covered >= 33).all()


def test_a_straight_flank_does_not_tell_them_apart() -> None:
    """a = k f: a shift by s is a factor 1 + s."""
    found = register([(GRID, 1e-4 * GRID)], POINTS, 1.05e-4 * POINTS)
    assert found is not None
    assert not found.separable
    assert "measure both sides of the peak" in found.sentence


def test_no_segment_spans_a_jump() -> None:
    """Points in the gap between two pieces are as far as the nearer end; on one chord they would lie exactly."""
    pieces = [(np.array([10.0, 12.0]), np.array([1.0, 1.0])), (np.array([14.0, 16.0]), np.array([3.0, 3.0]))]
    frequency = np.array([10.0, 11.0, 12.0, 13.0, 14.0, 15.0, 16.0])
    found = register(pieces, frequency, np.array([1.0, 1.0, 1.0, 2.0, 3.0, 3.0, 3.0]))
    assert found is not None
    assert found.before == pytest.approx(np.sqrt((1 / 9 + 1 / 36) / 7), rel=1e-12)


def test_too_few_points_say_nothing() -> None:
    assert register([(GRID, receptance(GRID))], POINTS[:4], receptance(POINTS[:4])) is None
    assert register([], POINTS, receptance(POINTS)) is None
    assert register([(GRID, receptance(GRID))], np.full(9, 15.0), np.ones(9)) is None
