"""Memory of fits and comparisons grows in proportion to the samples, never to their square."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam.studies.fit.linear_estimates import directions_of
from vibeam.studies.fit.words import on_directions
from vibeam.studies.regression.check import _off_grid

SAMPLES = 12_000  # a square matrix of so many rows takes 1.15 GB
A_SAMPLE = 1_000  # bytes: what is measured is 240 to 290


def noise(count: int) -> np.ndarray:
    return 1e-3 * np.random.default_rng(1).normal(size=count)


def decay(count: int) -> Any:
    time = np.linspace(0.0, 40.0, count)
    return vibeam.identify_decay(time, np.exp(-0.5 * time) * np.cos(50.0 * time) + noise(count))


def response(count: int) -> Any:
    ratio = np.linspace(0.5, 1.5, count)
    return vibeam.identify_response(10.0 * ratio, ratio**2 / np.abs(1 - ratio**2 + 0.04j * ratio) * (1 + noise(count)))


def spectrum(count: int) -> Any:
    ratio = np.linspace(0.8, 1.2, count)
    return vibeam.identify_spectrum(10.0 * ratio, (1 + noise(count)) / np.abs(1 - ratio**2 + 0.04j * ratio))


def words_of_a_fit(count: int) -> Any:
    minimum: Any = SimpleNamespace(jacobian=np.random.default_rng(1).normal(size=(count, 4)))
    problem: Any = SimpleNamespace(keys=[])
    return list(on_directions(problem, minimum))


def points_between_those_of_a_sweep(count: int) -> Any:
    points = [SimpleNamespace(frequency=each) for each in np.linspace(10.0, 20.0, count).tolist()]
    case: Any = SimpleNamespace(
        sweep=SimpleNamespace(frequency=np.linspace(10.0, 20.0, 1_001)),
        references={"laser": SimpleNamespace(points=lambda: points)},
    )
    return _off_grid(case, "laser", case, False)


SIGNALS = [pytest.param(each, marks=pytest.mark.extension) for each in (decay, response, spectrum)]


@pytest.mark.parametrize("made", [*SIGNALS, words_of_a_fit, points_between_those_of_a_sweep])
def test_memory_is_in_proportion_to_the_samples(made: Callable[[int], Any]) -> None:
    made(100)  # what is imported and kept is no part of it
    tracemalloc.start()
    try:
        made(SAMPLES)
        assert tracemalloc.get_traced_memory()[1] < A_SAMPLE * SAMPLES
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("shape", [(40, 3), (3, 3), (2, 4), (1, 3)])
def test_directions_are_those_of_the_whole_decomposition(shape: tuple[int, int]) -> None:
    jacobian = np.random.default_rng(shape[0]).normal(size=shape)
    singular, rows = directions_of(jacobian)
    known = np.linalg.svd(jacobian)[1]
    assert singular == pytest.approx(np.append(known, np.zeros(shape[1] - len(known))), rel=1e-12)
    assert rows @ rows.T == pytest.approx(np.eye(shape[1]), abs=1e-12)
    assert rows.T * singular**2 @ rows == pytest.approx(jacobian.T @ jacobian, abs=1e-11)


def test_points_of_a_measured_curve_that_lie_between_those_of_a_sweep() -> None:
    points = [SimpleNamespace(frequency=each) for each in (9.0, 10.0, 10.4, 11.0 * (1 + 1e-12), 11.9, 12.0, 12.5)]
    case: Any = SimpleNamespace(
        sweep=SimpleNamespace(frequency=np.array([10.0, 11.0, 12.0])),
        references={"laser": SimpleNamespace(points=lambda: points)},
    )
    assert _off_grid(case, "laser", case, False).tolist() == [10.4, 11.9]
