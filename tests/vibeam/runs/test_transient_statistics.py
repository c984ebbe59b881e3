"""Sampling errors of ensembles and of correlated series, the horizon of agreement of two impact trains."""

from __future__ import annotations

import numpy as np
import pytest

from vibeam.runs.transient.comparison import ImpactTrain, agreement
from vibeam.runs.transient.statistics import correlation_time, mean_of, mean_of_series, paired, windowed_rate


def test_the_mean_of_independent_values_has_the_error_of_the_textbook() -> None:
    found = mean_of([1.0, 2.0, 3.0, np.nan, 6.0])
    assert (found.mean, found.n, found.effective) == (3.0, 4, 4.0)
    assert found.error == pytest.approx(np.sqrt((4 + 1 + 0 + 9) / 3 / 4), rel=1e-14)
    assert np.isnan(mean_of([1.0]).error)
    assert np.isnan(mean_of([]).mean)


@pytest.mark.parametrize("memory", [-0.5, 0.0, 0.5, 0.9])
def test_a_series_of_first_order_has_the_correlation_time_of_the_closed_form(memory: float) -> None:
    """τ = (1 + a)/(1 − a) of x_{k+1} = a x_k + noise; over 200 series the estimate's mean is within 10 %."""
    generator, times = np.random.default_rng(5), []
    for _ in range(200):
        noise, series = generator.standard_normal(4000), np.empty(4000)
        series[0] = noise[0] / np.sqrt(1 - memory**2)
        for at in range(1, len(series)):
            series[at] = memory * series[at - 1] + noise[at]
        times.append(correlation_time(series))
    assert np.mean(times) == pytest.approx((1 + memory) / (1 - memory), rel=0.1)


def test_the_error_of_a_correlated_mean_covers_the_truth_as_often_as_it_says() -> None:
    """Within two errors in 95 of 100 series with a memory of 0.8; √n would cover 50."""
    generator, hits = np.random.default_rng(8), 0
    for _ in range(300):
        noise, series = generator.standard_normal(2000), np.empty(2000)
        series[0] = noise[0] / 0.6
        for at in range(1, len(series)):
            series[at] = 0.8 * series[at - 1] + noise[at]
        found = mean_of_series(series)
        hits += abs(found.mean) < 2 * found.error
        assert found.effective < 600
    assert 270 <= hits <= 299


def test_few_values_of_a_series_have_no_error() -> None:
    assert np.isnan(mean_of_series([1.0, 2.0, 3.0]).error)
    assert mean_of_series(np.ones(50)).error == 0.0


def test_paired_differences_have_smaller_errors_than_the_values() -> None:
    """What both models share falls out: 5 % off, the scatter of the realisations 30 %, of their differences 1 %."""
    generator = np.random.default_rng(2)
    finest = 10 + 3 * generator.standard_normal(40)
    found = paired(1.05 * finest + 0.1 * generator.standard_normal(40), finest)
    assert found.mean == pytest.approx(0.05, abs=3 * found.error)
    assert found.error < 0.005 < mean_of(finest).error / 10


def test_a_poisson_process_has_its_rate_and_its_error() -> None:
    times = np.sort(np.random.default_rng(3).uniform(0, 100, 4000))
    found = windowed_rate(times, 0, 100)
    assert found.mean == pytest.approx(40.0)
    assert found.error == pytest.approx(np.sqrt(4000) / 100, rel=0.4)


def train(times: list[float], velocities: list[float] | None = None, contacts: list[int] | None = None) -> ImpactTrain:
    count = len(times)
    speeds = np.ones(count) if velocities is None else np.array(velocities)
    return ImpactTrain(np.array(times), speeds, np.array(contacts or [0] * count))


def test_trains_agree_until_the_first_hard_impact_without_a_partner() -> None:
    one, other = train([1.0, 2.0, 3.0, 4.0]), train([1.01, 2.02, 3.2, 4.4])
    assert agreement(one, other, 0.05, 5.0) == 3.0
    assert agreement(one, other, 0.5, 5.0) == 5.0
    assert agreement(other, one, 0.05, 5.0) == 3.0  # whichever is named first


def test_light_impacts_need_no_partner_and_hard_ones_take_any() -> None:
    hard, bouncing = train([1.0, 2.0]), train([1.0, 1.1, 1.15, 2.0], [1.0, 0.09, 0.05, 1.0])
    assert agreement(hard, bouncing, 0.01, 3.0) == 3.0
    lost = train([1.0, 1.1, 2.0], [1.0, 0.5, 1.0])
    assert agreement(hard, lost, 0.01, 3.0) == 1.1


def test_an_impact_at_another_contact_is_no_partner() -> None:
    assert agreement(train([1.0]), train([1.0], contacts=[1]), 0.1, 2.0) == 1.0


def test_motions_without_impacts_agree_to_the_end() -> None:
    assert agreement(train([]), train([]), 0.1, 2.0) == 2.0
    assert agreement(train([0.7]), train([]), 0.1, 2.0) == 0.7
