"""Error measures on responses and paths whose distances are known beforehand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stand_in import curve

from vibeam.studies.cost.measure import AperiodicSample, Measurement, Plan
from vibeam.studies.cost.reference import errors, sample_distance
from vibeam.studies.cost.row import front
from vibeam.studies.cost.trajectories import ComparedPath, distance, hausdorff, velocity_error
from vibeam.system.impact_system import Drive
from vibeam.system.response import Difference

GRID = np.array([1.0, 2.0, 3.0, 4.0, 5.0])
AMPLITUDE = np.array([1.0, 2.0, 4.0, 2.0, 1.0])
PLAN = Plan(2 * np.pi * GRID, np.ones(5), 1, 1, "contact", 8, 2, 1.0, Drive(2 * np.pi, 1.0))


def found(amplitude: object, period: object = 1, **more: object) -> Measurement:
    usual = {"impact_velocity": np.asarray(amplitude) * 2, "mode_energy": np.asarray(amplitude)[:, None] ** 2}
    return Measurement(curve(GRID, amplitude, period, **(usual | more)))


def test_a_run_beside_itself_is_without_error() -> None:
    same = errors(found(AMPLITUDE), found(AMPLITUDE), PLAN)
    assert same.amplitude == Difference(0.0, 0.0, 0.0, 5, 5)
    assert same.kind == 0


def test_known_distances_of_curves() -> None:
    off = errors(found(AMPLITUDE * [1.0, 1.03, 1.0, 0.96, 1.0]), found(AMPLITUDE), PLAN)
    assert off.amplitude.worst == pytest.approx(-0.04)
    assert off.amplitude.rms == pytest.approx(np.sqrt((0.03**2 + 0.04**2) / 5))
    assert off.amplitude.peak == 0


def test_only_points_where_both_repeat_are_compared() -> None:
    off = errors(found(AMPLITUDE * [9, 1, 1, 1, 1.5], [0, 1, 1, 1, 1]), found(AMPLITUDE, [1, 1, 1, 1, 0]), PLAN)
    assert (off.amplitude.points, off.kind, off.amplitude.worst) == (3, 2, 0)
    assert np.isnan(errors(found(AMPLITUDE, 0), found(AMPLITUDE, 0), PLAN).amplitude.worst)


def test_a_missing_point() -> None:
    truth = found(AMPLITUDE, [1, 1, 1, 1, 0])
    ended = np.array([0, 0, 5, 0, 0])
    gap = errors(found(AMPLITUDE * [1, 1, np.nan, 1, 1], ended=ended), truth, PLAN)
    assert np.isnan(gap.amplitude.peak)
    assert gap.amplitude.points == 3


def test_clouds_are_compared_by_statistics_and_not_point_by_point() -> None:
    values = np.linspace(1.0, 3.0, 101)
    cloud = AperiodicSample(values, values)
    assert sample_distance(AperiodicSample(values[::-1], np.roll(values, 7)), cloud) < 1e-15
    assert sample_distance(AperiodicSample(values + 0.2, values), cloud) == pytest.approx(0.1)
    wide = AperiodicSample(2 + 2 * (values - 2), values)  # the mean is the same, the upper decile goes from 2.8 to 3.6
    assert sample_distance(wide, cloud) == pytest.approx(0.8 / 2)
    runs = [replace(found(AMPLITUDE, [1, 1, 1, 1, 0]), clouds={4: each}) for each in (wide, cloud)]
    off = errors(*runs, PLAN)
    assert off.statistics == pytest.approx(0.4)
    assert off.scatter > 0.4  # this truth drifts: its halves have nothing in common
    assert off.amplitude.worst == 0


def test_matched_impacts() -> None:
    truth, speed = np.array([1.0, 2.0, 3.0, 4.0]), np.array([1.0, 1.0, 2.0, 1.0])
    assert velocity_error(truth + 0.01, speed * 1.1, truth, speed, 0.1) == pytest.approx(0.2)
    assert velocity_error(truth[[0, 1, 3]] - 0.02, speed[[0, 1, 3]], truth, speed, 0.1) == 0
    double, fast = np.array([1.0, 1.01, 2.0, 3.0, 4.0]), np.array([1, 9, 1, 2, 1.0])
    assert velocity_error(double, fast, truth, speed, 0.1) == 0
    assert np.isnan(velocity_error(truth + 0.2, speed, truth, speed, 0.1))
    assert np.isnan(velocity_error(np.empty(0), np.empty(0), truth, speed, 0.1))


def brute(one: np.ndarray, other: np.ndarray) -> float:
    """Every vertex against every segment of the other line, the segments cut into very many points."""
    shares = np.linspace(0, 1, 2001)[:, None, None]
    worst = 0.0
    for vertices, line in ((one, other), (other, one)):
        points = (line[:-1] + shares * np.diff(line, axis=0)).reshape(-1, 2)
        gaps = [np.min(np.hypot(*(points - vertex).T)) for vertex in vertices]
        worst = max(worst, *gaps)
    return worst


@pytest.mark.parametrize("seed", range(12))
def test_hausdorff_against_brute_force(seed: int) -> None:
    random = np.random.default_rng(seed)
    lines = [
        np.stack([np.sort(random.uniform(0, 3, n)), random.normal(size=n) * random.choice([0.1, 1, 5])], axis=1)
        for n in random.integers(2, 30, 2)
    ]
    assert hausdorff(*lines) == pytest.approx(brute(*lines), abs=2e-5, rel=2e-3)


def test_hausdorff_of_known_lines() -> None:
    t = np.linspace(0, 1, 50)
    flat, raised = np.stack([t, 0 * t], axis=1), np.stack([t, 0 * t + 0.25], axis=1)
    assert hausdorff(flat, raised) == 0.25
    tent = np.stack([[0.0, 1.0, 2.0], [0.0, 5.0, 0.0]], axis=1)  # its top is √26 … from the line's ends, 5 from it
    assert hausdorff(np.array([[0.0, 0.0], [2.0, 0.0]]), tent) == pytest.approx(5.0)
    assert hausdorff(flat, flat) == 0.0


def bounce(shift: float, offset: float = 0.0) -> ComparedPath:
    """|sin| with its corners at whole numbers + shift."""
    impacts = np.arange(0, 4) + 1 + shift
    times = np.union1d(np.linspace(0, 5, 801), impacts)
    return ComparedPath(lambda t: -np.abs(np.sin(np.pi * (t - shift))) + offset, times, impacts, np.ones(4))


def test_a_shifted_path_is_off_by_its_shift_and_no_more() -> None:
    off = distance(bounce(0.0), bounce(1e-3), 1.0, 1.0)
    assert 1e-3 / 2 < off <= 1e-3 * np.pi
    assert distance(bounce(0.0), bounce(0.0, 0.125), 1.0, 0.5) == pytest.approx(0.25)
    runs = [replace(found(AMPLITUDE), path=bounce(shift)) for shift in (1e-3, 0.0)]
    both = errors(*runs, replace(PLAN, drive=Drive(np.pi, 1.0)))
    assert both.impact_velocities == 0


def test_the_pareto_front() -> None:
    points = [(1.0, 3.0), (2.0, 1.0), (1.5, 2.0), (1.6, 2.5), (np.nan, 0.1), (3.0, 1.0), (0.5, np.nan), (1.0, 4.0)]
    assert front(points) == [0, 2, 1]
    assert front([]) == []


@given(st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)), max_size=30))
def test_the_front_is_what_nothing_beats(points: list[tuple[float, float]]) -> None:
    kept = {points[i] for i in front(points)}
    beaten = {p for p in points if any(q != p and q[0] <= p[0] and q[1] <= p[1] for q in points)}
    assert kept == set(points) - beaten


def test_samples_of_nothing_have_no_distance() -> None:
    """Of a truth that does not move: each is over the truth's mean, which is 0."""
    nothing, some = AperiodicSample(np.zeros(8), np.zeros(0)), AperiodicSample(np.ones(8), np.ones(8))
    for cloud in (nothing, some):
        assert np.isnan(sample_distance(cloud, nothing))
    assert sample_distance(some, some) == 0
