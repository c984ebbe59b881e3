"""Histories in bins: no extreme and no impact is lost, whatever the bins; against closed forms and dense samples."""

from __future__ import annotations

import numpy as np
import pytest
from observed import SIZE, rectified_sine, resting, settled

import vibeam

observe = vibeam.observe


def test_a_damped_oscillation_reaches_its_extremes_in_their_bins() -> None:
    """A start at rest: extremes ± e^{−ζωt} at multiples of π/ω_d, in closed form; 5e-7 is what TURN's line states."""
    omega, zeta = 7.0, 0.03
    system = vibeam.ImpactSystem.from_modes(omega, zeta, 1.0, 0.0, gap=9.0)
    path = vibeam.simulate(system, vibeam.Drive(1.0, 0.0), 20.0, vibeam.State(np.array([1.0]), np.array([0.0])))
    found = observe.history_of_motion(path, "contact", bins=40)
    damped = omega * np.sqrt(1 - zeta**2)
    turns = np.arange(0.0, 20.0, np.pi / damped)
    values = np.exp(-zeta * omega * turns) * np.where(np.arange(len(turns)) % 2, -1.0, 1.0)
    at = np.minimum(np.searchsorted(found.edges, turns, side="right") - 1, 39)
    edges = path.at(found.edges)
    for side, own in ((found.greatest, np.fmax), (found.least, np.fmin)):
        known = own(edges[:-1], edges[1:])
        own.at(known, at, values)
        np.testing.assert_allclose(side, known, atol=5e-7, rtol=0)
    assert found.peak == 1.0


def test_every_impact_is_seen_from_both_sides() -> None:
    """A rectified sine reaches 0 and −SIZE; its velocity jumps between ± SIZE·OMEGA, whatever the bins."""
    path = rectified_sine(periods=16)
    for bins in (1, 7, 1000, 2**15):
        found = observe.history_of_motion(path, "sensor", bins=bins)
        hit = np.searchsorted(found.edges, path.impact_times, side="right") - 1
        np.testing.assert_allclose(found.greatest[np.minimum(hit, bins - 1)], 0.0, atol=1e-15)
        assert np.min(found.least) == pytest.approx(-SIZE, rel=1e-9)
        assert len(found) == bins


@pytest.mark.parametrize("path", [settled("beam", 15.3, 40.0)[1], resting(20)], ids=["beam", "rests"])
def test_dense_samples_lie_within_their_bins_and_reach_their_ends(path: vibeam.Trajectory) -> None:
    """2 million samples against 500 bins: none outside, and the bins no wider than they by more than their spacing."""
    found = observe.history_of_motion(path, "contact", bins=500)
    times = np.linspace(path.t_start, path.t_end, 500 * 4000 + 1)
    values = path.at(times, "contact")
    blocks = values[:-1].reshape(500, 4000)
    size = np.ptp(values)
    above, below = found.greatest - blocks.max(axis=1), blocks.min(axis=1) - found.least
    assert min(above.min(), below.min()) > -1e-6 * size
    assert max(above.max(), below.max()) < 2e-4 * size


def test_a_zoom_reads_the_extremes_of_the_whole() -> None:
    rng = np.random.default_rng(3)
    times, values = np.linspace(0.0, 2.0, 1_000_001), rng.standard_normal(1_000_001)
    found = observe.history_of_samples(times, values, bins=2**16)
    assert (np.max(found.greatest), np.min(found.least)) == (values.max(), values.min())
    for begin, end in ((0.0, 2.0), (0.31, 0.9), (1.2, 1.2001)):
        part = found.within(begin, end, most=600)
        inside = (times >= part.edges[0]) & (times <= part.edges[-1])
        assert len(part) <= 600
        assert (part.edges[0] <= begin, part.edges[-1] >= end) == (True, True)
        assert np.max(part.greatest) == pytest.approx(values[inside].max(), rel=1e-12)
        assert np.min(part.least) == pytest.approx(values[inside].min(), rel=1e-12)


def test_cubics_turn_where_their_derivative_is_zero() -> None:
    """Random cubics against the roots of numpy's polynomials."""
    rng = np.random.default_rng(5)
    rows = rng.standard_normal((300, 4)) * 10.0 ** rng.integers(-6, 3, (300, 4))
    rows[:50, 3] = 0.0
    for row in rows:
        found = observe.history_of_cubics([0.0, 1.0], [row], bins=1)
        roots = np.roots(np.polynomial.Polynomial(row).deriv().coef[::-1])
        inside = [each.real for each in roots if abs(each.imag) < 1e-12 and 0 < each.real < 1]
        values = np.polynomial.Polynomial(row)(np.array([0.0, 1.0, *inside]))
        rounding = 1e-14 * np.abs(row).max()
        np.testing.assert_allclose([found.least[0], found.greatest[0]], [min(values), max(values)], atol=rounding)


def test_a_load_is_zero_outside_its_span_and_jumps_at_its_ends() -> None:
    found = observe.history_of_cubics([1.0, 2.0], [[3.0, 0.0, 0.0, 0.0]], 0.0, 3.0, bins=6)
    assert found.least.tolist() == [0.0, 0.0, 3.0, 3.0, 0.0, 0.0]
    assert found.greatest.tolist() == [0.0, 3.0, 3.0, 3.0, 3.0, 0.0]
