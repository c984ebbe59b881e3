"""Averaging: the slow flow against quadrature and finite differences, its solutions against exact motions."""

from __future__ import annotations

from math import atan, log, pi, sqrt
from typing import Any

import numpy as np
import pytest
from one_mode_forms import backbone, frequencies, narrowest, rates
from scipy.optimize import minimize_scalar

import vibeam
from vibeam.extensions.paper.averaging import AveragingSolver, Damping, SlowFlow, Stationary, averaged_motion, slow_flow
from vibeam.extensions.paper.mapping import FixedPoint, fixed_points
from vibeam.extensions.paper.one_mode import OneMode, Oscillator
from vibeam.flight.solver import FlightSolver
from vibeam.system.response import Ended

NOMINAL = Oscillator(0.015, 0.5e-3, 0.0, 0.9)
FORMS: tuple[Damping, ...] = ("paper", "log")


def system(model: Oscillator, **more: Any) -> vibeam.ImpactSystem:
    return vibeam.ImpactSystem.from_modes(
        1.0, model.damping, 1.0, 1.0, gap=model.gap, restitution=model.restitution, **more
    )


def exact(model: Oscillator, omega: float, periods: int = 1) -> FixedPoint:
    return fixed_points(model, omega, periods)[0]


def exact_reach(model: Oscillator, omega: float, periods: int = 1) -> float:
    return model.gap - exact(model, omega, periods).lowest()


def flown_reach(model: Oscillator, omega: float, settle: int) -> float:
    response, _ = FlightSolver(system(model), omega).steady([omega], model.drive, None, settle, 8, "contact")
    return float(response.reach[0])


# the slow flow


def quadrature(model: Oscillator, k: int, damping: Damping, reach: float, phase: float, omega: float) -> list[float]:
    """Mean rates of Q and ψ over one revolution of θ, from the transformed equation itself."""
    nodes, weights = np.polynomial.legendre.leggauss(60)
    total = np.zeros(2)
    for half in (0, 1):
        angle = pi * (half + (nodes + 1) / 2)
        z, rate, side = reach * np.sin(angle), reach * np.cos(angle), 1 - 2 * half
        push = side * (model.gap - omega**2 * model.drive * np.sin(2 * k * angle + phase)) - 2 * model.damping * rate
        assert np.all(side * z > 0)
        total += [weights @ (push * np.cos(angle)) / 4, weights @ (1 - push * np.sin(angle) / reach) / 4]
    loss = model.restitution
    total[0] -= reach * (1 - loss if damping == "paper" else -log(loss)) / pi  # two impacts in 2π
    return [float(total[0]), float(omega - 2 * k * total[1])]


@pytest.mark.parametrize("damping", FORMS)
@pytest.mark.parametrize("k", [1, 2, 3])
def test_slow_flow_is_the_quadrature_of_the_transformed_equation(k: int, damping: Damping) -> None:
    rng = np.random.default_rng(k)
    for _ in range(5):
        model = Oscillator(rng.uniform(0, 0.1), rng.normal(), rng.normal(), rng.uniform(0.3, 1))
        reach, phase, omega = rng.uniform(0.5, 3), rng.uniform(-pi, pi), 2 * k * rng.uniform(0.8, 1.2)
        found = rates(SlowFlow(model, k, damping), reach, phase, omega)
        np.testing.assert_allclose(found, quadrature(model, k, damping, reach, phase, omega), rtol=1e-12, atol=1e-13)
        off = Oscillator(model.damping, model.drive * (1 + 1e-9), model.gap, model.restitution)
        assert not np.allclose(found, rates(SlowFlow(off, k, damping), reach, phase, omega), rtol=1e-12, atol=1e-13)


def numeric_jacobian(flow: SlowFlow, reach: float, phase: float, omega: float) -> Any:
    step = 1e-6
    over_reach = np.subtract(
        rates(flow, reach * (1 + step), phase, omega), rates(flow, reach * (1 - step), phase, omega)
    )
    over_phase = np.subtract(rates(flow, reach, phase + step, omega), rates(flow, reach, phase - step, omega))
    return np.stack([over_reach / (2 * step * reach), over_phase / (2 * step)], axis=1)


@pytest.mark.parametrize("k", [1, 2, 3])
@pytest.mark.parametrize("drive", [0.5e-3, -0.5e-3])
def test_stationary_solutions_and_their_stability(k: int, drive: float) -> None:
    seen = set()
    for loose in (-1.3, -0.4, 0.0, 0.4, 1.3):
        flow = SlowFlow(Oscillator(0.01, drive, loose * 4 * k**2 * abs(drive) / (4 * k**2 - 1), 0.9), k)
        for omega in 2 * k * (1 + flow.decay * np.array([-2.0, -0.5, 0.0, 0.5, 2.0])):
            for found in flow.stationary(omega):
                shrink, turn = rates(flow, found.reach, found.phase, omega)
                assert abs(shrink) < 1e-14 * k
                assert abs(turn) < 1e-12 * k
                numeric = numeric_jacobian(flow, found.reach, found.phase, omega)
                wanted = flow.jacobian(found.reach, omega)
                scale = np.array([[1, found.reach], [1 / found.reach, 1]])
                np.testing.assert_allclose(numeric / scale, wanted / scale, atol=1e-8)
                assert found.stable is bool(np.all(np.linalg.eigvals(numeric).real < 0))
                assert found.stable is (found.reach > flow.least_stable(omega))
                seen.add(found.stable)
    assert seen == {True, False}


def test_the_stability_boundary_has_pi_not_pi_squared() -> None:
    gap, omega = 0.9e-3, 1.94
    slack = SlowFlow(Oscillator(0.015, 0.5e-3, gap, 0.9))
    drive = 0.5e-3 * gap / slack.largest_gap(omega)  # so that Δ = Δ_MAX
    flow = SlowFlow(Oscillator(0.015, drive * (1 + 1e-12), gap, 0.9))
    upper, lower = flow.stationary(omega)
    boundary = flow.least_stable(omega)
    assert upper.reach == pytest.approx(boundary, rel=1e-5)
    assert lower.reach == pytest.approx(boundary, rel=1e-5)
    assert abs(np.linalg.det(numeric_jacobian(flow, boundary, upper.phase, omega))) < 1e-6
    printed = boundary / pi
    assert abs(np.linalg.det(flow.jacobian(printed, omega))) > 1e-3
    assert not SlowFlow(Oscillator(0.015, drive * (1 - 1e-6), gap, 0.9)).stationary(omega)


@pytest.mark.parametrize("k", [1, 2])
def test_the_largest_gap_is_least_below_the_resonance(k: int) -> None:
    for restitution in (0.95, 0.8, 0.6):
        flow = SlowFlow(Oscillator(0.015, 0.5e-3, 0.0, restitution), k)
        spot = narrowest(flow)
        bracket = (2 * k * (1 - 10 * flow.decay**2), 2 * k * (1 + 6 * flow.decay**2))
        found = minimize_scalar(flow.largest_gap, bounds=bracket, method="bounded", options={"xatol": 1e-12})
        assert found.x == pytest.approx(spot, rel=1e-7)
        assert spot == pytest.approx(2 * k * (1 - 2 * flow.decay**2), rel=16 * flow.decay**4)
        assert spot != pytest.approx(2 * k, rel=flow.decay**2)


def test_gaps_bound_where_there_are_solutions() -> None:
    for omega in (1.92, 2.0, 2.05):
        least, greatest = SlowFlow(NOMINAL).gaps(omega)
        for edge, inward in ((least, 1e-9), (greatest, -1e-9)):
            inside = SlowFlow(Oscillator(0.015, 0.5e-3, edge + inward, 0.9)).stationary(omega)
            assert [s.stable for s in inside][:1] == [True]
            assert not SlowFlow(Oscillator(0.015, 0.5e-3, edge - inward, 0.9)).stationary(omega)


def test_frequencies_are_the_inverse_of_stationary() -> None:
    for gap in (-0.8e-3, 0.0, 0.8e-3):
        flow = SlowFlow(Oscillator(0.015, 0.5e-3, gap, 0.9))
        for omega in (1.94, 1.99, 2.03, 2.1):
            for found in flow.stationary(omega):
                assert min(abs(np.array(frequencies(flow, found.reach)) - omega)) < 1e-6
    top = flow.stationary(backbone(flow, 0.017))[0].reach
    assert top == pytest.approx(2 / pi * flow.force(backbone(flow, 0.017)) / flow.decay, rel=1e-3)


# its solutions against exact ones


def test_the_nominal_point() -> None:
    found = SlowFlow(NOMINAL).stationary(2.0)[0]
    assert found.reach == pytest.approx(1.8125e-2, abs=0.5e-6)
    assert exact_reach(NOMINAL, 2.0) == pytest.approx(1.753002e-2, abs=0.5e-8)


def test_sixteen_per_cent_at_strong_losses_and_far_less_with_the_logarithm() -> None:
    model = Oscillator(0.015, 0.5e-3, 0.0, 0.6)
    truth = exact_reach(model, 2.0)
    assert flown_reach(model, 2.0, 200) == pytest.approx(truth, rel=1e-9)
    paper, better = (SlowFlow(model, 1, damping).stationary(2.0)[0].reach for damping in FORMS)
    assert (paper - truth) / paper == pytest.approx(0.158, abs=0.001)  # of the averaged value, as the paper counts
    assert paper / truth - 1 == pytest.approx(0.187, abs=0.001)
    assert better / truth - 1 == pytest.approx(-0.049, abs=0.001)


@pytest.mark.parametrize(
    ("gap", "omega", "paper", "logarithm"),
    [(0.5e-3, 1.898, -0.023, -0.243), (0.0, 2.028, 0.182, -0.046), (-0.5e-3, 2.168, 0.319, 0.125)],
)
def test_the_logarithm_is_better_but_for_a_loose_gap(gap: float, omega: float, paper: float, logarithm: float) -> None:
    """At R = 0.6, at the peak of the exact curve: loose, the paper's error and that of Δ/Q cancel."""
    model = Oscillator(0.015, 0.5e-3, gap, 0.6)
    truth = exact_reach(model, omega)
    found = [SlowFlow(model, 1, damping).stationary(omega)[0].reach / truth - 1 for damping in FORMS]
    assert found == pytest.approx([paper, logarithm], abs=0.001)


def test_the_phase_needs_both_signs() -> None:
    for gap in (-0.3e-3, 0.0, 0.3e-3):
        for omega in (1.98, 2.0, 2.02):
            model = Oscillator(0.001, 0.5e-3, gap, 0.99)
            phase = SlowFlow(model).stationary(omega)[0].phase
            struck = omega * exact(model, omega).time
            miss = np.angle(np.exp(1j * (struck - phase)))
            assert abs(miss) < 0.03
            assert abs(np.angle(np.exp(1j * (struck - atan(np.tan(phase)))))) > 3  # as printed: off by π


CASES = [(1, 0.0, 0.0), (1, 0.3, -0.4), (1, -0.3, 0.3), (2, 0.0, 0.0), (2, -0.3, 0.3), (3, 0.0, 0.0), (3, 0.3, 0.3)]


def error(small: float, k: int, detuned: float, loose: float, damping: Damping) -> float:
    """Relative error of Q with β, 1−R, σ and Δ/Q all of order ``small``."""
    model = Oscillator(0.15 * small, 0.5e-3, loose * 0.5e-3, 1 - small)
    omega = 2 * k * (1 + detuned * small)
    return SlowFlow(model, k, damping).stationary(omega)[0].reach / exact_reach(model, omega, k) - 1


@pytest.mark.parametrize("damping", FORMS)
@pytest.mark.parametrize(("k", "detuned", "loose"), CASES)
def test_first_order(k: int, detuned: float, loose: float, damping: Damping) -> None:
    """The error falls as the small quantities; at Δ = 0 = σ with the logarithm as their squares."""
    fine, finer = (abs(error(small, k, detuned, loose, damping)) for small in (1 / 200, 1 / 400))
    order = 2 if damping == "log" and detuned == 0 else 1
    assert np.log2(fine / finer) == pytest.approx(order, abs=0.06)
    assert finer < 0.003


def test_the_limit_of_flown_motions() -> None:
    misses = []
    for small in (0.1, 0.05, 0.025):
        model = Oscillator(0.15 * small, 0.5e-3, 0.0, 1 - small)
        misses.append(SlowFlow(model).stationary(2.0)[0].reach / flown_reach(model, 2.0, int(40 / small)) - 1)
    np.testing.assert_allclose(np.divide(misses[:-1], misses[1:]), 2.0, atol=0.02)


# the solver


def test_hysteresis_of_a_loose_gap_as_flown() -> None:
    model = Oscillator(0.015, 0.5e-3, 0.8e-3, 0.9)
    grid = np.linspace(1.5, 2.1, 61)
    one = system(model)
    reaches = []
    for solver, settle in ((AveragingSolver(one), 0), (FlightSolver(one, 1.5), 300)):
        up, state = solver.steady(grid, model.drive, None, settle, 16, "contact")
        down, _ = solver.steady(grid[::-1], model.drive, state, settle, 16, "contact")
        reaches.append((up, down))
    (up, down), (flown_up, flown_down) = reaches
    strikes = [np.flatnonzero(response.period == 1) for response in (up, flown_up)]
    assert 1.9 < grid[strikes[0][-1]] < 2
    assert abs(int(strikes[0][-1]) - int(strikes[1][-1])) <= 2  # both jump down at the fold, 0.02 apart at most
    assert np.all(down.period[:40] == -1)
    assert np.all(flown_down.period[:40] == -1)
    free = down.period == -1
    np.testing.assert_allclose(
        down.reach[free & (flown_down.period == -1)], flown_down.reach[free & (flown_down.period == -1)], rtol=1e-6
    )
    near = (grid > 1.85) & (up.period == 1) & (flown_up.period == 1)
    assert np.count_nonzero(near) >= 8
    np.testing.assert_allclose(up.reach[near], flown_up.reach[near], rtol=0.1)


def test_si_in_si_out() -> None:
    own = {"gap": 2e-4, "restitution": 0.9, "static": -0.1, "outputs": {"sensor": [0.4]}}
    made = vibeam.ImpactSystem.from_modes(50.0, 0.015, -1.7, 0.6, **own)
    model = OneMode(made).oscillator(2e-4)
    assert (model.drive, model.gap) == pytest.approx((-1.7 * 0.6 * 2e-4, 2e-4 - 1.7 * 0.1 / 2500))
    for k, omega in ((1, 101.0), (2, 202.0)):
        solver = AveragingSolver(made, 90.0, resonance=k, damping="log", strikes_only=True)
        response, state = solver.steady([omega], 2e-4, None, 0, 8, "sensor")
        flown, _ = FlightSolver(made, omega).steady([omega], 2e-4, state, 200, 16, "sensor")
        found = SlowFlow(model, k, "log").stationary(omega / 50)[0]
        assert response.reach[0] == pytest.approx(found.reach)
        assert response.amplitude[0] == pytest.approx(0.4 / 1.7 * found.reach / 2)
        assert response.impact_velocity[0] == pytest.approx(50 * found.reach)
        assert response.frequency[0] == pytest.approx(omega / 2 / pi)
        assert (response.period[0], response.impacts_per_period[0]) == (k, 1 / k)
        assert np.count_nonzero(~np.isnan(response.impact_velocities)) == 8 // k
        assert (flown.period[0], flown.impacts_per_period[0]) == (k, 1 / k)
        for name in ("amplitude", "reach", "maximum", "minimum", "impact_velocity", "mode_energy"):
            np.testing.assert_allclose(getattr(response, name), getattr(flown, name), rtol=0.15, err_msg=name)
        flow, unit = slow_flow(made, 2e-4, resonance=k, damping="log")
        assert flow.stationary(omega / unit)[0].reach == response.reach[0]


@pytest.mark.parametrize("k", [1, 2, 3])
def test_the_motion_of_a_stationary_solution(k: int) -> None:
    flow = SlowFlow(Oscillator(0.015, 0.5e-3, 0.4, 0.9), k)
    motion = averaged_motion(flow, Stationary(1.3, 0.7, True))
    omega = 2.0 * k  # there the motion obeys q̈ + q = Δ between impacts, so that ż = Q cos θ is z's rate
    time = (np.arange(40000) + 0.5) * k * pi / omega / 20000
    angle = (omega * time - 0.7) / (2 * k)
    q, speed = 0.4 - 1.3 * np.abs(np.sin(angle)), -1.3 * np.cos(angle) * np.sign(np.sin(angle))
    assert (motion.mean, motion.square) == pytest.approx((np.mean(q), np.mean(q**2 + speed**2)), rel=1e-7)
    strobes = (np.arange(k) * 2 * pi - 0.7) / (2 * k)
    wanted = np.stack([0.4 - 1.3 * np.abs(np.sin(strobes)), -1.3 * np.cos(strobes) * np.sign(np.sin(strobes))], axis=1)
    np.testing.assert_allclose(np.sort(motion.places, axis=0), np.sort(wanted, axis=0), rtol=1e-12)
    assert (motion.high, motion.low, motion.velocity) == pytest.approx((0.4, -0.9, 1.3))


def test_a_curve_has_two_branches_as_far_as_the_fold() -> None:
    flow = SlowFlow(Oscillator(0.015, 0.5e-3, 0.8e-3, 0.9))
    upper, lower = flow.stationary(1.9)
    assert (upper.stable, lower.stable) == (True, False)
    assert upper.reach > flow.least_stable(1.9) > lower.reach > 0
    assert flow.largest_gap(1.9) > 0.8e-3
    assert flow.stationary(2.05) == ()


def test_a_point_without_motion_is_nan_with_its_reason() -> None:
    solver = AveragingSolver(system(Oscillator(0.015, 0.0, 1e-3, 0.9)), strikes_only=True)
    response, state = solver.steady([2.0, 2.1], 0.5e-3, None, 0, 8, "contact")
    assert [Ended.of_code(int(code)) for code in response.ended] == [Ended.NO_ORBIT] * 2
    assert np.all(np.isnan([response.amplitude, response.reach, response.impact_velocity]))
    assert (state.displacement[0], state.velocity[0]) == (0, 0)


def test_pressed_by_the_stop_and_weakly_driven_it_rests() -> None:
    solver = AveragingSolver(system(Oscillator(0.015, 0.0, -1e-2, 0.9)))
    response, state = solver.steady([2.0], 0.5e-3, None, 0, 8, "contact")
    assert state.resting
    assert (response.rest[0], response.period[0], response.amplitude[0]) == (1, 1, 0)


def test_what_it_cannot_take() -> None:
    two = vibeam.ImpactSystem.from_modes([1.0, 2.0], 0.1, 1.0, 1.0)
    with pytest.raises(ValueError, match="one mode, this system has 2"):
        AveragingSolver(two)
    for bad, message in (((0.0, 0.1), "no stiffness"), ((1.0, 1.2), "not underdamped")):
        with pytest.raises(ValueError, match=message):
            AveragingSolver(vibeam.ImpactSystem.from_modes(*bad, 1.0, 1.0))
    dead = vibeam.ImpactSystem.from_modes(1.0, 0.1, 1.0, 1.0, restitution=0.0)
    with pytest.raises(ValueError, match="'log' needs a restitution above 0"):
        AveragingSolver(dead, damping="log")
    with pytest.raises(ValueError, match=r"resonance: 0 .*; damping: 'exact'"):
        AveragingSolver(dead, resonance=0, damping="exact")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="beyond 16"):
        AveragingSolver(dead, resonance=17)
    with pytest.raises(ValueError, match=r"damping 1.5 .*; restitution 2"):
        Oscillator(1.5, 1.0, 0.0, 2.0)
    with pytest.raises(ValueError, match="1 finite number each"):
        AveragingSolver(dead).steady([2.0], 1.0, vibeam.State(np.zeros(2), np.zeros(2)), 0, 1, "contact")


def test_without_losses_nothing_is_stable() -> None:
    flow = SlowFlow(Oscillator(0.0, 0.5e-3, 0.0, 1.0))
    assert [s.stable for s in flow.stationary(2.1)] == [False]
    assert flow.stationary(2.0) == ()
    assert flow.stationary(2.1)[0].reach == pytest.approx(2 * 2.1**2 * 0.5e-3 / 3 / pi / 0.05)
    assert sqrt(2) < narrowest(flow) <= 2
