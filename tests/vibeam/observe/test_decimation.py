"""Histories in bins: no extreme and no impact is lost, whatever the bins; against closed forms and dense samples."""

from __future__ import annotations

import numpy as np
import pytest

import vibeam

observe = vibeam.observe


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


def test_a_zoom_from_edge_to_edge_has_the_bins_between_them_alone() -> None:
    found = observe.history_of_cubics([0.0, 8.0], [[0.0, 1.0, 0.0, 0.0]], bins=8)
    part = found.within(2.0, 5.0)
    assert (part.edges.tolist(), part.least.tolist(), part.greatest.tolist()) == ([2, 3, 4, 5], [2, 3, 4], [3, 4, 5])


def test_the_first_value_counts_in_the_first_bin_alone() -> None:
    found = observe.history_of_cubics([0.0, 4.0], [[5.0, -1.0, 0.0, 0.0]], bins=4)
    assert (found.least.tolist(), found.greatest.tolist()) == ([4, 3, 2, 1], [5, 4, 3, 2])


def test_at_an_edge_where_it_jumps_the_later_value_counts_on_both_sides() -> None:
    found = observe.history_of_cubics([0.0, 1.0, 2.0], [[1.0, 0.0, 0.0, 0.0], [3.0, 0.0, 0.0, 0.0]], bins=2)
    assert (found.least.tolist(), found.greatest.tolist()) == ([1, 3], [3, 3])


def test_an_impact_at_an_edge_is_in_the_bin_after_it() -> None:
    time, speed, many = observe.hardest_impacts([0.5, 1.0, 1.5], [3.0, 2.0, 1.0], [0.0, 1.0, 2.0])
    assert (time.tolist(), speed.tolist(), many.tolist()) == ([0.5, 1.0], [3.0, 2.0], [1, 2])
