"""Records of many samples are made and read in blocks: the same as at once, and little memory beside the record."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import vibeam
from vibeam.observe.decimation import history_of_cubics
from vibeam.system import record_pieces, record_random

SAMPLES = 400_000  # three blocks and a part of one


@pytest.fixture(scope="module")
def values() -> np.ndarray:
    return np.random.default_rng(3).normal(size=SAMPLES)


@pytest.mark.parametrize("derivative", [0, 1, 2])
def test_a_spline_by_blocks_is_that_through_all_samples(values: np.ndarray, derivative: int) -> None:
    times = np.cumsum(np.random.default_rng(4).uniform(0.5, 1.5, SAMPLES))
    known = CubicSpline(times, values)
    whole = (known.derivative(derivative) if derivative else known).c[::-1].T
    found = record_pieces.spline(times, values, derivative)
    assert found[:, : whole.shape[1]] == pytest.approx(whole, rel=1e-10, abs=1e-10)
    assert not found[:, whole.shape[1] :].any()


def test_extremes_by_blocks_are_those_of_all_pieces(values: np.ndarray) -> None:
    record = vibeam.Record.sampled(values, rate=1.0, interpolation="cubic")
    tried = record.at(np.linspace(0.0, record.end, 4 * SAMPLES))
    assert record.bounds[0] <= tried.min()
    assert record.bounds[1] >= tried.max()
    history = history_of_cubics(record.times, record.coefficients, bins=7)
    assert (history.least.min(), history.greatest.max()) == pytest.approx(record.bounds, rel=1e-12)


@pytest.mark.parametrize("parts", [1, 2, 4, 8])
def test_a_long_transform_in_parts_is_the_transform(monkeypatch: pytest.MonkeyPatch, parts: int) -> None:
    random, whole = np.random.default_rng(5), 1 << 10
    lines = random.normal(size=whole // 2 + 1) + 1j * random.normal(size=whole // 2 + 1)
    known = np.fft.irfft(lines, whole)
    monkeypatch.setattr(record_random, "LONGEST", whole // parts)
    for count in (whole // 2, whole // 2 - 3):
        assert record_random.transformed(lines.copy(), count) == pytest.approx(known[:count], abs=1e-14)


def test_motions_under_one_record_share_its_course(values: np.ndarray) -> None:
    ball = vibeam.ImpactSystem.from_modes(1.0, 0.1, 1.0, 1.0, gap=9.0)
    record = vibeam.Record.sampled(values[:1000], rate=100.0)
    one, other, later = (vibeam.simulate(ball, record, end) for end in (5.0, 9.0, 50.0))
    assert one._solver.course is other._solver.course  # type: ignore[union-attr]
    assert one._solver.course is not later._solver.course  # type: ignore[union-attr]
    assert replace(record, coefficients=2 * record.coefficients) != record


def test_noise_takes_little_memory_beside_its_record() -> None:
    """109 bytes a sample at most, 40 of which are the record's; 187 where lines and spline are made at once."""
    tracemalloc.start()
    try:
        record = vibeam.Record.random(1.0, 200.0, seed=1, rate=5_000.0, quantity="force")
        assert record.peak
        assert tracemalloc.get_traced_memory()[1] < 140 * len(record.times)
    finally:
        tracemalloc.stop()
