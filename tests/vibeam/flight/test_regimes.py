"""Any damping, law and number of stops: against expm, DOP853, closed forms, the flight kernels."""

from __future__ import annotations

import sys
from dataclasses import replace
from math import pi, sqrt
from pathlib import Path

import free_mass
import numpy as np
import pytest
from bounded import Bound
from scipy.linalg import expm

import vibeam
from vibeam.flight.solver import FlightSolver, RegimeSolver
from vibeam_models.laws.compliant import Hertz, HuntCrossley, LinearStop
from vibeam_models.laws.restitution import Restitution, TableRestitution

sys.path.insert(0, str(Path(__file__).parents[2] / "support"))
from integrated import integrated, matrices

DRIVE = vibeam.Drive(95.0, 3e-4)
PERIOD = 2 * np.pi / DRIVE.omega
TABLE = TableRestitution((0.0, 0.02, 0.05, 0.2), (0.95, 0.9, 0.7, 0.5))
HUNT = HuntCrossley.matched(1e7, 0.7, 0.05)


def made(n: int, *, law=None, coupled: bool = False, second: float | None = None, gap: float = 2e-4, seed: int = 0):
    """n modes as of a beam with a mass; ``coupled``: damping that is far from proportional."""
    random = np.random.default_rng(seed + 10 * n)
    omega = 48 * np.cumprod(np.concatenate([[1.0], random.uniform(2, 4, n - 1)]))
    contact, load = random.uniform(0.5, 2, n) * random.choice([1, -1], n), random.uniform(0.1, 0.5, n)
    contact[0], load[0] = 2.2, 0.45
    mixed = random.normal(size=(n, n))
    coupling = np.diag(0.04 * omega) + 0.02 * (mixed @ mixed.T) * np.sqrt(np.outer(omega, omega)) / n
    return vibeam.ImpactSystem.from_modes(
        omega, 0.02, contact, load, gap=gap, restitution=0.7, law=law, second_gap=second,
        coupling=coupling if coupled else None, outputs={"sensor": random.normal(size=n)},
    )  # fmt: skip


def still(n: int) -> vibeam.State:
    return vibeam.State(np.zeros(n), np.zeros(n))


def one_mode(law=None, *, omega: float = 0.0, zeta: float = 0.0, gap: float = 0.0, **more):
    """A mass of 1 kg."""
    return vibeam.ImpactSystem.from_modes([omega], zeta, 1.0, 1.0, gap=gap, law=law, **more)


def struck(law, speed: float, **more) -> vibeam.simulate:
    """A free mass on its way into the stop."""
    start = vibeam.State(np.array([-0.01]), np.array([speed]))
    return vibeam.simulate(one_mode(law, **more), vibeam.Drive(0.0, 0.0), 0.05 / speed, start)


# ------------------------------------------------------------------------------------------- damping that couples modes


@pytest.mark.parametrize("n", [2, 5, 12])
def test_free_motion_with_coupled_damping_is_the_exponential_of_its_matrix(n: int) -> None:
    system = replace(made(n, coupled=True), gap=1e9)
    random = np.random.default_rng(n)
    x, v = random.normal(size=n), random.normal(size=n) * system.omega
    spring, damper = matrices(system)
    state = np.block([[np.zeros((n, n)), np.eye(n)], [-spring, -damper]])
    path = vibeam.simulate(system, vibeam.Drive(0.0, 0.0), 0.1, vibeam.State(x, v))
    scale = np.concatenate([system.omega, np.ones(n)])
    for t in (1e-4, 0.01, 0.1):
        # in energy coordinates, in which expm is as good as it can be
        exact = expm(t * (scale[:, None] * state / scale)) @ (scale * np.concatenate([x, v]))
        found = scale * path.modes_at(t).ravel()
        assert np.max(np.abs(found - exact)) <= 1e-12 * np.linalg.norm(scale * np.concatenate([x, v]))


def test_a_slow_mode_beside_a_very_fast_one_keeps_its_digits() -> None:
    """QR alone leaves errors of ε times the fastest rate: over 20 s here 1e-8 of the slow mode's phase."""
    mpmath = pytest.importorskip("mpmath")
    omega, coupling = [3.0, 400.0, 3e6], [[0.1, 0.5, 20.0], [0.5, 30.0, 500.0], [20.0, 500.0, 6e4]]
    system = vibeam.ImpactSystem.from_modes(omega, 0.0, 1.0, 1.0, gap=1e9, coupling=coupling)
    path = vibeam.simulate(system, vibeam.Drive(0.0, 0.0), 20.0, vibeam.State(np.array([1.0, 0.0, 0.0]), np.zeros(3)))
    with mpmath.workdps(40):
        # λ from the characteristic polynomial of the quadratic problem by Newton from the undamped frequency
        def characteristic(x):
            entries = [
                [(x**2 + omega[i] ** 2 if i == j else 0) + x * mpmath.mpf(coupling[i][j]) for j in range(3)]
                for i in range(3)
            ]
            return mpmath.det(mpmath.matrix(entries))

        slow = mpmath.findroot(characteristic, mpmath.mpc(-0.05, 3.0))
        later = [complex(mpmath.exp(slow * t)) for t in (10.0, 20.0)]
    # all but the slow mode has died by 10 s: x(20)/x(10) and its rate follow e^{λt}
    a, b = path.modes_at(10.0)[:, 0], path.modes_at(20.0)[:, 0]
    amplitude = (a[1] - slow.conjugate() * a[0]) / (slow - slow.conjugate()) / later[0]
    exact = 2 * (complex(amplitude) * later[1]).real
    assert b[0] == pytest.approx(exact, abs=2e-13 * abs(complex(amplitude) * later[1]) * 10)


@pytest.mark.parametrize("n", [1, 3, 6])
def test_damping_that_does_not_couple_gives_the_flight_kernels_motion(n: int) -> None:
    for gap, static in ((2e-4, 0.0), (-3e-4, 0.0), (0.0, 2.0)):  # free, pressed with rests, leaning
        plain = replace(made(n, gap=gap), static=np.full(n, static))
        full = replace(plain, coupling=np.diag(2 * plain.zeta * plain.omega))
        state = FlightSolver(plain, DRIVE.omega).pose(None)[0]
        start = vibeam.State(state[0], state[1], gap <= 0)
        one = vibeam.simulate(plain, DRIVE, 6 * PERIOD, start)
        two = vibeam.simulate(full, DRIVE, 6 * PERIOD, start)
        few = min(12, len(one.impact_times))  # later on, chatter and chaos tell one rounding from another
        assert few == min(12, len(two.impact_times))
        assert few > 3 or gap <= 0
        assert two.impact_times[:few] == pytest.approx(one.impact_times[:few], abs=1e-10 * PERIOD)
        assert two.impact_velocities[:few] == pytest.approx(one.impact_velocities[:few], abs=1e-10)
        times = np.linspace(0, one.impact_times[few - 1] if few else 6 * PERIOD, 50)
        assert two.modes_at(times)[:, 0] == pytest.approx(one.modes_at(times)[:, 0], abs=1e-14)


def test_the_first_rests_are_those_of_the_flight_kernels() -> None:
    plain = replace(made(3, gap=-3e-4), static=np.zeros(3))
    full = replace(plain, coupling=np.diag(2 * plain.zeta * plain.omega))
    one, two = (vibeam.simulate(system, DRIVE, 3 * PERIOD) for system in (plain, full))
    assert len(one.rests) == len(two.rests) >= 1
    assert two.rests == pytest.approx(one.rests, abs=1e-9 * PERIOD)


def test_steady_points_are_those_of_the_flight_kernels() -> None:
    plain = made(3)
    full = replace(plain, coupling=np.diag(2 * plain.zeta * plain.omega))
    grid = [90.0, 95.0, 100.0]
    one = vibeam.sweep(plain, omega=grid, amplitude=3e-4, settle=60, hold=20, output="sensor")
    two = vibeam.sweep(full, omega=grid, amplitude=3e-4, settle=60, hold=20, output="sensor")
    assert list(one.period) == list(two.period)
    for name in ("amplitude", "reach", "maximum", "minimum", "impacts_per_period", "impact_velocity", "rest"):
        assert getattr(two, name) == pytest.approx(getattr(one, name), rel=1e-9, abs=1e-13), name
    assert two.mode_energy == pytest.approx(one.mode_energy, rel=1e-4)


# -------------------------------------------------------------------------------------------------- against integration


@pytest.mark.parametrize(
    ("n", "law", "coupled", "second"),
    [
        (1, TABLE, False, None),
        (1, LinearStop(1e5), True, 3e-4),
        (1, Hertz(1e7), False, None),
        (2, None, True, 3e-4),
        (2, LinearStop.matched(3e5, 0.7, 0.2), True, 3e-4),
        (2, HUNT, True, None),
        (3, LinearStop.matched(3e5, 0.7, 0.2), False, None),
        (4, TABLE, True, None),
        (4, None, True, None),
    ],
)
def test_contacts_are_those_that_an_ode_solver_finds(n: int, law, coupled: bool, second: float | None) -> None:
    system = made(n, law=law, coupled=coupled, second=second)
    end = 4 * PERIOD
    path = vibeam.simulate(system, DRIVE, end, still(n))
    truth = integrated(system, DRIVE, still(n), end)
    assert path.ended is vibeam.Ended.COMPLETE
    assert len(path.impact_times) == len(truth.times) >= 3
    assert path.impact_times == pytest.approx(truth.times, abs=1e-9 * PERIOD)
    assert path.impact_velocities == pytest.approx(truth.velocities, abs=1e-9)
    count = len(truth.durations)
    assert path.contacts[:count, 1] == pytest.approx(truth.durations, abs=1e-9 * PERIOD)
    assert path.state.velocity == pytest.approx(truth.last[1], abs=1e-8)


def test_round_off_of_its_force_does_not_end_a_contact_that_just_began() -> None:
    """Without damping in the stop its force starts at k·0, and k times round-off may lie on either side of it."""
    coupling = np.diag([0.27, 0.33, 3.2, 0.48])
    coupling[0, 1] = coupling[1, 0] = -0.004
    coupling[2, 3] = coupling[3, 2] = -0.04
    stop = LinearStop(4400.0)
    system = vibeam.ImpactSystem.from_modes(
        [0.12, 0.16, 0.25, 0.5], 0.0, [-0.31, 0.3, -0.18, -0.17], [0.9, 0.0, 0.26, 0.0], law=stop, coupling=coupling,
        static=[-0.0037, -0.002, -0.0035, 0.0],
    )  # fmt: skip
    start = vibeam.State(np.array([0.3, -0.3, 0.2, 0.2]), np.zeros(4))
    path = vibeam.simulate(system, vibeam.Drive(0.12, 0.39), 158.0, start, max_impacts=3000)
    truth = integrated(system, vibeam.Drive(0.12, 0.39), start, 60.0)
    few = 8
    assert path.ended is vibeam.Ended.COMPLETE
    assert path.impact_times[:few] == pytest.approx(truth.times[:few], abs=1e-8)
    assert path.contacts[:few, 1] == pytest.approx(truth.durations[:few], abs=1e-8)
    half = free_mass.duration(stop, 1 / float(np.sum(system.contact**2)))
    assert np.min(path.contacts[:-1, 1]) > half / 2


# --------------------------------------------------------------------------------------------------------- closed forms


@pytest.mark.parametrize("restitution", [0.2, 0.72, 1.0])
def test_a_free_mass_on_a_linear_stop(restitution: float) -> None:
    stop = LinearStop.matched(2e5, restitution, 1.0)
    path = struck(stop, 0.35)
    (contact,) = path.contacts
    assert path.impact_velocities == pytest.approx([0.35], rel=1e-14)
    assert contact[1] == pytest.approx(free_mass.duration(stop, 1.0), rel=1e-12)
    assert path.state.velocity == pytest.approx([-restitution * 0.35], rel=1e-13)
    if restitution == 1:
        assert contact[1] == pytest.approx(pi / sqrt(2e5), rel=1e-12)
        assert contact[2] == pytest.approx(0.35 * sqrt(2e5), rel=1e-10)


def test_a_free_mass_on_a_hertzian_stop() -> None:
    """Hertz: d_max from the energy, contact time 2.9432 d_max/v = 2 ∫₀¹ dx/√(1 − x^{5/2}) d_max/v."""
    stop = Hertz(1e9)
    path = struck(stop, 0.35)
    (contact,) = path.contacts
    deep = free_mass.depth(stop, 1.0, 0.35)
    assert contact[2] == pytest.approx(1e9 * deep**1.5, rel=1e-10)
    mpmath = pytest.importorskip("mpmath")
    constant = float(2 * mpmath.beta(mpmath.mpf(2) / 5, 0.5) / 2.5)
    assert constant == pytest.approx(2.9432, abs=1e-4)
    assert contact[1] == pytest.approx(constant * deep / 0.35, rel=1e-10)
    assert path.state.velocity == pytest.approx([-0.35], rel=1e-11)
    times = contact[0] + contact[1] * np.linspace(0, 1, 7)
    depths, speeds = path.at(times), path.velocity_at(times)
    energy = speeds**2 / 2 + 1e9 * np.maximum(depths, 0) ** 2.5 / 2.5
    assert energy == pytest.approx(np.full(7, 0.35**2 / 2), rel=1e-10)


@pytest.mark.parametrize("restitution", [0.4, 0.9])
def test_a_free_mass_on_hunt_and_crossleys_stop(restitution: float) -> None:
    path = struck(HuntCrossley.matched(1e9, restitution, 0.35), 0.35)
    assert path.state.velocity == pytest.approx([-restitution * 0.35], rel=1e-10)


def test_each_impact_has_the_restitution_of_its_velocity() -> None:
    """A mass thrown against the stop by a constant force: every impact by the table, every flight 2v/a."""
    system = one_mode(TABLE, static=1.0)
    start = vibeam.State(np.array([-0.02]), np.zeros(1))
    path = vibeam.simulate(system, vibeam.Drive(0.0, 0.0), 1.2, start)
    v, t, expected = 0.2, 0.2, []
    within = Bound()
    while within(t <= 1.2):
        expected.append((t, v))
        v = TABLE.at(v) * v
        t += 2 * v
    assert np.stack([path.impact_times, path.impact_velocities], axis=1) == pytest.approx(np.array(expected), rel=1e-11)


def test_a_mass_between_two_stops_rattles_with_the_period_of_its_speed() -> None:
    """Undamped and elastic: 2 (gap + second)/v; with R the flights grow by 1/R each."""
    start = vibeam.State(np.zeros(1), np.array([0.5]))
    elastic = vibeam.simulate(one_mode(gap=0.01, second_gap=0.03, restitution=1.0), vibeam.Drive(0, 0), 1.0, start)
    assert np.diff(elastic.impact_times) == pytest.approx(np.full(12, 0.04 / 0.5), rel=1e-12)
    lossy = vibeam.simulate(one_mode(gap=0.01, second_gap=0.03, restitution=0.8), vibeam.Drive(0, 0), 1.0, start)
    flights = np.diff(lossy.impact_times)
    assert flights == pytest.approx(0.04 / 0.5 / 0.8 ** np.arange(1, len(flights) + 1), rel=1e-12)
    stop = LinearStop(1e5)
    soft = vibeam.simulate(one_mode(stop, gap=0.01, second_gap=0.03), vibeam.Drive(0, 0), 1.0, start)
    assert np.diff(soft.impact_times) == pytest.approx(
        np.full(len(soft.impact_times) - 1, 0.04 / 0.5 + free_mass.duration(stop, 1.0)), rel=1e-12
    )


def test_two_stops_mirror_each_other() -> None:
    for law in (None, LinearStop.matched(3e5, 0.7, 0.2), HUNT):
        system = made(2, law=law, second=3e-4, coupled=law is None)
        turned = replace(system, contact=-system.contact, gap=3e-4, second_gap=2e-4)
        one = vibeam.simulate(system, DRIVE, 2 * PERIOD, still(2))
        two = vibeam.simulate(turned, DRIVE, 2 * PERIOD, still(2))
        assert two.impact_times == pytest.approx(one.impact_times, rel=1e-10)


# --------------------------------------------------------------------------------------------------------------- limits


@pytest.mark.parametrize("n", [1, 10])
def test_a_stiff_stop_with_matched_loss_goes_over_to_restitution(n: int) -> None:
    """The difference after three impacts falls as 1/√k, as the contact time does."""
    omega = 48 * np.linspace(1, 3, n) ** 2
    contact = 2.2 * np.cos(np.arange(n))
    base = {"omega": omega, "zeta": 0.02, "contact": contact, "load": np.full(n, 0.4) / (1 + np.arange(n)), "gap": 1e-4}
    mass = 1 / float(np.sum(contact**2))
    hard = vibeam.ImpactSystem.from_modes(**base, restitution=0.7)
    start = still(n)
    end = vibeam.simulate(hard, DRIVE, 1.0, start).impact_times[2] + 1e-3
    limit = vibeam.simulate(hard, DRIVE, end, start)
    gaps = []
    for stiffness in (1e9, 1e11, 1e13):
        soft = vibeam.ImpactSystem.from_modes(**base, law=LinearStop.matched(stiffness, 0.7, mass))
        path = vibeam.simulate(soft, DRIVE, end, start)
        gaps.append(float(np.linalg.norm(path.state.velocity - limit.state.velocity)))
    orders = np.log(np.array(gaps[:-1]) / gaps[1:]) / np.log(100)
    assert orders == pytest.approx([0.5, 0.5], abs=0.12)


def test_a_second_stop_far_away_changes_nothing() -> None:
    plain = made(3)
    one = vibeam.simulate(plain, DRIVE, 6 * PERIOD, still(3))
    two = vibeam.simulate(replace(plain, second_gap=1.0), DRIVE, 6 * PERIOD, still(3))
    assert two.impact_times == pytest.approx(one.impact_times, rel=1e-11)


def test_equilibrium_pressed_into_a_stop_that_yields_stays() -> None:
    for law in (LinearStop(1e5, 3.0), Hertz(1e7)):
        system = made(2, law=law, gap=-5e-4, coupled=True)
        path = vibeam.simulate(system, vibeam.Drive(0.0, 0.0), 0.2)
        first = path.modes_at(0.0)[0]
        assert np.max(np.abs(path.modes_at(np.linspace(0, 0.2, 9))[:, 0] - first)) < 1e-9 * np.max(np.abs(first))
        assert system.contact @ first > system.gap


# -------------------------------------------------------------------------------------------------- what is taken where


def test_a_plain_system_runs_on_the_flight_kernels_and_others_do_not() -> None:
    from vibeam.solvers import solver

    assert isinstance(solver("flight", made(2), 95.0), FlightSolver)
    assert made(2, law=Restitution(0.7)).beyond_plain == ()
    for system in (made(2, law=TABLE), made(2, coupled=True), made(2, second=1.0)):
        assert isinstance(solver("flight", system, 95.0), RegimeSolver)


@pytest.mark.parametrize("name", ["averaging", "mapping", "zhuravlev", "ivanov", "moreau", "direct"])
def test_solvers_refuse_what_they_cannot_take(name: str) -> None:
    from vibeam.solvers import solver

    for system, what in ((made(1, law=LinearStop(1e5)), '"linear"'), (made(1, second=1.0), "second stop")):
        with pytest.raises(ValueError, match=what):
            solver(name, system, 95.0)
    with pytest.raises(ValueError, match="couples"):
        vibeam.boundaries(made(2, coupled=True), DRIVE.amplitude, (0.9 * DRIVE.omega, DRIVE.omega))


@pytest.mark.parametrize(("law", "coupled"), [(TABLE, False), (None, True), (TABLE, True)])
def test_the_direct_solver_finds_the_same_impacts_and_rests(law, coupled: bool) -> None:
    """Its own events, its own rest on the stop: a pressed one that chatters to rest, then is drawn away."""
    from vibeam.solvers.integration.direct import DirectSolver

    for gap in (2e-4, -1e-4):
        system = made(2, law=law, coupled=coupled, gap=gap)
        direct = DirectSolver(system, DRIVE.omega, method="DOP853", rtol=1e-11, atol=1e-15)
        motion = direct.motion(DRIVE, still(2) if gap > 0 else None, 0.0, 2 * PERIOD)
        path = vibeam.simulate(system, DRIVE, 2 * PERIOD, still(2) if gap > 0 else None)
        few = min(5, len(path.impact_times))
        assert path.impact_times[:few] == pytest.approx(motion.impact_times[:few], abs=1e-8 * PERIOD)
        times = motion.times[(motion.times < (path.impact_times[few - 1] if few else np.inf))][:-1:20]
        at = np.searchsorted(motion.times, times)
        assert path.at(times) == pytest.approx(motion.displacement()[at], abs=1e-11)


def test_what_makes_no_system_is_refused() -> None:
    with pytest.raises(ValueError, match="symmetric"):
        vibeam.ImpactSystem.from_modes([1, 2], 0, 1, 1, coupling=[[1, 0], [1, 1]])
    with pytest.raises(ValueError, match="energy"):
        vibeam.ImpactSystem.from_modes([1, 2], 0, 1, 1, coupling=[[1, 2], [2, 1]])
    with pytest.raises(ValueError, match="2 × 2"):
        vibeam.ImpactSystem.from_modes([1, 2], 0, 1, 1, coupling=[[1]])
    with pytest.raises(ValueError, match="second_gap"):
        vibeam.ImpactSystem.from_modes([1], 0, 1, 1, gap=-1e-3, second_gap=1e-3)


@pytest.mark.parametrize("law", [None, LinearStop(3e4, 2.0)])
def test_another_gap_takes_no_other_blocks(law: object) -> None:
    """They are kept: found once for a sweep with drift, read-only, and to the bit those found anew."""
    from vibeam.flight.linear import blocks
    from vibeam.flight.linear.eigenpairs import LinearSystem
    from vibeam.flight.linear.regimes import damper_of

    system = made(4, law=law, coupled=True)
    linear = LinearSystem(system.omega**2, damper_of(system), system.contact)
    kept, anew = blocks.planes(linear), blocks._found(linear)
    for name in ("columns", "inverse", "blocks"):
        array = getattr(kept, name)
        np.testing.assert_array_equal(array, getattr(anew, name))
        assert not array.flags.writeable
    before = blocks._kept.cache_info().misses
    RegimeSolver(system, DRIVE.omega)
    first = blocks._kept.cache_info().misses
    RegimeSolver(replace(system, gap=3e-4), DRIVE.omega)
    assert before <= first == blocks._kept.cache_info().misses
