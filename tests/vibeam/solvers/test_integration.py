"""Direct integration, Zhuravlev, Ivanov and Moreau–Jean time stepping against the exact flight solver."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from convergence import DRIVE, SOLVERS, B, jumps, mean_energy, sdof, start, three_modes

import vibeam
from vibeam.extensions.paper.ivanov import IvanovSolver
from vibeam.extensions.paper.zhuravlev import Distance, ZhuravlevSolver
from vibeam.observe.periodicity import repetition
from vibeam.solvers.integration.direct import DirectSolver
from vibeam.solvers.integration.impact_events import EventRun
from vibeam.solvers.integration.moreau import MoreauSolver
from vibeam.solvers.integration.samples import turning_points
from vibeam.system.response import Ended

EVENTS = ("direct", "zhuravlev")
ODES = (*EVENTS, "ivanov")
TIGHT: dict[str, Any] = {"method": "DOP853", "rtol": 1e-10, "atol": 1e-13}


@pytest.mark.parametrize(
    ("name", "options", "bar", "energy", "apart"),
    [(name, {}, 3e-3, 9e-3, 1e-13) for name in ODES]
    + [(name, TIGHT, 1e-8, 1e-6, 1e-13) for name in ODES]
    + [("moreau", {"steps": 10_000}, 5e-4, 1e-3, 1e-6)],
)
def test_settled_period_one_point(name: str, options: dict[str, Any], bar: float, energy: float, apart: float) -> None:
    """Within the bars of the exact solution, and no closer to it than a numerical one can be."""
    response, _ = SOLVERS[name](sdof(), 2.0, **options).steady([2.0], B, None, 150, 6, "contact")
    exact = vibeam.sweep(sdof(), omega=[2.0], amplitude=B, settle=150, hold=6)
    assert response.reach[0] == pytest.approx(1.753002e-2, rel=max(bar, 1e-6))
    assert response.mode_energy == pytest.approx(exact.mode_energy, rel=energy)
    for quantity in ("reach", "amplitude", "minimum", "impact_velocity"):
        assert getattr(response, quantity) == pytest.approx(getattr(exact, quantity), rel=2 * bar), quantity
    assert abs(response.reach[0] / exact.reach[0] - 1) > apart, "the exact one is another solver"
    assert response.impacts_per_period[0] == 1.0
    assert response.period[0] == 1
    assert response.rest[0] == 0.0


@pytest.mark.parametrize(
    ("name", "options", "near"), [("direct", TIGHT, 1e-7), ("moreau", {"steps": 40_000, "repeats": 1e-2}, 2e-3)]
)
def test_three_modes(name: str, options: dict[str, Any], near: float) -> None:
    system, grid = three_modes(), [1.6]
    exact = vibeam.sweep(system, omega=grid, amplitude=B, settle=40, hold=6)
    found, _ = SOLVERS[name](system, 1.6, **options).steady(grid, B, None, 40, 6, "contact")
    assert exact.period[0] == found.period[0] == 1
    assert found.impacts_per_period[0] == exact.impacts_per_period[0] == 4
    np.testing.assert_allclose(found.amplitude, exact.amplitude, rtol=near)
    np.testing.assert_allclose(found.mode_energy, exact.mode_energy, rtol=10 * near)
    np.testing.assert_allclose(found.impact_velocities, exact.impact_velocities, rtol=10 * near)


def test_no_contact_has_period_minus_one() -> None:
    for name in ODES:
        response, _ = SOLVERS[name](sdof(gap=1.0), 2.0).steady([2.0], B, None, 2, 3, "contact")
        assert response.period[0] == -1, name
        assert np.isnan(response.impact_velocity[0])


def test_zhuravlev_jumps_at_impacts_only() -> None:
    path = ZhuravlevSolver(sdof(), 2.0).motion(DRIVE, start(), 0.0, 40.0)
    velocity = path.velocity()
    at = jumps(path.times, velocity, most=0.05)
    assert len(at) == len(path.impact_times) > 5
    np.testing.assert_array_equal(path.times[at], path.impact_times)
    np.testing.assert_allclose(velocity[at + 1], -0.9 * velocity[at], rtol=1e-12)
    np.testing.assert_array_equal(velocity[at], path.impact_velocities)


def test_the_jump_check_sees_the_spurious_jump() -> None:
    """sgn z taken on the wrong side of the root: the first sample behind an impact has the old sign (Fig. 5)."""
    path = ZhuravlevSolver(sdof(), 2.0).motion(DRIVE, start(), 0.0, 40.0)
    velocity = path.velocity()
    velocity[jumps(path.times, velocity, most=0.05) + 1] *= -1
    assert len(jumps(path.times, velocity, most=0.05)) > len(path.impact_times)


@pytest.mark.parametrize("contact", [1.0, -1.3])
def test_coordinates_of_the_distance(contact: float) -> None:
    """x'' + 2ζωx' + ω²x = N(t) is the modal equation, mirrored."""
    system = vibeam.ImpactSystem.from_modes([1.7], 0.1, contact, 0.8, gap=0.3, restitution=0.5, static=0.2)
    x = Distance.of(system, DRIVE)
    q, slope, t = 0.11, -0.23, 0.7
    force = 0.8 * DRIVE.omega**2 * DRIVE.amplitude * np.sin(DRIVE.omega * t) + 0.2
    acceleration = force - 2 * 0.1 * 1.7 * slope - 1.7**2 * q
    distance, rate = x.distance(vibeam.State(np.array([q]), np.array([slope])))
    assert x.load(t) - x.damping * rate - x.stiffness * distance == pytest.approx(-contact * acceleration, rel=1e-13)
    back = x.modal(np.array([distance]), np.array([rate]))[0, :, 0]
    np.testing.assert_allclose(back, [q, slope], rtol=1e-14)


@pytest.mark.parametrize("name", [*ODES, "moreau"])
def test_a_bouncing_ball_comes_to_rest(name: str) -> None:
    """h = 1 m, R = ½: impacts at √(2h/g), all over after t₁(1+R)/(1−R)."""
    g = 9.81
    ball = vibeam.ImpactSystem.from_modes([0.0], 0.0, 1.0, 1.0, restitution=0.5, static=g)
    first = np.sqrt(2 / g)
    options: dict[str, Any] = {"steps": 20_000} if name == "moreau" else {"rtol": 1e-8, "atol": 1e-8}
    drop = vibeam.State(np.array([-1.0]), np.array([0.0]))
    path = SOLVERS[name](ball, 1.0, **options).motion(vibeam.Drive(0.0, 0.0), drop, 0.0, 3.0)
    times = first * np.array([1.0, 2.0, 2.5, 2.75])
    np.testing.assert_allclose(path.impact_times[:4], times, rtol=3e-4 if name == "moreau" else 1e-6)
    assert path.rest == pytest.approx(3.0 - 3 * first, abs=1e-3)
    assert path.ended is Ended.COMPLETE
    assert abs(float(path.state.displacement[0])) < 1e-4


@pytest.mark.parametrize("name", [*ODES, "moreau"])
@pytest.mark.parametrize(("gap", "restitution"), [(-0.5e-3, 0.2), (-1.5e-3, 0.5), (-5e-3, 0.9)])
def test_rest_on_a_pressed_stop(name: str, gap: float, restitution: float) -> None:
    """Part of each period, or all of it, at rest."""
    system = sdof(gap, restitution)
    exact = vibeam.sweep(system, omega=[1.2], amplitude=B, settle=20, hold=6)
    response, state = SOLVERS[name](system, 1.2).steady([1.2], B, None, 20, 6, "contact")
    assert exact.rest[0] > 0.1
    assert response.ended[0] == Ended.COMPLETE.code
    assert response.rest[0] == pytest.approx(exact.rest[0], abs=0.02)
    assert response.reach[0] == pytest.approx(exact.reach[0], rel=0.02, abs=1e-9)
    assert float(system.contact @ state.displacement) <= gap + 1e-12


def test_rest_of_three_modes() -> None:
    """The held system moves on: modes 2 and 3 ring while the contact stands still."""
    pressed = vibeam.ImpactSystem.from_modes(
        [1.0, 6.3, 17.5], 0.02, [1.0, -0.8, 0.6], [1.0, 0.5, 0.2], gap=-1.2e-3, restitution=0.3
    )
    solver = DirectSolver(pressed, 1.6, **TIGHT)
    begin = solver.steady([1.6], B, None, 19, 1, "contact")[1]
    response, _ = solver.steady([1.6], B, begin, 0, 6, "contact")
    exact = vibeam.sweep(pressed, omega=[1.6], amplitude=B, settle=0, hold=6, state=begin)
    assert 0.1 < exact.rest[0] < 0.9
    np.testing.assert_allclose(response.rest, exact.rest, atol=1e-3)
    np.testing.assert_allclose(response.mode_energy[0], mean_energy(pressed, 1.6, begin, 6), rtol=1e-4)


@pytest.mark.parametrize(("name", "limit"), [("direct", 20), ("zhuravlev", 20), ("ivanov", 300)])
def test_endless_bouncing_is_bounded(name: str, limit: int) -> None:
    """R = 1 on a strongly pressed stop: flights stay short for ever."""
    system, flat = sdof(gap=-1.0, restitution=1.0), vibeam.State(np.array([-1.0]), np.array([1e-2]))
    response, state = SOLVERS[name](system, 2.0, limit=limit).steady([2.0, 2.1], B, flat, 2, 2, "contact")
    assert response.ended[0] == Ended.EVENT_LIMIT.code
    assert np.isnan(response.amplitude[0])
    assert response.ended[1] == Ended.COMPLETE.code, "the next point starts from equilibrium"
    assert response.rest[1] == pytest.approx(1.0)
    assert state.displacement[0] == pytest.approx(-1.0)


def test_a_mode_that_is_far_too_fast_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """An explicit method follows its rate of 2e7 1/s: a drive period would take millions of evaluations."""
    monkeypatch.setattr("vibeam.solvers.integration.impact_events.EVALUATIONS", 2000)
    stiff = vibeam.ImpactSystem.from_modes([1.0], 1e7, [1.0], [1.0], gap=1.0, restitution=0.7)
    response, _ = DirectSolver(stiff, 2.0).steady([2.0], B, None, 0, 1, "contact")
    assert (response.ended[0], response.evaluations[0]) == (Ended.UNRESOLVED.code, 2002)


def test_a_short_flight_from_the_stop_is_not_lost() -> None:
    """The whole flight lies within the integrator's first step."""
    system, speed = sdof(gap=-1.0), 1e-3
    away = vibeam.State(np.array([-1.0]), np.array([-speed]))
    for name in EVENTS:
        path = SOLVERS[name](system, 2.0, **TIGHT).motion(vibeam.Drive(0.0, 0.0), away, 0.0, 0.003)
        assert path.impact_times[0] == pytest.approx(2 * speed, rel=1e-3), name
        assert path.impact_velocities[0] == pytest.approx(speed, rel=1e-4), name


def dip(method: str) -> tuple[int, int]:
    """Impacts found and true: u = sin t + 0.001 sin 9t passes the stop for 0.02 s near t = π/2."""
    system = vibeam.ImpactSystem.from_modes([1.0, 9.0], 0.0, [1.0, 0.02], 0.0, gap=1.00095, restitution=0.8)
    begin, still = vibeam.State(np.zeros(2), np.array([1.0, 0.45])), vibeam.Drive(1.0, 0.0)
    path = DirectSolver(system, 1.0, method=method, rtol=1e-5, atol=1e-6).motion(still, begin, 0.0, 3.0)
    return len(path.impact_times), len(vibeam.simulate(system, still, 3.0, begin).impact_times)


@pytest.mark.parametrize("method", ["RK23", "RK45", "DOP853", "LSODA"])
def test_a_dip_inside_one_step_is_found(method: str) -> None:
    found, true = dip(method)
    assert found == true > 0


def test_without_the_search_the_dip_is_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(EventRun, "_missed_passage", lambda *_: None)
    assert dip("DOP853")[0] == 0


def test_a_start_beyond_the_stop_is_refused() -> None:
    inside = vibeam.State(np.array([0.1]), np.array([0.0]))
    for name in (*ODES, "moreau"):
        path = SOLVERS[name](sdof(), 2.0).motion(DRIVE, inside, 0.0, 1.0)
        assert path.ended is Ended.PENETRATED, name


@pytest.mark.parametrize(
    ("kind", "system", "options", "message"),
    [
        (ZhuravlevSolver, three_modes(), {}, "one mode, this system has 3"),
        (IvanovSolver, three_modes(), {}, "one mode, this system has 3"),
        (IvanovSolver, sdof(restitution=0.0), {}, "restitution 0"),
        (IvanovSolver, sdof(), {"method": "LSODA"}, "none of RK23, RK45, DOP853"),
        (DirectSolver, sdof(), {"method": "RK4"}, "'RK4' is none of RK23, RK45, DOP853, LSODA"),
        (DirectSolver, sdof(), {"rtol": 0.0}, "rtol: 0.0"),
        (DirectSolver, sdof(), {"atol": -1.0}, "atol: -1.0"),
        (DirectSolver, sdof(), {"limit": 0}, "limit: 0"),
        (MoreauSolver, sdof(), {"steps": 4}, "steps"),
        (MoreauSolver, sdof(), {"theta": 0.4}, "theta"),
        (MoreauSolver, sdof(), {"theta": 1.1}, "theta"),
    ],
)
def test_what_cannot_be_is_refused_at_once(kind: Any, system: Any, options: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        kind(system, 1.0, **options)


def test_a_state_or_times_of_the_wrong_shape_are_refused() -> None:
    solver = DirectSolver(sdof(), 1.0)
    with pytest.raises(ValueError, match="1 finite number each"):
        solver.steady([2.0], B, start(3), 1, 1, "contact")
    with pytest.raises(ValueError, match="t_end"):
        solver.motion(DRIVE, None, 1.0, 1.0)


def test_repetition_tells_periods_apart() -> None:
    strobes = np.zeros((13, 2, 1))
    strobes[:, 0, 0] = 1.0 + 1e-3 * (np.arange(13) % 3)
    assert repetition(strobes, np.ones(1), 1.0, 1e-4) == 3
    assert repetition(strobes, np.ones(1), 1.0, 1e-2) == 1
    strobes[-1] += 1e-2
    assert repetition(strobes, np.ones(1), 1.0, 1e-4) == 0


def test_turning_points_of_a_cubic_are_exact() -> None:
    t = np.array([0.0, 2.0])
    shares, heights = turning_points(t, t**3 - 3 * t, 3 * t**2 - 3)
    assert np.min(heights) == pytest.approx(-2.0, rel=1e-14)
    assert 2 * shares.ravel()[np.argmin(heights)] == pytest.approx(1.0, rel=1e-14)


def test_moreaus_order_in_flight() -> None:
    """θ = ½ without impacts is the trapezoidal rule; θ = 1 is of first order."""
    system = vibeam.ImpactSystem.from_modes([1.0, 6.3], 0.02, [1.0, -0.8], [1.0, 0.5], gap=1.0)
    drive, t_end = vibeam.Drive(2.0, B), 10.0
    exact = vibeam.simulate(system, drive, t_end).state.displacement
    for theta, expected in ((0.5, 2.0), (1.0, 1.0)):
        solvers = [MoreauSolver(system, 2.0, steps=steps, theta=theta) for steps in (2000, 16_000)]
        errors = [np.abs(s.motion(drive, None, 0.0, t_end).state.displacement - exact) for s in solvers]
        found = np.log(errors[0] / errors[1]) / np.log(8)
        assert found == pytest.approx([expected] * 2, abs=0.15), f"θ = {theta}: orders {found}"


def test_a_coarse_step_is_told_from_a_fine_one() -> None:
    """The bars above fail for a hundred steps a period."""
    found, _ = MoreauSolver(sdof(), 2.0, steps=100).steady([2.0], B, None, 150, 6, "contact")
    assert abs(found.reach[0] / 1.753002e-2 - 1) > 1e-3


def test_endless_bouncing_ends_for_moreau() -> None:
    """R = 1 on a pressed stop takes as long as anything else."""
    system, flat = sdof(gap=-1.0, restitution=1.0), vibeam.State(np.array([-1.0]), np.array([1e-2]))
    response, _ = MoreauSolver(system, 2.0).steady([2.0], B, flat, 2, 2, "contact")
    assert response.ended[0] == Ended.COMPLETE.code
    assert response.impacts[0] > 100


def test_without_damping_moreaus_flight_keeps_its_energy() -> None:
    system = vibeam.ImpactSystem.from_modes([1.0, 6.3], 0.0, [1.0, -0.8], 0.0, gap=1.0)
    begin = vibeam.State(np.array([0.1, 0.02]), np.array([0.0, 0.1]))
    path = MoreauSolver(system, 1.0, steps=200).motion(vibeam.Drive(1.0, 0.0), begin, 0.0, 100.0)
    energy = path.values[:, 1] ** 2 + system.omega**2 * path.values[:, 0] ** 2
    np.testing.assert_allclose(energy, np.broadcast_to(energy[0], energy.shape), rtol=1e-11)
    lossy = MoreauSolver(system, 1.0, steps=200, theta=0.6).motion(vibeam.Drive(1.0, 0.0), begin, 0.0, 100.0)
    assert np.all(lossy.values[-1, 1] ** 2 + system.omega**2 * lossy.values[-1, 0] ** 2 < 0.9 * energy[0])
