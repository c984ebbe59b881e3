"""Pointwise mapping: fixed points, Jacobians and verdicts against differences, saltation matrices and flights."""

from __future__ import annotations

from dataclasses import replace
from math import pi
from typing import Any

import numpy as np
import pytest
from one_mode_forms import impact_map, iterated, verdicts
from scipy.linalg import expm

import vibeam
import vibeam.solvers
from vibeam.extensions.paper.mapping import (
    FORMS,
    Form,
    Impact,
    ImpactMap,
    MappingSolver,
    fixed_points,
    flight_invariants,
    flight_solver,
    orbit_invariants,
)
from vibeam.extensions.paper.one_mode import Oscillator
from vibeam.flight.solver import FlightSolver
from vibeam.system.response import Branches, Ended

NOMINAL = Oscillator(0.015, 0.5e-3, 0.0, 0.9)
LOOSE = Oscillator(0.015, 0.5e-3, 0.5e-3, 0.9)
LOST = 2.2807625  # where period 1 of LOOSE loses stability: a multiplier passes −1


def system(model: Oscillator) -> vibeam.ImpactSystem:
    return vibeam.ImpactSystem.from_modes(1.0, model.damping, 1.0, 1.0, gap=model.gap, restitution=model.restitution)


def random_model(rng: Any) -> Oscillator:
    return Oscillator(rng.uniform(0, 0.2), 1.0, rng.uniform(-1, 1.5), rng.uniform(0.2, 0.95))


# fixed points


def test_the_nominal_point() -> None:
    (orbit,) = fixed_points(NOMINAL, 2.0)
    assert -orbit.lowest() == pytest.approx(1.753002e-2, abs=0.5e-8)


def test_printed_forms_misjudge_the_orbit_of_coco() -> None:
    """ẍ + 0.1ẋ + x = cos t, stop at 1, e = 0.8; the orbit is in tests/others/test_systems.py."""
    (orbit,) = fixed_points(Oscillator(0.05, 1.0, 1.0, 0.8), 1.0)
    upper, lower = orbit_invariants(orbit).multipliers
    assert upper == pytest.approx(complex(-0.584295, 0.005600), abs=0.7e-6)
    assert lower == upper.conjugate()
    assert orbit_invariants(orbit, "printed 35-37").multipliers[0] != pytest.approx(upper, abs=0.1)


def test_fixed_points_are_fixed() -> None:
    rng = np.random.default_rng(3)
    stayed = 0
    for _ in range(60):
        model, omega, n = random_model(rng), rng.uniform(0.6, 5), int(rng.integers(1, 4))
        for orbit in fixed_points(model, omega, n):
            start, end = orbit.place(0.0), orbit.place(orbit.duration)
            assert start[0] == pytest.approx(model.gap, abs=1e-12)
            assert end == pytest.approx([model.gap, orbit.velocity], abs=1e-11)
            assert start[1] == pytest.approx(-model.restitution * orbit.velocity, abs=1e-12)
            flights = impact_map(model, omega)
            inside = [orbit.place(t)[0] for t in np.linspace(0, orbit.duration, 400)[1:-1]]
            assert orbit.admissible(flights) or max(inside) > model.gap - 1e-3
            if orbit.admissible(flights):
                stayed += 1
                assert max(inside) < model.gap
                again = flights.next(orbit.impact)
                assert again.time == pytest.approx(orbit.time + orbit.duration, abs=1e-9)
                assert again.velocity == pytest.approx(orbit.velocity, rel=1e-7)
    assert stayed > 20


def test_no_orbits_where_the_free_vibration_repeats() -> None:
    assert fixed_points(Oscillator(0.0, 1.0, 0.0, 0.8), 1.0) == ()
    assert fixed_points(Oscillator(0.1, 0.0, 0.5, 0.8), 2.0) == ()


# the Jacobian


def random_flights(count: int) -> list[tuple[ImpactMap, Impact, Impact]]:
    rng = np.random.default_rng(7)
    found = []
    while len(found) < count:
        model, omega = random_model(rng), rng.uniform(0.6, 4)
        flights = impact_map(model, omega)
        start = Impact(rng.uniform(0, flights.period), rng.uniform(0.3, 3))
        end = flights.next(start)
        if end.velocity > 0.3 and end.flight > 0.3:
            found.append((flights, start, end))
    return found


def differences(flights: ImpactMap, start: Impact, after: bool = False) -> Any:
    """Jacobian of the map by central differences; ``after``: of (t, q̇₊) → (t, q̇₊)."""
    step, loss = 1e-5, flights.oscillator.restitution
    columns = []
    for by in ((step, 0.0), (0.0, step)):
        scale = -1 / loss if after else 1.0
        ends = [flights.next(Impact(start.time + s * by[0], start.velocity + s * scale * by[1])) for s in (1, -1)]
        values = [(e.time, e.velocity * (-loss if after else 1.0)) for e in ends]
        columns.append(np.subtract(*values) / (2 * step))
    return np.stack(columns, axis=1)


@pytest.mark.parametrize("after", [False, True])
def test_trace_and_determinant_of_a_flight_against_differences(after: bool) -> None:
    worst = 1.0
    for flights, start, end in random_flights(25):
        jacobian = differences(flights, start, after)
        size = 1 + float(np.max(np.abs(jacobian))) ** 2
        found = flight_invariants(flights.oscillator, flights.omega, start, end)
        assert abs(found.trace - np.trace(jacobian)) < 1e-6 * size
        assert abs(found.determinant - np.linalg.det(jacobian)) < 1e-6 * size
        late = Impact(start.time + 0.01, start.velocity)  # another flight's formula is told apart
        worst = min(worst, abs(flight_invariants(flights.oscillator, flights.omega, late, end).trace - found.trace))
    assert worst > 1e-5


def monodromy(model: Oscillator, omega: float, orbit: Any) -> Any:
    """Saltation matrix times the flow's matrix exponential, on (q, q̇), from any of the orbit's flights."""
    matrix = np.array([[0.0, 1.0], [-1.0, -2 * model.damping]])
    push, speed, loss = model.force(omega, orbit.time), orbit.velocity, model.restitution
    before = matrix @ [model.gap, speed] + [0, push]
    after = matrix @ [model.gap, -loss * speed] + [0, push]
    reset, normal = np.diag([1.0, -loss]), np.array([1.0, 0.0])
    return (reset + np.outer(after - reset @ before, normal) / (normal @ before)) @ expm(matrix * orbit.duration)


def eq_29_and_30(model: Oscillator, omega: float, impacts: list[Impact]) -> tuple[float, float]:
    """Trace and determinant, symbol by symbol as printed, of impacts i − 1, i, i + 1."""
    first, second, third = impacts
    beta, r, rate, tau = model.damping, model.restitution, model.damped, second.time - first.time
    leaving = -r * first.velocity
    n = model.drive * omega**2 * np.sin(omega * first.time) - beta * leaving - model.gap  # eq. 32
    inner = (n + r * beta * second.velocity) * np.sin(rate * tau)
    inner += rate * (leaving - r * second.velocity) * np.cos(rate * tau)
    trace = -np.exp(-beta * tau) / (rate * third.velocity) * inner
    return float(trace), float(-r * leaving / second.velocity * np.exp(-2 * beta * tau))


def eq_35_to_37(model: Oscillator, omega: float, orbit: Any) -> tuple[float, float]:
    """Trace and determinant, symbol by symbol as printed, of a motion of n drive periods."""
    beta, r, rate, time = model.damping, model.restitution, model.damped, orbit.periods * 2 * pi / omega
    n = model.drive * omega**2 * np.sin(omega * orbit.time) + r * beta * orbit.velocity - model.gap  # eq. 37
    inner = (r * beta * orbit.velocity + n) * np.sin(rate * time) - 2 * rate * r * orbit.velocity * np.cos(rate * time)
    trace = np.exp(-beta * time) / (rate * orbit.velocity) * inner
    return float(trace), float(r**2 * np.exp(-beta * time))


def test_the_printed_form_of_a_flight_symbol_by_symbol() -> None:
    told_apart = 0
    for flights, start, end in random_flights(10):
        model, following = flights.oscillator, flights.next(end)
        if not following.velocity > 0:
            continue
        found = flight_invariants(model, flights.omega, start, end, following)
        expected = eq_29_and_30(model, flights.omega, [start, end, following])
        assert (found.trace, found.determinant) == pytest.approx(expected, rel=1e-7)
        told_apart += abs(found.trace / flight_invariants(model, flights.omega, start, end).trace - 1) > 0.01
    assert told_apart > 5


def test_at_a_fixed_point_the_printed_traces_differ_by_their_sign() -> None:
    for orbit in fixed_points(LOOSE, 2.2):
        flight, simplified = (orbit_invariants(orbit, form) for form in ("printed 29-30", "printed 35-37"))
        assert flight.trace == pytest.approx(-simplified.trace, rel=1e-12)
        assert flight.determinant == pytest.approx(orbit_invariants(orbit).determinant, rel=1e-12)


def test_invariants_of_an_orbit_against_the_saltation_matrix() -> None:
    rng = np.random.default_rng(5)
    count, wrong = 0, []
    for _ in range(60):
        model, omega, n = random_model(rng), rng.uniform(0.6, 4), int(rng.integers(1, 4))
        for orbit in fixed_points(model, omega, n):
            whole = monodromy(model, omega, orbit)
            size = 1 + float(np.max(np.abs(whole)))
            found = orbit_invariants(orbit)
            assert found.trace == pytest.approx(float(np.trace(whole)), abs=1e-11 * size)
            assert found.determinant == pytest.approx(float(np.linalg.det(whole)), abs=1e-11 * size**2)
            along = flight_invariants(model, omega, orbit.impact, orbit.impact)
            assert (along.trace, along.determinant) == pytest.approx((found.trace, found.determinant), abs=1e-10 * size)
            printed = orbit_invariants(orbit, "printed 35-37")
            assert (printed.trace, printed.determinant) == pytest.approx(eq_35_to_37(model, omega, orbit), rel=1e-12)
            wrong.append(abs(printed.determinant / found.determinant - 1) > 0.01)
            count += 1
    assert count > 40
    assert np.mean(wrong) > 0.9


def test_stability_is_what_iterates_do() -> None:
    for model, omega, stays in ((NOMINAL, 2.0, True), (LOOSE, 2.2, True), (LOOSE, 2.31, False)):
        flights = impact_map(model, omega)
        orbit = fixed_points(model, omega)[0]
        assert orbit_invariants(orbit).stable is stays
        last = iterated(flights, Impact(orbit.time, orbit.velocity * (1 + 1e-6)), 60)[-1]
        assert (abs(last.velocity / orbit.velocity - 1) < 1e-6) is stays


# verdicts


def test_period_one_is_lost_near_2_3() -> None:
    below, above = (fixed_points(LOOSE, LOST + step)[0] for step in (-1e-6, 1e-6))
    assert orbit_invariants(below).stable
    assert not orbit_invariants(above).stable
    assert min(m.real for m in orbit_invariants(above).multipliers) == pytest.approx(-1, abs=1e-3)
    assert pytest.approx(2.3, abs=0.02) == LOST


@pytest.mark.parametrize(("form", "end"), [("printed 29-30", 2.36955), ("printed 35-37", 2.37097)])
def test_the_printed_forms_misjudge_all_beyond_the_doubling(form: Form, end: float) -> None:
    """By eq. 35–37 and 29–30 as written out above, 1 + det = |tr| at ``end``: 3.9 % above the doubling."""
    orbit = fixed_points(LOOSE, end)[0]
    around = [orbit.impact, replace(orbit.impact, time=orbit.time + orbit.duration), orbit.impact]
    trace, determinant = eq_35_to_37(LOOSE, end, orbit) if form == "printed 35-37" else eq_29_and_30(LOOSE, end, around)
    assert abs(trace) == pytest.approx(1 + determinant, abs=1e-4)
    found = verdicts(LOOSE, 2.275 + 0.005 * np.arange(21), form=form)
    missed = [verdict.orbit.omega for verdict in found if verdict.misjudged]
    assert (min(missed), max(missed)) == pytest.approx((2.285, 2.365 if form == "printed 29-30" else 2.37), abs=1e-9)
    assert all(v.printed.stable and not v.derived.stable for v in found if v.misjudged)


def test_flights_side_with_the_corrected_verdict() -> None:
    """Within the band that the printed forms misjudge, the motion leaves period 1."""
    for omega, period_one in ((2.2795, True), (2.2815, False), (2.35, False)):
        orbit = fixed_points(LOOSE, omega)[0]
        start = vibeam.State(*(orbit.place(2 * pi / omega - orbit.time)[:, None] * (1 + 1e-6)))
        response, _ = FlightSolver(system(LOOSE), omega).steady([omega], LOOSE.drive, start, 6000, 32, "contact")
        assert (response.period[0] == 1) is np.bool_(period_one)
        assert orbit_invariants(orbit).stable is period_one
        assert orbit_invariants(orbit, "printed 35-37").stable
        assert orbit_invariants(orbit, "printed 29-30").stable


# the map


def test_the_map_is_the_flown_motion() -> None:
    flights = impact_map(LOOSE, 2.4)
    path = vibeam.simulate(system(LOOSE), vibeam.Drive(2.4, LOOSE.drive), 60.0)
    first = Impact(float(path.impact_times[0]), float(path.impact_velocities[0]))
    found = iterated(flights, first, len(path.impact_times) - 1)
    assert len(found) > 10
    np.testing.assert_allclose([impact.time for impact in found], path.impact_times[1:], rtol=1e-9)
    np.testing.assert_allclose([impact.velocity for impact in found], path.impact_velocities[1:], rtol=1e-7)


def test_no_further_impact_is_nan() -> None:
    model = Oscillator(0.1, 1e-4, 1.0, 0.8)
    assert np.isnan(impact_map(model, 2.0).next(Impact(0.0, 1e-3)).time)


def test_without_rebound_one_flight_forgets() -> None:
    model = Oscillator(0.05, 1.0, 0.2, 0.0)
    orbit = next(o for o in fixed_points(model, 2.0) if o.admissible(impact_map(model, 2.0)))
    assert orbit_invariants(orbit).determinant == 0
    assert min(abs(m) for m in orbit_invariants(orbit).multipliers) == pytest.approx(0, abs=1e-15)


# the solver


@pytest.mark.parametrize("gap", [-1e-4, 0.0, 2e-4])
def test_si_in_si_out_as_flown(gap: float) -> None:
    """Every number of the response, with a negative contact value, a static load and another output."""
    own: Any = {"gap": gap, "restitution": 0.8, "static": -0.1, "outputs": {"sensor": [0.4]}}
    made = vibeam.ImpactSystem.from_modes(50.0, 0.015, -1.7, 0.6, **own)
    grid = np.linspace(100, 104, 5)
    flown, _ = FlightSolver(made, 90.0).steady(grid, 2e-4, None, 2000, 20, "sensor")
    response, _ = MappingSolver(made, 90.0).steady(grid, 2e-4, None, 0, 20, "sensor")
    assert np.all(flown.period == 1)
    for name in ("frequency", "ended", "period", "impacts_per_period", "rest"):
        np.testing.assert_array_equal(getattr(response, name), getattr(flown, name), err_msg=name)
    for name in ("amplitude", "reach", "maximum", "minimum", "impact_velocity", "impact_velocities"):
        found = getattr(response, name)
        np.testing.assert_allclose(found, getattr(flown, name), rtol=1e-8, atol=1e-14, err_msg=name)
    np.testing.assert_allclose(response.mode_energy, flown.mode_energy, rtol=1e-5)


def test_longer_periods_and_shifted_copies() -> None:
    solver = MappingSolver(system(NOMINAL), 3.0, periods=3, strikes_only=True)
    flier = FlightSolver(system(NOMINAL), 3.0)
    for omega in (4.0, 6.0):
        response, state = solver.steady([omega], 0.5e-3, None, 0, 32, "contact")
        again, kept = solver.steady([omega], 0.5e-3, state, 0, 32, "contact")
        flown, back = flier.steady([omega], 0.5e-3, state, 0, 12, "contact")
        assert response.period[0] == flown.period[0] > 1
        assert response.reach[0] == pytest.approx(flown.reach[0], rel=1e-9)
        assert np.all(kept.displacement == state.displacement)
        assert again.reach[0] == response.reach[0]
        assert back.displacement[0] == pytest.approx(state.displacement[0], rel=1e-6)


def test_where_period_one_is_lost_the_point_is_nan_with_its_reason() -> None:
    grid = [2.2, 2.2815, 2.35, 2.37, 2.4, 2.2]
    reasons = {}
    for form in FORMS:
        response, _ = MappingSolver(system(LOOSE), 2.0, form=form).steady(grid, 0.5e-3, None, 0, 32, "contact")
        reasons[form] = [Ended.of_code(int(code)) for code in response.ended]
        assert np.array_equal(np.isnan(response.amplitude), [r is Ended.NO_ORBIT for r in reasons[form]])
    there = {form: [reason is Ended.COMPLETE for reason in found] for form, found in reasons.items()}
    assert there["derived"] == [True, False, False, False, False, True]
    assert there["printed 29-30"] == [True, True, True, False, False, True]
    assert there["printed 35-37"] == [True, True, True, True, False, True]


def test_swept_by_name() -> None:
    both = vibeam.sweep(
        system(LOOSE), omega=np.linspace(1.8, 2.2, 9), amplitude=0.5e-3, direction="both", solver="mapping"
    )
    assert isinstance(both, Branches)
    assert both.up is not None
    assert both.down is not None
    np.testing.assert_array_equal(both.up.reach, both.down.reach[::-1])
    assert np.all(both.up.period == 1)


def test_what_it_cannot_take() -> None:
    with pytest.raises(ValueError, match="one mode, this system has 2"):
        MappingSolver(vibeam.ImpactSystem.from_modes([1.0, 2.0], 0.1, 1.0, 1.0))
    with pytest.raises(ValueError, match="not underdamped"):
        MappingSolver(vibeam.ImpactSystem.from_modes(1.0, 1.0, 1.0, 1.0))
    with pytest.raises(ValueError, match="none of 'derived', 'printed 29-30', 'printed 35-37'"):
        MappingSolver(system(LOOSE), form="exact")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="periods: 17"):
        MappingSolver(system(LOOSE), periods=17)
    assert flight_solver(LOOSE, 1.0).system.size == 1
