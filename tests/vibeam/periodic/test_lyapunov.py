"""Lyapunov exponents: against multipliers in closed form, neighbouring flights, the sum of all, and closed forms."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path

import mpmath
import numpy as np
import pytest
from settled_orbits import closed_multipliers, settled

import vibeam
from vibeam.flight.disturbance.tangent import TangentMaps
from vibeam.periodic.lyapunov import mean_exponents
from vibeam.periodic.stroboscopic import StroboscopicMap
from vibeam.system.state import State
from vibeam_models.laws.compliant import HuntCrossley, LinearStop
from vibeam_models.laws.mechanics import KernelNumbers, StopLaw
from vibeam_models.laws.restitution import PlasticRestitution, TableRestitution, ViscousRestitution

ONE = vibeam.ImpactSystem.from_modes(1.0, 0.01, 1.0, 1.0, gap=0.0, restitution=0.9)
THREE = vibeam.ImpactSystem.from_modes(
    [1.0, 2.6, 7.1], [0.02, 0.05, 1.3], [1.0, 0.6, -0.4], [1.0, 0.3, 0.1], gap=0.3, restitution=0.7
)
WILD = vibeam.Drive(2.9, 1.0)
COUPLED = np.array([[0.05, 0.02, 0.0], [0.02, 0.3, -0.05], [0.0, -0.05, 0.5]])
ENGINES = {
    "one R": THREE,
    "two stops": replace(THREE, second_gap=0.5),
    "coupled damping": replace(THREE, coupling=COUPLED),
    "table R(v)": replace(THREE, law=TableRestitution((0.2, 1.0, 3.0), (0.9, 0.7, 0.5))),
    "plastic R(v)": replace(THREE, law=PlasticRestitution(0.7, 0.5)),
    "viscous R(v)": replace(THREE, law=ViscousRestitution(0.3)),
    "linear stop": replace(THREE, law=LinearStop(400.0)),
    "damped linear stop": replace(THREE, law=LinearStop(400.0, 6.0)),
    "Hertz": replace(THREE, law=HuntCrossley(400.0)),
    "Hunt-Crossley, two stops": replace(THREE, law=HuntCrossley(300.0, 0.4, 1.2), second_gap=0.5),
    "Hunt-Crossley, coupled damping": replace(THREE, law=HuntCrossley(900.0, 0.1, 2.0), coupling=COUPLED),
}


LOUD = 1e-6  # share of the largest multiplier above which the closed form's eigenvalues have ten digits


def in_spans(found: vibeam.LyapunovSpectrum) -> np.ndarray:
    return found.exponents * found.time


def assert_same(found: np.ndarray, multipliers: np.ndarray) -> None:
    loud = np.abs(multipliers) > LOUD * np.abs(multipliers[0])
    np.testing.assert_allclose(found[loud], np.log(np.abs(multipliers[loud])), rtol=0, atol=1e-9)


@pytest.mark.parametrize("system", [ONE, THREE], ids=["one mode", "three modes"])
@pytest.mark.parametrize("periods", [1, 2, 3])
def test_of_periodic_motions_they_are_those_of_the_multipliers(system: vibeam.ImpactSystem, periods: int) -> None:
    """Closed-form orbits, stable or not, know their multipliers by another way: log|μ| to 1e-9."""
    judged = 0
    for omega in periods * np.linspace(1.15, 2.95, 25):
        for orbit in vibeam.orbits(system, vibeam.Drive(omega, 1.0), periods):
            if not orbit.admissible or abs(orbit.multipliers[0]) > 30:
                continue
            found = vibeam.lyapunov(system, orbit.drive, orbit.state, t_start=orbit.time, settle=0)
            assert found.period == periods
            assert_same(in_spans(found), orbit.multipliers)
            judged += 1
    assert judged >= 4


def test_of_motions_with_several_impacts_too() -> None:
    """The multipliers are closed forms in the times of the impacts."""
    counts = set()
    for omega, periods in itertools.product(np.linspace(0.5, 3.0, 26), (1, 2)):
        try:
            orbit = settled(replace(THREE, gap=0.1), vibeam.Drive(omega, 0.4), periods, settle=400)
        except vibeam.NoOrbit:
            continue
        if orbit.rests or not len(orbit.times):
            continue
        found = vibeam.lyapunov(orbit.system, orbit.drive, orbit.state, t_start=orbit.time, settle=0)
        assert found.period == periods
        assert_same(in_spans(found), closed_multipliers(orbit))
        counts.add((len(orbit.times), found.period))
    assert len(counts) >= 3
    assert max(impacts for impacts, _ in counts) >= 3


def test_a_settled_flight_is_refined_to_its_periodic_motion() -> None:
    """From rest, not from the orbit: Newton's method ends on the closed form's orbit."""
    drive = vibeam.Drive(2.0, 1.0)
    orbit = next(o for o in vibeam.orbits(ONE, drive) if o.stable and o.admissible)
    found = vibeam.lyapunov(ONE, drive, settle=100)
    assert found.period == 1
    np.testing.assert_allclose(in_spans(found), np.log(np.abs(orbit.multipliers)), atol=1e-9)


def test_without_impacts_they_are_the_decay_rates() -> None:
    system = replace(THREE, gap=50.0)
    found = vibeam.lyapunov(system, WILD)
    decay = np.sqrt(1.3**2 - 1)
    want = sorted([-0.02, -0.02, -0.13, -0.13, -7.1 * (1.3 - decay), -7.1 * (1.3 + decay)], reverse=True)
    assert (found.period, found.impacts, found.sign) == (1, 0, -1)
    np.testing.assert_allclose(found.exponents, want, rtol=1e-9)


@pytest.mark.parametrize("system", [ONE, replace(THREE, zeta=np.full(3, 0.02))], ids=["one mode", "three modes"])
def test_the_sum_of_all_follows_from_damping_and_impacts(system: vibeam.ImpactSystem) -> None:
    """det of the tangent map: e^(−2σt) a mode, R² an impact."""
    found = vibeam.lyapunov(system, WILD, periods=300)
    assert (found.period, found.sign, found.rests) == (0, 1, 0)
    want = -2 * np.sum(system.zeta * system.omega) + np.log(system.restitution**2) * found.impacts / found.time
    assert found.exponents.sum() == pytest.approx(want, rel=1e-10)


def test_the_largest_is_how_fast_neighbours_part() -> None:
    """Two flights, brought near again after each period: no matrices at all (Benettin's first method)."""
    system, small, grown, periods = ONE, 1e-8, 0.0, 1500
    state = vibeam.simulate(system, WILD, 100 * 2 * np.pi / 2.9).state
    beside = State(state.displacement + small, state.velocity)
    for _ in range(periods):
        state, beside = (vibeam.simulate(system, WILD, 2 * np.pi / 2.9, each).state for each in (state, beside))
        apart = np.concatenate([beside.displacement - state.displacement, beside.velocity - state.velocity])
        size = float(np.linalg.norm(apart))
        grown += np.log(size / small)
        away = apart * (small / size)
        beside = State(state.displacement + away[:1], state.velocity + away[1:])
    parted = grown / (periods * 2 * np.pi / 2.9)
    found = vibeam.lyapunov(system, WILD, periods=1500)
    assert found.errors[0] < 0.02
    assert abs(found.largest - parted) < 4 * np.hypot(found.errors[0], 0.02)
    assert 0.1 < parted < 0.3


@pytest.mark.parametrize("name", ENGINES)
def test_tangent_maps_against_neighbouring_flights(name: str) -> None:
    """The Jacobian over two drive periods, by central differences of flights."""
    system, small = ENGINES[name], 1e-6
    here = StroboscopicMap(system, WILD)
    section, start = here.in_flight(here.flown(None, 3).state)
    flown = section.flown(start, 1.4)
    assert len(flown.segments.trace) >= 2
    columns = []
    for k in range(2 * system.size):
        ends = [section.flown(moved(start, side * small, k), 1.4).state for side in (1, -1)]
        both = [np.concatenate([end.displacement, end.velocity]) for end in ends]
        columns.append((both[0] - both[1]) / (2 * small))
    want = np.array(columns).T
    np.testing.assert_allclose(
        TangentMaps(flown.system, flown.drive, flown.segments, flown.state).product(),
        want,
        atol=2e-6 * np.abs(want).max(),
    )


def moved(state: State, by: float, k: int) -> State:
    shift = by * np.eye(2 * len(state.displacement))[k]
    n = len(state.displacement)
    return State(state.displacement + shift[:n], state.velocity + shift[n:])


PRESSED = replace(THREE, gap=0.0, restitution=0.3, static=np.array([1.5, 0.0, 0.0]))


def test_a_rest_on_the_stop_loses_two_directions() -> None:
    found = vibeam.lyapunov(PRESSED, vibeam.Drive(1.3, 2.0), settle=60)
    assert found.rests > 0
    assert found.period > 0
    assert list(np.isneginf(found.exponents)) == [False] * 4 + [True] * 2
    alone = replace(ONE, restitution=0.3, static=np.array([1.5]))
    assert np.all(np.isneginf(vibeam.lyapunov(alone, vibeam.Drive(1.3, 2.0), settle=20).exponents))


def test_multipliers_through_a_rest_against_neighbouring_flights() -> None:
    drive, small = vibeam.Drive(1.3, 2.0), 1e-6
    found = vibeam.lyapunov(PRESSED, drive, settle=60)
    section, columns = StroboscopicMap(PRESSED, drive, found.phase_time), []
    for k in range(6):
        ends = [section.flown(moved(found.state, side * small, k), found.period).state for side in (1, -1)]
        both = [np.concatenate([end.displacement, end.velocity]) for end in ends]
        columns.append((both[0] - both[1]) / (2 * small))
    values = np.sort(np.abs(np.linalg.eigvals(np.array(columns).T)))[::-1]
    loud = values > 1e-3
    assert loud.sum() >= 2
    got = np.exp(in_spans(found))
    np.testing.assert_allclose(got[: loud.sum()], values[loud], rtol=2e-3)


def test_a_stop_without_rebound_loses_one_direction() -> None:
    system = vibeam.ImpactSystem.from_modes([1.0, 2.6], [0.02, 0.05], [1.0, 0.6], [1.0, 0.3], gap=1.0, restitution=0.0)
    drive = vibeam.Drive(1.65, 1.0)
    found = vibeam.lyapunov(system, drive, settle=200)
    orbit = next(o for o in vibeam.orbits(system, drive) if o.admissible and o.stable)
    assert (found.period, found.rests) == (1, 0)
    assert list(np.isneginf(found.exponents)) == [False] * 3 + [True]
    np.testing.assert_allclose(in_spans(found)[:3], np.log(np.abs(orbit.multipliers[:3])), atol=1e-9)


def test_weak_multipliers_against_arbitrary_precision() -> None:
    """A mode that dies within the period: e^-40 beside 0.5, from P and the saltation matrix in 80 digits."""
    system = vibeam.ImpactSystem.from_modes(
        [1.0, 6.0, 40.0], [0.02, 0.1, 0.4], [1.0, 0.7, -0.5], [1.0, 0.4, 0.2], gap=0.1, restitution=0.7
    )
    drives = [vibeam.Drive(omega, 1.0) for omega in np.linspace(1.6, 2.8, 25)]
    orbit = next(o for drive in drives for o in vibeam.orbits(system, drive) if o.admissible)
    with mpmath.workdps(80):
        want = sorted((float(mpmath.log(abs(value))) for value in exact_multipliers(orbit)), reverse=True)
    found = vibeam.lyapunov(system, orbit.drive, orbit.state, t_start=orbit.time, settle=0)
    assert want[-1] < want[0] - 40
    np.testing.assert_allclose(in_spans(found), want, rtol=0, atol=1e-9)


def exact_multipliers(orbit: vibeam.Orbit) -> list[mpmath.mpc]:
    system, n = orbit.system, orbit.system.size
    c = [mpmath.mpf(x) for x in system.contact]
    mobility, r = sum(x * x for x in c), mpmath.mpf(system.restitution)
    flown, leap = mpmath.zeros(2 * n), mpmath.eye(2 * n)
    toward = mpmath.mpf(0)
    for i in range(n):
        w, z, t = (mpmath.mpf(x) for x in (system.omega[i], system.zeta[i], orbit.span))
        s, d = w * z, w * mpmath.sqrt(1 - z * z)
        e, sine, cosine = mpmath.exp(-s * t), mpmath.sin(d * t) / d, mpmath.cos(d * t)
        flown[i, i], flown[i, n + i] = e * (cosine + s * sine), e * sine
        flown[n + i, i], flown[n + i, n + i] = -w * w * e * sine, e * (cosine - s * sine)
        before = mpmath.mpf(orbit.state.velocity[i]) - c[i] * mpmath.mpf(orbit.impulse)
        push = system.load[i] * mpmath.mpf(orbit.drive.omega) ** 2 * mpmath.sin(orbit.phase)
        toward += c[i] * (push - 2 * s * before - w * w * mpmath.mpf(orbit.state.displacement[i]))
    lean = toward / mpmath.mpf(orbit.velocity)
    for i in range(n):
        turned = 2 * mpmath.mpf(system.omega[i]) * mpmath.mpf(system.zeta[i]) + lean
        for j in range(n):
            share = (1 + r) / mobility * c[i] * c[j]
            leap[i, j] -= share
            leap[n + i, n + j] -= share
            leap[n + i, j] += share * turned
    return list(mpmath.eig(leap * flown, left=False, right=False))


def test_of_the_rig_with_eight_modes() -> None:
    case = vibeam.load(Path(__file__).parents[3] / "cases" / "dtu_neutral.toml")
    system, amplitude = case.system("beam"), float(case.base_amplitude)
    judged = 0
    for frequency in (15.0, 15.5, 16.0):
        for orbit in vibeam.orbits(system, vibeam.Drive(2 * np.pi * frequency, amplitude)):
            if orbit.admissible:
                found = vibeam.lyapunov(system, orbit.drive, orbit.state, t_start=orbit.time, settle=0)
                assert_same(in_spans(found), orbit.multipliers)
                judged += 1
    assert judged >= 3


def test_fewer_exponents_are_the_same_ones() -> None:
    whole, first = (vibeam.lyapunov(ONE, WILD, periods=60, count=k) for k in (None, 1))
    assert first.exponents.shape == (1,)
    assert first.largest == pytest.approx(whole.largest, abs=4 * (whole.errors[0] + first.errors[0]))
    assert 1 < whole.dimension < 2


@pytest.mark.parametrize("further", [(), (vibeam.Contact([-0.8, 0.3, 0.5], 6.0, 0.85),)], ids=["one", "two contacts"])
def test_one_disturbance_is_carried_through_impacts_and_rests(further: tuple[vibeam.Contact, ...]) -> None:
    """A motion that repeats, as if it did not: the mean tends to the exponent of its multipliers, as 1/time."""
    system, drive = replace(PRESSED, further=further), vibeam.Drive(1.3, 2.0)
    known = vibeam.lyapunov(system, drive, settle=60)
    mean = mean_exponents(StroboscopicMap(system, drive, known.phase_time), known.state, 100, 1)
    assert mean.largest == pytest.approx(known.largest, rel=1e-3)
    assert mean.rests == 100 * known.rests > 0


def test_one_mode_that_rests_has_no_disturbance_left() -> None:
    alone, drive = replace(ONE, restitution=0.3, static=np.array([1.5])), vibeam.Drive(1.3, 2.0)
    known = vibeam.lyapunov(alone, drive, settle=20)
    assert mean_exponents(StroboscopicMap(alone, drive, known.phase_time), known.state, 20, 1).largest == -np.inf


class Unknown(StopLaw):
    """A law that flies, and whose R(v) v has no derivative."""

    name = "unknown"

    def at(self, velocity: float) -> float:
        return 0.7

    def kernel_numbers(self) -> KernelNumbers:
        return KernelNumbers("constant", {"coefficient": 0.7})


def test_what_is_not_known_is_refused() -> None:
    with pytest.raises(ValueError, match=r'exponents are not known for the contact law "unknown"'):
        vibeam.lyapunov(replace(THREE, law=Unknown()), WILD)


def test_the_sum_of_all_holds_with_several_contacts() -> None:
    """Each impact takes R² of its own contact from the volume, wherever it is."""
    system = replace(THREE, zeta=np.full(3, 0.02), further=(vibeam.Contact([-0.8, 0.3, 0.5], 0.6, 0.85),))
    found = vibeam.lyapunov(system, WILD, periods=100)
    path = vibeam.simulate(system, WILD, found.time, found.state, t_start=found.phase_time)
    assert (found.rests, found.period) == (0, 0)
    assert set(path.impact_contacts) == {0, 1}
    damping = -2 * np.sum(system.zeta * system.omega)
    share = (found.exponents.sum() - damping) * found.time / found.impacts
    assert np.log(0.7**2) < share < np.log(0.85**2)
    assert share == pytest.approx(np.mean(np.log(np.array([0.7, 0.85])[path.impact_contacts] ** 2)), rel=0.1)


def test_a_motion_that_ends_on_the_way_is_refused_like_all_else() -> None:
    loose = vibeam.ImpactSystem.from_modes([1e-300], 0.02, [1.0], [1.0], gap=0.1)
    with pytest.raises(ValueError, match="the motion ended"):
        vibeam.lyapunov(loose, vibeam.Drive(1.0, 1.0), settle=2, periods=20)


def test_faults_in_arguments_are_all_named() -> None:
    with pytest.raises(ValueError, match=r"(?s)settle.*periods.*count"):
        vibeam.lyapunov(ONE, WILD, settle=-1, periods=3, count=9)
    with pytest.raises(ValueError, match="omega"):
        vibeam.lyapunov(ONE, vibeam.Drive(0.0, 1.0))
