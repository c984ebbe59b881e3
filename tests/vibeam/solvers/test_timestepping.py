"""Moreau–Jean time stepping against the exact flight solver."""

from __future__ import annotations

import numpy as np
import pytest
from convergence import B, sdof, three_modes

import vibeam
from vibeam.solvers.integration.moreau import MoreauSolver
from vibeam.system.response import Ended


def test_second_order_in_flight() -> None:
    """θ = ½ without impacts is the trapezoidal rule; θ = 1 is of first order."""
    system = vibeam.ImpactSystem.from_modes([1.0, 6.3], 0.02, [1.0, -0.8], [1.0, 0.5], gap=1.0)
    drive, t_end = vibeam.Drive(2.0, B), 10.0
    exact = vibeam.simulate(system, drive, t_end).state.displacement
    for theta, expected in ((0.5, 2.0), (1.0, 1.0)):
        solvers = [MoreauSolver(system, 2.0, steps=steps, theta=theta) for steps in (2000, 16_000)]
        errors = [np.abs(s.motion(drive, None, 0.0, t_end).state.displacement - exact) for s in solvers]
        found = np.log(errors[0] / errors[1]) / np.log(8)
        assert found == pytest.approx([expected] * 2, abs=0.15), f"θ = {theta}: orders {found}"


def test_settled_period_one_point() -> None:
    response, _ = MoreauSolver(sdof(), 2.0, steps=10_000).steady([2.0], B, None, 150, 6, "contact")
    exact = vibeam.sweep(sdof(), omega=[2.0], amplitude=B, settle=150, hold=6)
    assert response.reach[0] == pytest.approx(1.753002e-2, rel=1e-3)
    for quantity in ("reach", "amplitude", "impact_velocity", "mode_energy"):
        assert getattr(response, quantity) == pytest.approx(getattr(exact, quantity), rel=1e-3), quantity
    assert abs(response.reach[0] / exact.reach[0] - 1) > 1e-6, "1000 times finer would be another solver"
    assert (response.period[0], response.impacts_per_period[0], response.rest[0]) == (1, 1.0, 0.0)


def test_three_modes() -> None:
    system = three_modes()
    exact = vibeam.sweep(system, omega=[1.6], amplitude=B, settle=40, hold=6)
    found, _ = MoreauSolver(system, 1.6, steps=40_000, repeats=1e-2).steady([1.6], B, None, 40, 6, "contact")
    assert found.period[0] == exact.period[0] == 1
    assert found.impacts_per_period[0] == exact.impacts_per_period[0] == 4
    np.testing.assert_allclose(found.amplitude, exact.amplitude, rtol=2e-3)
    np.testing.assert_allclose(found.mode_energy, exact.mode_energy, rtol=2e-2)
    np.testing.assert_allclose(np.sort(found.impact_velocities), np.sort(exact.impact_velocities), rtol=2e-2)


def test_a_coarse_step_is_told_from_a_fine_one() -> None:
    """The bars above fail for a hundred steps a period."""
    found, _ = MoreauSolver(sdof(), 2.0, steps=100).steady([2.0], B, None, 150, 6, "contact")
    assert abs(found.reach[0] / 1.753002e-2 - 1) > 1e-3


def test_endless_bouncing_ends() -> None:
    """R = 1 on a pressed stop takes as long as anything else."""
    system, flat = sdof(gap=-1.0, restitution=1.0), vibeam.State(np.array([-1.0]), np.array([1e-2]))
    response, _ = MoreauSolver(system, 2.0).steady([2.0], B, flat, 2, 2, "contact")
    assert response.ended[0] == Ended.COMPLETE.code
    assert response.impacts[0] > 100


def test_without_damping_flight_keeps_its_energy() -> None:
    system = vibeam.ImpactSystem.from_modes([1.0, 6.3], 0.0, [1.0, -0.8], 0.0, gap=1.0)
    begin = vibeam.State(np.array([0.1, 0.02]), np.array([0.0, 0.1]))
    path = MoreauSolver(system, 1.0, steps=200).motion(vibeam.Drive(1.0, 0.0), begin, 0.0, 100.0)
    energy = path.values[:, 1] ** 2 + system.omega**2 * path.values[:, 0] ** 2
    np.testing.assert_allclose(energy, np.broadcast_to(energy[0], energy.shape), rtol=1e-11)
    lossy = MoreauSolver(system, 1.0, steps=200, theta=0.6).motion(vibeam.Drive(1.0, 0.0), begin, 0.0, 100.0)
    assert np.all(lossy.values[-1, 1] ** 2 + system.omega**2 * lossy.values[-1, 0] ** 2 < 0.9 * energy[0])


@pytest.mark.parametrize("options", [{"steps": 4}, {"theta": 0.4}, {"theta": 1.1}])
def test_options_out_of_range_are_refused(options: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=r"steps|theta"):
        MoreauSolver(sdof(), 1.0, **options)  # type: ignore[arg-type]
