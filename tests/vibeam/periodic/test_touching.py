"""The least gap between two impacts: against fine samples, the flight solver's own proof, and 40-digit arithmetic."""

from __future__ import annotations

from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest

from vibeam.periodic.between_impacts import carried
from vibeam.periodic.bifurcation_functions import Kind, clearances, motions
from vibeam.periodic.boundaries import Boundary, boundaries
from vibeam.periodic.clearance import least_minimum
from vibeam.periodic.gap import FlightGap
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.orbit_search import orbits
from vibeam.system.impact_system import Drive, ImpactSystem

NOMINAL = ImpactSystem.from_modes([1.0], 0.015, 1.0, 1.0, restitution=0.9)
SAMPLES = 8_001


def random_system(n: int, seed: int) -> ImpactSystem:
    rng = np.random.default_rng(seed)
    omega = np.concatenate([[1.0], 1 + np.cumsum(rng.uniform(1, 4, n - 1))])
    zeta = rng.choice([0.003, 0.02, 0.2, 1.0, 1.1, 2.5], n)
    contact = rng.choice([-1, 1], n) * rng.uniform(0.3, 1, n) / omega**1.2
    return ImpactSystem.from_modes(
        omega, zeta, contact, contact, gap=rng.uniform(-0.1, 0.1), restitution=rng.uniform(0, 1),
        static=rng.normal(size=n) * 0.02,
    )  # fmt: skip


def some() -> list[Orbit]:
    grid = [
        (n, seed, omega, k) for n in (1, 2, 4, 9, 40) for seed in range(3) for omega in (0.31, 0.9, 1.7) for k in (1, 2)
    ]
    return [orbit for n, seed, w, k in grid for orbit in orbits(random_system(n, seed), Drive(w, 0.5), k)]


MANY = some()


def certified(orbit: Orbit, ceiling: float = np.inf) -> tuple[float, float]:
    points = points_of(orbit)
    branch = int(np.nanargmin(np.abs(points.roots.impulse[0] - orbit.impulse)))
    flights = FlightGap.of(orbit.system, points.total, points.roots, points.amplitude, branch)
    found = least_minimum(flights, np.array([ceiling]))
    return float(found.value[0]), float(found.time[0])


def points_of(orbit: Orbit):  # type: ignore[no-untyped-def]
    rows = (np.array([value]) for value in (orbit.drive.omega, orbit.drive.amplitude, orbit.system.gap))
    return motions(orbit.system, orbit.periods, *rows)


def sampled(orbit: Orbit) -> tuple[np.ndarray, np.ndarray]:
    times = orbit.span * np.linspace(0, 1, SAMPLES)
    x, _ = carried(orbit.system, orbit.drive, orbit.state, orbit.time, orbit.time + times)
    return times, orbit.system.gap - x @ orbit.system.contact


def test_there_is_something_to_judge() -> None:
    assert len(MANY) > 40
    assert {True, False} <= {orbit.admissible for orbit in MANY}
    assert {1, 40} <= {orbit.system.size for orbit in MANY}


def test_the_least_minimum_is_the_one_of_fine_samples() -> None:
    some_, none = 0, 0
    for orbit in MANY:
        value, time = certified(orbit)
        times, gaps = sampled(orbit)
        inner = np.flatnonzero((gaps[1:-1] < gaps[:-2]) & (gaps[1:-1] <= gaps[2:])) + 1
        inner = inner[(inner > 2) & (inner < SAMPLES - 3)]  # round-off makes minima at the impacts
        size = np.ptp(gaps)
        if not len(inner):
            none += 1
            assert value == np.inf or min(time, orbit.span - time) < 3 * times[1]
            continue
        some_ += 1
        assert value <= gaps[inner].min() + 1e-12 * size
        assert value == pytest.approx(gaps[inner].min(), abs=4e-5 * size)
    assert some_ > 30
    assert none > 5


def test_a_ceiling_leaves_out_what_lies_above_and_nothing_else() -> None:
    for orbit in MANY[::5]:
        value, _ = certified(orbit)
        if np.isfinite(value):
            assert certified(orbit, value + 1e-9)[0] == pytest.approx(value, rel=1e-12, abs=1e-15)
            assert certified(orbit, value - 1e-6)[0] == np.inf


def test_it_agrees_with_the_proof_by_flight() -> None:
    for orbit in MANY:
        points = points_of(orbit)
        branch = int(np.nanargmin(np.abs(points.roots.impulse[0] - orbit.impulse)))
        share = clearances(orbit.system, points, branch, ceiling=1e-9)[0]
        if abs(share) > 1e-9 or share == 1e-9:
            assert (share > 0) == orbit.admissible, (orbit.system.size, orbit.drive, share)


def test_all_motions_at_once_are_what_they_are_one_by_one() -> None:
    system, grid = random_system(4, 1), np.linspace(0.2, 2.0, 60)
    rows = (grid, np.full(60, 0.5), np.linspace(-0.2, 0.2, 60))
    whole = clearances(system, motions(system, 1, *rows), 0)
    assert np.isfinite(whole).sum() > 20
    assert (whole < 0).any()
    for i in range(60):
        alone = clearances(system, motions(system, 1, *(row[i : i + 1] for row in rows)), 0)
        np.testing.assert_allclose(alone[0], whole[i], rtol=1e-12, equal_nan=True)


def test_a_dip_that_samples_miss_is_found() -> None:
    """A fast mode, lightly damped, touches for a share of its own period only: twelve samples a turn pass it over."""
    fast = ImpactSystem.from_modes([1.0, 211.3], [0.01, 1e-4], [1.0, 0.02], [1.0, 0.0], gap=0.0, restitution=0.7)
    found = orbits(fast, Drive(1.93, 0.1))
    assert found
    for orbit in found:
        assert (certified(orbit)[0] > 0) == orbit.admissible


def test_a_symmetric_motion_has_its_minimum_where_intervals_meet() -> None:
    """Without any loss the motion is its own mirror image in time, so the gap has an extreme at half the span."""
    system = ImpactSystem.from_modes([1.0, 5.2], 0.0, [1.0, 0.4], [1.0, 0.1], gap=-0.1, restitution=1.0)
    seen = 0
    for omega in np.linspace(0.3512, 2.57, 91):
        for orbit in orbits(system, Drive(float(omega), 0.3)):
            value, time = certified(orbit)
            _, gaps = sampled(orbit)
            middle = SAMPLES // 2
            if gaps[middle] < gaps[middle + 40] and gaps[middle] < gaps[middle - 40]:
                seen += 1
                assert value <= gaps[middle] + 1e-12
                assert gaps[middle] > value + 1e-9 or time == pytest.approx(orbit.span / 2, rel=1e-6)
    assert seen > 5


# boundaries


def exact_gap(b: Boundary, system: ImpactSystem, parameter: mp.mpf) -> tuple[mp.mpf, mp.mpf, mp.mpf]:
    """Least local minimum of the gap by 40-digit arithmetic for one mode, its slope, its time.

    Built from the initial value problem: the phase and the speed after the impact are such that the flight comes back
    after one period at the stop with a speed that restitution turns into the first one.
    """
    values = {"omega": mp.mpf(b.omega), "amplitude": mp.mpf(b.amplitude), "gap": mp.mpf(b.gap)}
    values[b.parameter] = parameter
    omega, drive, gap = values["omega"], values["amplitude"], values["gap"]
    beta, r = mp.mpf(float(system.zeta[0])), mp.mpf(system.restitution)
    own = mp.sqrt(1 - beta**2)
    h = omega**2 * drive / (1 - omega**2 + 2j * beta * omega)

    def flight(phase: mp.mpf, after: mp.mpf, t: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
        start, now = h * mp.exp(1j * phase), h * mp.exp(1j * (phase + omega * t))
        x, y = gap - start.imag, after - omega * start.real
        e, c, s = mp.exp(-beta * t), mp.cos(own * t), mp.sin(own * t) / own
        q = e * (x * (c + beta * s) + y * s) + now.imag
        return q, e * (-x * s + y * (c - beta * s)) + omega * now.real

    def closes(phase: mp.mpf, after: mp.mpf) -> list[mp.mpf]:
        q, v = flight(phase, after, 2 * mp.pi / omega)
        return [q - gap, after + r * v]

    phase, after = mp.findroot(closes, (mp.mpf(b.phase), mp.mpf(-system.restitution * b.velocity)))
    span = 2 * mp.pi / omega
    speeds = [flight(phase, after, span * i / 200)[1] for i in range(1, 200)]
    tops = [i for i in range(198) if speeds[i] > 0 >= speeds[i + 1]]
    times = [
        mp.findroot(
            lambda t: flight(phase, after, t)[1], (span * (i + 1) / 200, span * (i + 2) / 200), solver="anderson"
        )
        for i in tops
    ]
    time = min(times, key=lambda t: gap - flight(phase, after, t)[0])
    return gap - flight(phase, after, time)[0], flight(phase, after, time)[1], time


@pytest.mark.parametrize(("gap", "omega"), [(-0.5e-3, (1.7, 1.9)), (-0.2e-3, (1.2, 1.5)), (0.2e-3, (0.4, 0.9))])
def test_touching_boundaries_are_exact(gap: float, omega: tuple[float, float]) -> None:
    mp.mp.dps = 40
    tight = replace(NOMINAL, gap=gap)
    found = [b for b in boundaries(tight, 0.5e-3, omega, points=61) if b.kind is Kind.TOUCHING]
    assert found
    for b in found:
        here = exact_gap(b, tight, mp.mpf(b.omega))
        step = mp.mpf(10) ** -8 * b.omega
        beyond = exact_gap(b, tight, mp.mpf(b.omega) + step)
        slope = (beyond[0] - here[0]) / step
        assert abs(here[0] / slope) < 1e-12 * b.omega  # by so much the boundary lies elsewhere
        assert abs(beyond[0] / slope) > 1e-9 * b.omega
