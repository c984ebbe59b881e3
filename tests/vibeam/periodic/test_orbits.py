"""Periodic motions by formula: published numbers, closed forms of one mode, and the flight solver as the judge."""

from __future__ import annotations

from dataclasses import replace
from math import cos, exp, pi, sin, sqrt

import mpmath as mp
import numpy as np
import pytest
from orbit_curve import orbit_curve
from scipy.optimize import brentq

import vibeam
from vibeam.flight.linear.propagator import pair, pairs, propagators
from vibeam.flight.solver import FlightSolver
from vibeam.periodic.between_impacts import carried, state_after
from vibeam.periodic.closed_orbits import admits
from vibeam.periodic.modal_sums import balance, sums
from vibeam.periodic.multipliers import largest, monodromy, multipliers, real_crossing
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.orbit_search import orbits
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State

NOMINAL = ImpactSystem.from_modes([1.0], 0.015, 1.0, 1.0, restitution=0.9)
COCO = ImpactSystem.from_modes([1.0], 0.05, 1.0, 1.0, gap=1.0, restitution=0.8)


def beam_like(n: int, seed: int) -> ImpactSystem:
    """n modes of every damping regime with falling contact values."""
    rng = np.random.default_rng(seed)
    omega = np.concatenate([[1.0], 1 + np.cumsum(rng.uniform(1, 4, n - 1))])
    zeta = rng.choice([0.003, 0.02, 0.2, 1.0, 2.5], n)
    contact = rng.choice([-1, 1], n) * rng.uniform(0.3, 1, n) / omega**1.5
    static = rng.normal(size=n) * 0.02
    return ImpactSystem.from_modes(
        omega, zeta, contact, contact, gap=rng.uniform(-0.1, 0.1), restitution=rng.uniform(0.3, 1), static=static,
        outputs={"sensor": rng.normal(size=n)},
    )  # fmt: skip


def admissible(counts: list[int], seeds: range, periods: int = 1) -> list[Orbit]:
    drives = [Drive(periods * omega, 0.5 / periods) for omega in (1.3, 1.9)]
    found = [o for n in counts for s in seeds for d in drives for o in orbits(beam_like(n, s), d, periods)]
    return [orbit for orbit in found if orbit.admissible]


@pytest.fixture(scope="module")
def many() -> list[Orbit]:
    return admissible([1, 2, 3, 5, 8, 13, 21, 40], range(4)) + admissible([1, 2, 3, 4], range(12), 2)


def flown(orbit: Orbit, state: State, begin: float, spans: int) -> State:
    """The flight from ``begin`` on, over whole spans."""
    end = begin + spans * orbit.span
    return vibeam.simulate(orbit.system, orbit.drive, end, state, t_start=begin).state


def middle(orbit: Orbit) -> tuple[State, float]:
    """The motion halfway between two impacts, where a stroboscope is smooth."""
    half = orbit.time + orbit.span / 2
    x, y = carried(orbit.system, orbit.drive, orbit.state, orbit.time, np.array([half]))
    return State(x[0], y[0]), half


def apart(system: ImpactSystem, first: State, second: State) -> float:
    scale = np.maximum(system.omega, 1.0)
    dx, dy = (first.displacement - second.displacement) * scale, first.velocity - second.velocity
    return float(np.hypot(np.linalg.norm(dx), np.linalg.norm(dy)))


def size(orbit: Orbit) -> float:
    return float(np.linalg.norm(orbit.state.displacement * np.maximum(orbit.system.omega, 1.0))) + float(
        np.linalg.norm(orbit.state.velocity)
    )


# published numbers


def test_reach_of_the_nominal_model() -> None:
    (orbit,) = orbits(NOMINAL, Drive(2.0, 0.5e-3))
    assert orbit.reach == pytest.approx(1.753002e-2, rel=3e-7)
    assert orbit.stable
    assert orbit.admissible
    other = orbits(replace(NOMINAL, restitution=0.91), Drive(2.0, 0.5e-3))[0]
    assert other.reach != pytest.approx(1.753002e-2, rel=1e-3)


# one mode: closed forms


@pytest.mark.parametrize("periods", [1, 2, 3])
@pytest.mark.parametrize("omega", [1.4, 2.0, 2.6])
def test_trace_and_determinant_of_one_mode(omega: float, periods: int) -> None:
    beta, restitution, gap, amplitude = 0.015, 0.9, -0.2e-3, 0.5e-3
    system = replace(NOMINAL, gap=gap)
    found = orbits(system, Drive(omega, amplitude), periods)
    assert found
    for orbit in found:
        span, own = 2 * pi * periods / omega, sqrt(1 - beta**2)
        force = omega**2 * amplitude * sin(orbit.phase)
        first = (1 + restitution) * (force - gap) * sin(own * span) / (own * orbit.velocity)
        trace = exp(-beta * span) * (first - 2 * restitution * cos(own * span))
        assert orbit.multipliers.sum().real == pytest.approx(trace, rel=1e-11, abs=1e-11)
        assert orbit.multipliers.prod().real == pytest.approx(restitution**2 * exp(-2 * beta * span), rel=1e-12)


def test_a_ball_on_a_shaken_table() -> None:
    """No stiffness at all: v = g nT/(1 + R), and the table's velocity makes up for what the impact takes."""
    gravity, restitution, drive, span = 9.81, 0.8, Drive(30.0, 8e-3), 2 * pi / 30
    ball = ImpactSystem.from_modes([0.0], 0.0, 1.0, 1.0, restitution=restitution, static=gravity)
    found = balance(ball, sums(ball, np.array([drive.omega]), 1), drive.amplitude, ball.gap)
    for phase, impulse, velocity in zip(found.phase[0], found.impulse[0], found.velocity[0], strict=True):
        assert velocity == pytest.approx(gravity * span / (1 + restitution), rel=1e-14)
        table = -drive.omega * drive.amplitude * cos(phase)  # η = g t²/2 + … − B sin Ωt
        assert table == pytest.approx((1 - restitution) / 2 * velocity, rel=1e-12)
        after = state_after(ball, drive, 1, phase, impulse)
        assert admits(FlightSolver(ball, drive.omega), drive, after, phase / drive.omega, 1, velocity)
    radius = [abs(multipliers(ball, np.array([span]), found.relative_acceleration[:, k])[0, 0]) for k in (0, 1)]
    assert radius[0] > 1 > radius[1]  # the earlier impact is the unstable one


@pytest.mark.parametrize("zeta", [0.0, 0.01, 0.7, 1 - 1e-9, 1.0, 1 + 1e-9, 1.3, 40.0])
@pytest.mark.parametrize("turns", [1e-3, 0.4, 1 - 1e-7, 7.3, 400.2])
def test_a_pair_against_arbitrary_precision(zeta: float, turns: float) -> None:
    span = 2 * pi * turns
    mp.mp.dps = 60
    z, t = mp.mpf(zeta), mp.mpf(span)
    exact = mp.expm(mp.matrix([[0, 1], [-1, -2 * z]]) * t) if t * (1 + z) < 300 else None
    own = pair(1.0, zeta, np.array([span]))
    if exact is None:  # the matrix exponential by its definition is too slow: both decays in closed form
        disc = mp.sqrt(mp.mpc(z * z - 1 + mp.mpf(10) ** -50))
        s = (mp.exp((-z + disc) * t) - mp.exp((-z - disc) * t)) / (2 * disc)
        c = (mp.exp((-z + disc) * t) + mp.exp((-z - disc) * t)) / 2
        exact = mp.matrix([[(c + z * s).real, s.real], [-s.real, (c - z * s).real]])
    one = mp.eye(2)
    got = [own.p00, own.p01, own.p10, own.p11, own.rise, own.closing, own.opening]
    wanted = [*exact, 1 - exact[0, 0], mp.det(one - exact), mp.det(one + exact)]
    reach = float(max(abs(v) for v in exact)) + 1e-300
    conditioning = 1 + span  # a phase of many turns is known to its last bit only
    for a, b in zip(got[:4], wanted[:4], strict=True):
        assert abs(float(a[0]) - float(b)) <= 4e-16 * conditioning * reach
    closing = float(wanted[5])
    slack = 4e-16 * conditioning * reach * sqrt(closing)  # of 4 sin²(wt/2): the root is known to that share
    assert abs(own.closing[0] - closing) <= 4 * slack + 1e-14 * closing
    assert abs(own.opening[0] - float(wanted[6])) <= 4e-15 * conditioning * float(abs(wanted[6]) + reach)
    assert abs(own.rise[0] - float(wanted[4])) <= 4e-16 * conditioning * (reach + 1) * min(1.0, span + sqrt(closing))


# any number of modes: the flight solver judges


def test_there_is_something_to_judge(many: list[Orbit]) -> None:
    assert len(many) >= 20
    assert {1, 5, 40} <= {orbit.system.size for orbit in many}
    assert {True, False} <= {orbit.stable for orbit in many}
    assert {1, 2} <= {orbit.periods for orbit in many}


def test_the_flight_comes_back(many: list[Orbit]) -> None:
    for orbit in many:
        bar = 1e-12 * max(1.0, abs(orbit.multipliers[0]), size(orbit) / orbit.velocity)
        start, begin = middle(orbit)
        assert apart(orbit.system, flown(orbit, start, begin, 1), start) < bar * size(orbit)
        wrong = State(start.displacement, start.velocity * (1 + 1e-9))
        assert apart(orbit.system, flown(orbit, wrong, begin, 1), start) > bar * size(orbit)
        path = vibeam.simulate(
            orbit.system, orbit.drive, orbit.time + 1.2 * orbit.span, orbit.state, t_start=orbit.time
        )
        assert path.impact_times[0] == pytest.approx(orbit.time + orbit.span, rel=bar)
        assert path.impact_velocities[0] == pytest.approx(orbit.velocity, rel=10 * bar)


def test_monodromy_against_differences_of_the_flight(many: list[Orbit]) -> None:
    """M carries disturbances from just after an impact to just after the next; the strobe is half a flight later."""
    for orbit in (o for o in many if o.system.size < 10):
        start, begin = middle(orbit)
        n, step = orbit.system.size, 1e-6 * size(orbit)
        columns = []
        for k in range(2 * n):
            shift = np.zeros(2 * n)
            shift[k] = step / (max(orbit.system.omega[k], 1.0) if k < n else 1.0)
            ends = []
            for sign in (1, -1):
                moved = State(start.displacement + sign * shift[:n], start.velocity + sign * shift[n:])
                end = flown(orbit, moved, begin, 1)
                ends.append(np.concatenate([end.displacement, end.velocity]))
            columns.append((ends[0] - ends[1]) / (2 * shift[k]))
        half = propagators(orbit.system.omega, orbit.system.zeta, np.array([orbit.span / 2]))
        carry = np.block([[np.diag(half.p00[0]), np.diag(half.p01[0])], [np.diag(half.p10[0]), np.diag(half.p11[0])]])
        ratio = contact_acceleration(orbit) / orbit.velocity
        exact = carry @ monodromy(orbit.system, np.array([orbit.span]), np.array([ratio]))[0]
        got = np.array(columns).T @ carry
        np.testing.assert_allclose(
            got, exact, atol=2e-7 * np.abs(exact).max() * max(1.0, (size(orbit) / orbit.velocity))
        )
        without = (
            carry @ monodromy(orbit.system, np.array([orbit.span]), np.array([ratio + 0.01 * (1 + abs(ratio))]))[0]
        )
        assert np.abs(got - without).max() > 10 * np.abs(got - exact).max()


def contact_acceleration(orbit: Orbit) -> float:
    """Just before the impact, from the equations of motion."""
    own, drive = orbit.system, orbit.drive
    before = orbit.state.velocity - own.contact * orbit.impulse
    force = own.load * drive.omega**2 * drive.amplitude * sin(orbit.phase) + own.static
    pull = 2 * own.zeta * own.omega * before + own.omega**2 * orbit.state.displacement
    return float(own.contact @ (force - pull))


def test_multipliers_are_those_of_the_saltation_matrix(many: list[Orbit]) -> None:
    for orbit in many:
        ratio = np.array([contact_acceleration(orbit) / orbit.velocity])
        np.testing.assert_allclose(
            np.abs(multipliers(orbit.system, np.array([orbit.span]), ratio)[0]), np.abs(orbit.multipliers), atol=1e-6
        )
        damped = orbit.system.zeta * orbit.system.omega
        determinant = orbit.system.restitution**2 * exp(-2 * damped.sum() * orbit.span)
        assert orbit.multipliers.prod().real == pytest.approx(determinant, rel=1e-6, abs=1e-12)


def test_what_is_stable_returns_and_what_is_not_leaves(many: list[Orbit]) -> None:
    for orbit in many:
        radius = abs(orbit.multipliers[0])
        start, begin = middle(orbit)
        off = 1e-8 * size(orbit)
        moved = State(start.displacement, start.velocity + off * np.sign(orbit.system.contact))
        spans = int(min(2000, np.ceil(np.log(1e4) / abs(np.log(radius))))) + 5
        end = apart(orbit.system, flown(orbit, moved, begin, spans), start)
        first = apart(orbit.system, moved, start)
        assert (end < 0.1 * first) if orbit.stable else (end > 10 * first)


def test_extremes_and_energies_are_those_of_the_settled_motion(many: list[Orbit]) -> None:
    checked = 0
    for orbit in many:
        if not orbit.stable or abs(orbit.multipliers[0]) > 0.95 or checked >= 6:
            continue
        start, _ = middle(orbit)
        got = orbit.watched("sensor")
        sample = orbit.time + orbit.span * np.linspace(1e-9, 1 - 1e-9, 4001)
        x, y = carried(orbit.system, orbit.drive, orbit.state, orbit.time, sample)
        rows = x @ orbit.system.output("sensor")
        assert got.maximum[0] == pytest.approx(rows.max(), rel=1e-4, abs=1e-4 * np.ptp(rows))
        assert got.amplitude[0] == pytest.approx(np.ptp(rows) / 2, rel=1e-3)
        assert orbit.reach == pytest.approx(orbit.system.gap - (x @ orbit.system.contact).min(), rel=1e-3)
        energy = (y**2 + (orbit.system.omega * x) ** 2).mean(axis=0) / 2
        np.testing.assert_allclose(got.mode_energy[0], energy, rtol=0.02, atol=1e-3 * energy.max())
        assert start.displacement.shape == (orbit.system.size,)
        checked += 1
    assert checked >= 4


def test_what_passes_through_the_stop_is_not_admissible() -> None:
    found = [o for s in range(12) for o in orbits(beam_like(6, s), Drive(0.45, 2.0))]
    passing = [orbit for orbit in found if not orbit.admissible]
    assert passing
    for orbit in passing:
        times = orbit.time + orbit.span * np.linspace(1e-6, 1 - 1e-6, 20_001)
        x, _ = carried(orbit.system, orbit.drive, orbit.state, orbit.time, times)
        assert (x @ orbit.system.contact).max() > orbit.system.gap
        assert np.isnan(orbit.reach)
        with pytest.raises(ValueError, match="passes through the stop"):
            orbit.watched()


def test_an_impact_at_phase_zero_is_watched_like_any_other() -> None:
    """The gap is chosen so that the impact falls on the drive's phase 0, where a period begins."""
    drive = Drive(2.0, -0.5e-3)

    def lag(gap: float) -> float:
        return sin(orbits(replace(NOMINAL, gap=gap), drive)[0].phase)

    gap = brentq(lag, -3e-4, 3e-4, xtol=1e-18)
    plain = orbits(replace(NOMINAL, gap=gap + 1e-6), drive)[0].watched()
    late = 0
    for shift in np.linspace(-8, 8, 17) * 1e-19:
        (orbit,) = orbits(replace(NOMINAL, gap=float(gap + shift)), drive)
        late += min(orbit.phase, 2 * pi - orbit.phase) < 1e-13
        seen = orbit.watched()
        assert orbit.admissible
        assert seen.ended[0] == 0
        assert seen.maximum[0] == pytest.approx(gap, abs=1e-10 * orbit.reach)
        assert orbit.reach == pytest.approx(float(plain.reach[0]), rel=1e-3)
    assert late > 5


# questions without an answer


@pytest.mark.parametrize(
    ("system", "omega", "words"),
    [
        (ImpactSystem.from_modes([2.0], 0.0, 1.0, 1.0), 2.0, "its own frequency"),
        (ImpactSystem.from_modes([1.0, 6.0], 0.0, 1.0, [1.0, 0.0]), 2.0, "whole number of turns"),
        (ImpactSystem.from_modes([0.0, 1.0], 0.0, 1.0, 1.0), 2.0, "without stiffness"),
        (ImpactSystem.from_modes([0.0], 0.0, 1.0, 1.0, static=-1.0), 2.0, "toward the stop"),
    ],
)
def test_faults_are_named(system: ImpactSystem, omega: float, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        orbits(system, Drive(omega, 1.0))


def test_wrong_arguments_are_named() -> None:
    with pytest.raises(ValueError, match="periods"):
        orbits(NOMINAL, Drive(2.0, 1.0), 0)
    with pytest.raises(ValueError, match="omega"):
        orbits(NOMINAL, Drive(0.0, 1.0))
    assert orbits(NOMINAL, Drive(2.0, 0.0)) == ()
    assert orbits(replace(NOMINAL, gap=1.0), Drive(2.0, 1e-3)) == ()


# whole curves


def test_a_curve_is_its_points() -> None:
    system = beam_like(5, 3)
    grid = np.linspace(0.8, 3.0, 40)
    curve = orbit_curve(system, grid, 0.5)
    seen = 0
    for i, omega in enumerate(grid):
        for orbit in orbits(system, Drive(float(omega), 0.5)):
            k = int(np.nanargmin(np.abs(curve.impulse[i] - orbit.impulse)))
            assert curve.impulse[i, k] == pytest.approx(orbit.impulse, rel=1e-15)  # by way of the velocity
            assert curve.phase[i, k] == pytest.approx(orbit.phase, rel=1e-15)  # by way of the time
            assert curve.stable[i, k] == orbit.stable
            seen += 1
    assert seen == np.isfinite(curve.impulse).sum() > 20


@pytest.mark.parametrize("gap", [-1e-4, -0.0, 0.0, 1e-4])
@pytest.mark.parametrize("omega", [1.7, 2.3])
def test_the_harder_impact_comes_first_without_a_gap_too(omega: float, gap: float) -> None:
    """One root pulls at the stop for |Δ| < |H|: it is the second, whichever sign G₀ and zero have."""
    curve = orbit_curve(replace(NOMINAL, gap=gap), [omega], 0.5e-3)
    assert np.isfinite(curve.velocity[0]).tolist() == [True, False]


def determinants(system: ImpactSystem, omega: np.ndarray, amplitude: float) -> tuple[np.ndarray, np.ndarray]:
    """D(1) and D(−1) of both roots (points, 2)."""
    total = sums(system, omega, 1)
    lean = balance(system, total, amplitude, system.gap).relative_acceleration
    plus, minus = (
        np.stack([real_crossing(system, part, lean[:, k]) for k in (0, 1)], axis=1)
        for part in (total.plus, total.minus)
    )
    return plus, minus


def test_determinants_agree_with_multipliers() -> None:
    """D(±1) Π det(±1 − P_i) is the characteristic polynomial at ±1."""
    for seed in range(8):
        system = beam_like(4, seed)
        curve, found = orbit_curve(system, [1.7], 0.5), determinants(system, np.array([1.7]), 0.5)
        for orbit in orbits(system, Drive(1.7, 0.5)):
            k = int(np.nanargmin(np.abs(curve.impulse[0] - orbit.impulse)))
            flown_ = propagators(system.omega, system.zeta, np.array([orbit.span]))
            plus = (1 - orbit.multipliers).prod().real / flown_.closing.prod()
            minus = (-1 - orbit.multipliers).prod().real / flown_.opening.prod()
            assert [each[0, k] for each in found] == pytest.approx([plus, minus], rel=1e-8)


def test_of_two_motions_one_is_always_proved_unstable() -> None:
    system, omega = replace(COCO, zeta=np.array([0.02])), np.linspace(0.9, 1.3, 400)
    both = np.isfinite(orbit_curve(system, omega, 0.06).impulse).all(axis=1)
    assert both.sum() > 20
    assert np.all((determinants(system, omega, 0.06)[0][both] < 0).sum(axis=1) == 1)


def test_ten_thousand_points_of_eight_modes() -> None:
    system = beam_like(8, 1)
    grid = np.linspace(0.5, 8.0, 10_000)
    curve = orbit_curve(system, grid, 0.5)
    assert curve.stable.any()
    some = grid[::2500]
    np.testing.assert_allclose(curve.impulse[::2500], orbit_curve(system, some, 0.5).impulse, rtol=1e-12)


def test_many_modes_at_once_are_each_of_them() -> None:
    omega, zeta = np.array([0.0, 1e-200, 0.7, 2.0, 3.0, 900.0]), np.array([0.0, 0.1, 1.0, 0.02, 2.5, 0.017])
    span = np.array([0.3, 2.0, 11.0])
    for chosen in (slice(None), slice(3, 4), slice(5, 6), [3, 5]):
        found = pairs(omega[chosen], zeta[chosen], span)
        each = [pair(own, damping, span) for own, damping in zip(omega[chosen], zeta[chosen], strict=True)]
        for name in found._fields:
            assert np.array_equal(getattr(found, name), [getattr(one, name) for one in each])


@pytest.mark.parametrize("n", [1, 2, 5, 9])
def test_the_largest_multiplier_is_bounded_closely_from_above(n: int) -> None:
    rng = np.random.default_rng(n)
    span, ratio = rng.uniform(1, 8, 250), rng.normal(0, 3, 250)
    for seed in range(4):
        system = beam_like(n, seed)
        truth = np.abs(multipliers(system, span, ratio)[:, 0])
        bound = largest(system, span, ratio)
        assert np.all(bound > truth * (1 - 1e-6))
        assert np.all(bound < truth * 1.005)
        assert largest(system, span[:1], ratio[:1]) == pytest.approx(truth[:1], rel=1e-9)  # few: the multipliers
    assert (truth < 1).any()
    assert (truth > 1).any()
