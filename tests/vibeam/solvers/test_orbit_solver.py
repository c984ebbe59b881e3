"""The orbit solver against the flight solver: the same steady points, found by formula."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vibeam.flight.solver import FlightSolver
from vibeam.solvers.orbit import OrbitSolver
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import Ended, FrequencyResponse
from vibeam.system.state import State

THREE = ImpactSystem.from_modes(
    [1.0, 5.3, 13.0], 0.02, [1.0, 1.5 / 5.3, -1.1 / 13], [1.0, 1 / 5.3, 1 / 13], gap=0.1, restitution=0.7,
    outputs={"sensor": [0.6, -0.4, 0.9]},
)  # fmt: skip
GRID = np.array([1.75, 1.9, 2.0, 2.1])
SAME = ("amplitude", "reach", "maximum", "minimum", "impact_velocity", "impacts_per_period", "period", "rest")


def both(system: ImpactSystem, grid: np.ndarray, amplitude: float, output: str) -> list[FrequencyResponse]:
    flight, orbit = FlightSolver(system, grid[0]), OrbitSolver(system, grid[0])
    return [
        solver.steady(grid, amplitude, None, settle, 8, output)[0] for solver, settle in ((flight, 900), (orbit, 0))
    ]


@pytest.mark.parametrize("output", ["contact", "sensor"])
def test_a_response_is_the_one_of_the_flight_solver(output: str) -> None:
    flight, orbit = both(THREE, GRID, 0.2, output)
    assert np.all(flight.period == 1)
    for name in SAME:
        np.testing.assert_allclose(getattr(orbit, name), getattr(flight, name), rtol=1e-8, atol=1e-9, err_msg=name)
    np.testing.assert_allclose(orbit.impact_velocities[:, 8:], flight.impact_velocities[:, 8:], rtol=1e-8)
    np.testing.assert_allclose(orbit.mode_energy, flight.mode_energy, rtol=1e-4, atol=1e-6)
    assert np.all(orbit.ended == 0)
    assert np.all(orbit.cpu_seconds > 0)
    other, _ = both(replace(THREE, restitution=0.7001), GRID, 0.2, output)
    assert not np.allclose(orbit.reach, other.reach, rtol=1e-6)


def test_where_nothing_is_touched_the_linear_response_is_given() -> None:
    flight, orbit = both(replace(THREE, gap=1.0), np.array([2.0, 3.0]), 0.05, "sensor")
    assert np.all(orbit.period == -1)
    for name in ("amplitude", "reach", "maximum", "minimum"):
        np.testing.assert_allclose(getattr(orbit, name), getattr(flight, name), rtol=1e-7, err_msg=name)


def test_a_point_without_such_a_motion_has_its_reason() -> None:
    solver = OrbitSolver(THREE, 0.7)
    response, last = solver.steady([0.7, 2.0, 0.7], 0.2, None, 0, 4, "contact")
    assert list(response.ended) == [Ended.NO_ORBIT.code, 0, Ended.NO_ORBIT.code]
    assert np.isnan(response.amplitude[[0, 2]]).all()
    assert np.isfinite(response.amplitude[1])
    assert isinstance(last, State)


def test_its_state_is_on_the_motion() -> None:
    _, last = OrbitSolver(THREE, 2.0).steady([2.0], 0.2, None, 0, 4, "contact")
    first, again = FlightSolver(THREE, 2.0).steady([2.0], 0.2, last, 0, 4, "contact")
    assert first.period[0] == 1
    np.testing.assert_allclose(again.displacement, last.displacement, atol=1e-11)


def test_longer_periods_and_wrong_ones() -> None:
    one = ImpactSystem.from_modes([1.0], 0.02, 1.0, 1.0, restitution=0.8)
    response, _ = OrbitSolver(one, 4.0, periods=2).steady([4.0], 1e-3, None, 0, 8, "contact")
    assert response.period[0] == 2
    assert response.impacts_per_period[0] == 0.5
    assert np.isfinite(response.impact_velocities).sum() == 4
    settled, _ = FlightSolver(one, 4.0).steady([4.0], 1e-3, _, 600, 8, "contact")
    assert settled.period[0] == 2
    np.testing.assert_allclose(response.reach, settled.reach, rtol=1e-9)
    with pytest.raises(ValueError, match="periods"):
        OrbitSolver(one, 4.0, periods=0)
    with pytest.raises(KeyError, match="nowhere"):
        OrbitSolver(one, 4.0).steady([4.0], 1e-3, None, 0, 8, "nowhere")
