"""Random records: density, also between the samples, Gaussian statistics, seeds."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from scipy.signal import welch

from vibeam import Record
from vibeam.system.record_random import DensityTable

TABLE = [(20.0, 0.5), (80.0, 2.0), (350.0, 2.0), (500.0, 1.0)]


def expected(f: Any) -> Any:
    """The table's density by its slopes, log-log."""
    rise, fall = np.log(4) / np.log(4), np.log(0.5) / np.log(500 / 350)
    return np.where(f < 80, 2 * (f / 80) ** rise, np.where(f < 350, 2.0, 2 * (f / 350) ** fall))


@pytest.mark.parametrize(("interpolation", "rate"), [("linear", 2500.0), ("cubic", 1250.0)])
def test_the_record_has_the_density_between_its_samples_too(interpolation: str, rate: float) -> None:
    record = Record.random(TABLE, 60.0, seed=3, rate=rate, interpolation=interpolation)
    fine = 10_000.0
    u = record.at(np.arange(int(60 * fine)) / fine)
    f, found = welch(u, fine, nperseg=4000, window="hann")
    inside = (f >= 30) & (f <= 490)
    ratio = found[inside] / expected(f[inside])  # 299 overlapping segments of 30: about 1/√160 each
    assert ratio.mean() == pytest.approx(1.0, abs=0.02)
    assert ratio.std() < 0.13
    first = (f > rate - 350) & (f < rate - 100)
    size = {"linear": 2e-2, "cubic": 4e-2}[interpolation]
    assert 0 < found[first].max() < size


def test_mean_square_is_the_integral_of_the_table() -> None:
    f = np.linspace(20, 500, 2_000_001)
    table = DensityTable(*np.array(TABLE).T)
    assert table.mean_square == pytest.approx(np.trapezoid(expected(f), f), rel=1e-9)
    assert table.at(np.array([10.0, 40.0, 600.0])).tolist() == pytest.approx([0.0, 1.0, 0.0])
    falling = DensityTable(np.array([10.0, 100.0]), np.array([1.0, 0.1]))  # S = 10/f
    assert falling.mean_square == pytest.approx(10 * np.log(10))


def test_samples_are_gaussian_and_stationary() -> None:
    records = [Record.random(2.0, 0.1, seed=seed, rate=1000.0, interpolation="linear") for seed in range(400)]
    values = np.array([record.coefficients[:, 0] for record in records])
    white = values.ravel()
    spread = np.sqrt(2 / white.size)
    boost = np.mean(np.sinc(np.linspace(0, 0.5, 10_001)) ** -4)  # of samples, so that the lines between have the level
    assert white.var() / (1000.0 * boost) == pytest.approx(1.0, abs=8 * spread)
    assert (white**4).mean() / white.var() ** 2 == pytest.approx(3.0, abs=0.1)
    by_time = values.var(axis=0) / white.var()
    assert by_time.std() == pytest.approx(np.sqrt(2 / 400), rel=0.35)


def test_a_seed_is_one_realisation() -> None:
    one, again, other = (Record.random(TABLE, 1.0, seed=seed) for seed in (1, 1, 2))
    assert one == again
    assert one.digest != other.digest
    louder = Record.random([(f, 4 * level) for f, level in TABLE], 1.0, seed=1)
    assert louder.at(one.times) == pytest.approx(2 * one.at(one.times), abs=1e-12 * one.peak)
    assert one.duration == pytest.approx(1.0)


WRONG: list[tuple[dict[str, Any], str]] = [
    ({"density": TABLE, "rate": 900.0}, "rate: 900 Hz must be at least twice the highest frequency of the density, 1"),
    ({"density": [(20, 1), (10, 1)]}, "density: frequencies must be positive and ascend"),
    ({"density": [(20, 1), (30, 0)]}, "density: levels must be positive: a table ends where there is nothing more"),
    ({"density": [(0, 1), (30, 2)]}, "density: log-log interpolation has no frequency 0: begin the table above it"),
    ({"density": TABLE, "seed": 0.5}, "seed: 0.5 must be a whole number ≥ 0"),
    ({"density": TABLE, "duration": 1e6}, "duration: 5e+09 samples, 1.25e+07 at most: shorten it, or lower rate"),
    ({"density": 1.0}, "band: must be two frequencies, Hz; without one, white noise needs a rate"),
    ({"density": 1.0, "band": (10, 20, 30)}, "band: must be two frequencies, Hz; without"),
    ({"density": "loud"}, "density: must be rows of frequency"),
]  # fmt: skip


@pytest.mark.parametrize(("given", "message"), WRONG)
def test_what_is_no_density_is_refused(given: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        Record.random(**{"duration": 1.0, "seed": 1} | given)
