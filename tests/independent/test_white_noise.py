"""Impacts without loss under white noise, against the Gibbs law: ``gibbs.py`` derives it, and what noise costs."""

from __future__ import annotations

import numpy as np
import pytest
from gibbs import deviation, impact_rate, kicks, remembered, share_below, spread

import vibeam

CHUNK = 2**14  # kicks flown at once
LEVELS = np.array([-2.5, -2.0, -1.6, -1.3, -1.1])  # places on the density, in σ


def batches(system, chunks, noise, sample):
    """Impacts, and means over ``sample`` (path, times) of chunks of a motion that goes on; the first is left out."""
    state, found = None, []
    for k in range(chunks + 1):
        record = noise(k)
        path = vibeam.simulate(system, record, record.end, state, max_impacts=10**8)
        assert path.ended.name == "COMPLETE"
        times = np.random.default_rng([k, 7]).uniform(0.0, record.end, CHUNK // 8)
        found.append([len(path.impact_times) / record.end, *sample(path, np.sort(times))])
        state = path.state
    return np.array(found[1:])


def one_mode(chunks, zeta=0.005, step=0.5, gap=-1.0):
    """Errors of rate, ⟨η'²⟩ and shares below LEVELS over their standard errors; impacts; standard error of the rate."""
    gamma = 2 * zeta
    system = vibeam.ImpactSystem.from_modes(1.0, zeta, 1.0, 1.0, gap=gap, restitution=1.0)

    def noise(k):
        knots, pieces = kicks(np.random.default_rng([2032, k]), CHUNK, step, (2 * gamma * step) ** 0.5, 2.0**-14 * step)
        return vibeam.Record(knots, pieces, "force")

    def sample(path, times):
        x, v = path.modes_at(times)[:, :, 0].T
        return [np.mean(v**2), *np.mean(x[:, None] <= LEVELS, axis=0)]

    found = batches(system, chunks, noise, sample)
    truth = [impact_rate(np.ones(1), np.ones(1), gap, 1.0), 1.0, *(share_below(x, gap, 1.0) for x in LEVELS)]
    errors = [(mean - true) / error for (mean, error), true in zip(map(spread, found.T), truth, strict=True)]
    mean, error = spread(found[:, 0])
    return np.array(errors), int(found[:, 0].sum() * CHUNK * step), error / mean


def test_one_mode_follows_the_gibbs_law():
    """About 10⁵ impacts: rate, energy and density within 3 standard errors, that of the rate below 3 %."""
    errors, impacts, error = one_mode(22)
    assert impacts > 1e5
    assert np.abs(errors).max() < 3
    assert error < 0.03


@pytest.mark.slow
def test_ten_million_impacts_follow_the_gibbs_law():
    """python -m pytest -m slow tests/independent/test_white_noise.py"""
    errors, impacts, error = one_mode(2050)
    assert impacts > 1e7
    assert np.abs(errors).max() < 3
    assert error < 3e-3


def test_modes_share_the_energy():
    """Three modes with a dashpot where the noise acts: ⟨η_i'²⟩ = T of each, and the rate of the contact."""
    omega, load, row, gap, gamma, step = (
        np.array([1.0, 1.7, 3.1]),
        np.array([1.0, -0.8, 0.9]),
        np.ones(3),
        0.6,
        0.06,
        0.5,
    )
    system = vibeam.ImpactSystem.from_modes(
        omega, 0.0, row, load, gap=gap, restitution=1.0, coupling=gamma * np.outer(load, load)
    )

    def noise(k):
        knots, pieces = kicks(np.random.default_rng([2033, k]), CHUNK, step, (2 * gamma * step) ** 0.5, 2.0**-14 * step)
        return vibeam.Record(knots, pieces, "force")

    found = batches(system, 20, noise, lambda path, times: np.mean(path.modes_at(times)[:, 1] ** 2, axis=0))
    for values, true in zip(found.T, [impact_rate(omega, row, gap, 1.0), 1.0, 1.0, 1.0], strict=True):
        mean, error = spread(values)
        assert abs(mean - true) < 3 * error
        assert error < 0.05 * true
    assert deviation(omega, row, 1.0) > gap


def test_noise_that_is_remembered_gives_less_energy_at_impacts():
    """Lines between samples 0.3/ω apart at Δ = 0: ⟨η'²⟩ is 19 % low, as derived; without a stop 1.5 %."""
    zeta, step, gamma = 0.02, 0.3, 0.04
    system = vibeam.ImpactSystem.from_modes(1.0, zeta, 1.0, 1.0, gap=0.0, restitution=1.0)
    free = vibeam.ImpactSystem.from_modes(1.0, zeta, 1.0, 1.0, gap=1e3, restitution=1.0)

    def noise(k):
        values = (2 * gamma / step) ** 0.5 * np.random.default_rng([2034, k]).normal(size=CHUNK + 1)
        return vibeam.Record.sampled(values, rate=1 / step, quantity="force")

    def sample(path, times):
        return [np.mean(path.modes_at(times)[:, 1, 0] ** 2)]

    struck, apart = (spread(batches(own, 96, noise, sample)[:, 1]) for own in (system, free))
    low = remembered(1.0, 1 / np.pi, step)
    assert low == pytest.approx(1 - 28 / 15 * step / np.pi, abs=0.02)
    assert abs(struck[0] - low) < 3 * struck[1]
    assert struck[0] < 1 - 10 * struck[1]
    assert abs(apart[0] - remembered(1.0, 0.0, step)) < 3 * apart[1]
