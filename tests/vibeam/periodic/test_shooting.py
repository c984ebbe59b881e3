"""Periodic motions by shooting: closed forms as special cases, flights as the judge, reasons where there is none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

import vibeam
from tests.vibeam.periodic.test_orbits import COCO, beam_like
from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.boundaries import boundaries
from vibeam.periodic.closed_orbits import closed_orbits
from vibeam.periodic.lift import lifted
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.shooting import NoOrbit, Reason, shoot
from vibeam.periodic.stroboscopic import MotionEnded, StroboscopicMap
from vibeam.solvers.harmonic_point import steady_point
from vibeam_models.laws.compliant import HuntCrossley, LinearStop


def closed(modes: range, seeds: range, periods: int = 1) -> list[Orbit]:
    """Admissible orbits of random plain systems."""
    found = []
    for system in (beam_like(n, seed) for n in modes for seed in seeds):
        for omega in (1.3, 1.9):
            found += vibeam.orbits(system, vibeam.Drive(periods * omega, 0.5 / periods), periods)
    return [orbit for orbit in found if orbit.admissible]


def test_orbits_shot_at_from_a_disturbed_start_are_those_in_closed_form() -> None:
    """To 1e-12 of the motion's size; multipliers, whose condition is that of the monodromy matrix, to 1e-9 of it."""
    rng, seen = np.random.default_rng(0), 0
    for orbit in [*closed(range(1, 9), range(16)), *closed(range(1, 5), range(8), 2)]:
        section = StroboscopicMap(orbit.system, orbit.drive)
        time, state = lifted(orbit, orbit.system)
        section = section.at(time)
        size = np.linalg.norm(section.vector(state))
        start = section.moved(state, 1e-5 * size * rng.normal(size=2 * orbit.system.size))
        found = shoot(section, start, orbit.periods)
        assert np.linalg.norm(section.vector(found.state) - section.vector(state)) < 1e-12 * size * condition(orbit)
        assert found.velocities == pytest.approx(orbit.velocities, rel=1e-12 * condition(orbit))
        period = orbit.span / orbit.periods
        late = np.mod(found.times - orbit.times + period / 2, period) - period / 2
        assert abs(late[0]) < 1e-12 * orbit.span * condition(orbit)
        assert found.residual < 1e-13
        assert found.stable == orbit.stable
        seen += 1
        if orbit.system.size > 5:  # weak ones take their time
            continue
        largest = np.abs(orbit.multipliers[0])
        np.testing.assert_allclose(
            np.sort(np.abs(found.multipliers)), np.sort(np.abs(orbit.multipliers)), atol=1e-9 * max(largest, 1)
        )
    assert seen > 180


def condition(orbit: Orbit) -> float:
    """Largest response of a fixed point to an error of the map, at least 1."""
    return float(max(1.0, 1 / np.abs(1 - orbit.multipliers).min()))


def test_a_yielding_stop_goes_over_to_the_hard_one() -> None:
    """As k grows the orbit of the linear stop tends to that of the restitution it gives, by 1/√k of contact time."""
    drive = vibeam.Drive(2.0, 1.0)
    hard = next(each for each in vibeam.orbits(COCO, drive) if each.stable and each.admissible)
    apart = []
    for stiffness in (1e4, 1e6, 1e8):
        soft = replace(COCO, law=LinearStop.matched(stiffness, 0.8, 1.0))
        [found] = vibeam.orbits(soft, drive, start=hard)
        assert found.residual < 1e-13
        apart.append(abs(found.velocity / hard.velocity - 1))
    assert apart[2] < 2e-3
    np.testing.assert_allclose(np.array(apart[:2]) / apart[1:], 10, rtol=0.1)


def test_reasons_where_there_is_no_such_motion() -> None:
    orbit = next(each for each in vibeam.orbits(COCO, vibeam.Drive(2.0, 1.0)) if each.admissible)
    assert reason(COCO, orbit.drive, orbit.state, periods=2, time=orbit.time) is Reason.SHORTER
    assert reason(COCO, vibeam.Drive(0.0, 0.0), orbit.state) is Reason.NO_PERIOD
    assert reason(COCO, orbit.drive, vibeam.State([1.5], [0.0])) is Reason.ENDED
    assert reason(COCO, vibeam.Drive(2.0, 0.01), orbit) is Reason.LEFT  # the drive is too weak to reach the stop
    thrown = vibeam.ImpactSystem.from_modes(0.0, 0.0, 1.0, 1.0, gap=1.0, static=[-1.0])
    assert reason(thrown, orbit.drive, vibeam.State([0.0], [0.0])) is Reason.DRIFTS
    resonant = vibeam.ImpactSystem.from_modes(2.0, 0.0, 1.0, 1.0, gap=1e6)
    assert reason(resonant, orbit.drive, vibeam.State([0.0], [0.0])) is Reason.DRIFTS


def test_a_map_without_derivative_is_a_reason_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """A touch without velocity makes it infinite; where it is differenced a flight beside the motion may end."""
    orbit = next(each for each in vibeam.orbits(COCO, vibeam.Drive(2.0, 1.0)) if each.admissible)

    def ended(*_: object) -> None:
        raise MotionEnded("the motion ended: beside it")

    monkeypatch.setattr(StroboscopicMap, "jacobian", lambda *_: np.full((2, 2), np.inf))
    assert reason(COCO, orbit.drive, orbit.state, time=orbit.time) is Reason.DIVERGED
    monkeypatch.setattr(StroboscopicMap, "jacobian", ended)
    assert reason(COCO, orbit.drive, orbit.state, time=orbit.time) is Reason.ENDED


@pytest.mark.parametrize("modes", [1, 2])
def test_beyond_a_fold_newton_says_so(modes: int) -> None:
    """On both sides of a fold, 1e-6 to 1e-3 away: inside the motion is found, beyond the fold is named."""
    system = vibeam.ImpactSystem.from_modes(
        [1.0, 6.3][:modes], 0.015, [1.0, 0.3][:modes], [1.0, 0.2][:modes], gap=2e-3, restitution=0.9
    )
    (fold,) = boundaries(system, 0.5e-3, (1.7, 3.0), kinds=(Kind.FOLD,))
    side = 1 if vibeam.orbits(system, vibeam.Drive(fold.omega * 0.999, 0.5e-3)) else -1
    for share in (1e-6, 1e-4, 1e-3):
        inside, beyond = (vibeam.Drive(fold.omega * (1 - way * share), 0.5e-3) for way in (side, -side))
        assert not vibeam.orbits(system, beyond)
        both = [each for each in vibeam.orbits(system, inside) if each.admissible]
        assert {each.stable for each in both} == {True, False}
        for orbit in both:
            [again] = vibeam.orbits(system, inside, start=orbit)
            assert again.velocity == pytest.approx(orbit.velocity, rel=1e-8)
            assert reason(system, beyond, orbit) is Reason.FOLD


def reason(
    system: vibeam.ImpactSystem, drive: vibeam.Drive, start: object, periods: int = 1, time: float = 0
) -> Reason:
    with pytest.raises(NoOrbit) as refused:
        vibeam.orbits(system, drive, periods, start=start, time=time)
    return refused.value.reason


@pytest.mark.parametrize("law", [LinearStop(2e3, 8.0), HuntCrossley(1e5, 0.2)])
def test_flights_from_the_orbit_come_back(law: object) -> None:
    system = vibeam.ImpactSystem.from_modes(
        [1.0, 5.5, 14.0], 0.03, [1.0, -0.8, 0.6], [1.0, 0.5, 0.2], gap=0.1, law=law, second_gap=0.15
    )
    found = vibeam.orbits(system, vibeam.Drive(2.1, 0.2))  # the linear one settles, the other is chaotic
    assert found
    for orbit in found:
        after = orbit.path().state
        np.testing.assert_allclose(after.displacement, orbit.state.displacement, atol=1e-10)
        np.testing.assert_allclose(after.velocity, orbit.state.velocity, atol=1e-10)
        assert orbit.residual < 1e-10  # integrated contact to 1e-12 a step, grown by multipliers of some ten
        assert orbit.reach == pytest.approx(
            0.1 - orbit.path().at(np.linspace(0, 1, 40001) * orbit.span + orbit.time).min(), rel=1e-5
        )


@pytest.mark.parametrize("law", [None, LinearStop.matched(1e4, 0.5, 0.8)])
def test_orbits_under_several_harmonics_are_what_flights_settle_on(law: LinearStop | None) -> None:
    """Amplitude of the settled steady point to 1e-9; the multipliers are the modes' alone, none of an oscillator."""
    outputs, drive = {"tip": [1.3, -0.2]}, vibeam.Drive(2.1, 0.1)
    plain = vibeam.ImpactSystem.from_modes(
        [1.0, 6.0], [0.05, 0.03], [1.0, 0.4], [1.0, 0.3], restitution=0.5, gap=0.05, outputs=outputs, law=law
    )
    shares = [(2, 0.1, 0.3), (3, 0.05, 1.0)]
    harmonics = tuple(vibeam.Harmonic(j, share * drive.omega**2 * drive.amplitude, phase) for j, share, phase in shares)
    several = vibeam.SeveralHarmonics(plain, drive, harmonics)
    [orbit] = vibeam.orbits(several, drive)
    settings = {"settle": 300, "hold": 2, "solver_name": "flight", "output": "tip", "slowest": 2.1, "options": {}}
    point, _ = steady_point(several, None, **settings)
    assert orbit.amplitude("tip") == pytest.approx(point.amplitude[0], rel=1e-9)
    assert orbit.stable
    assert len(orbit.multipliers) == 4
    before, after = several.leave(orbit.state, orbit.time), several.leave(orbit.path().state, orbit.time + orbit.span)
    np.testing.assert_allclose(after.displacement, before.displacement, atol=1e-14)
    [again] = vibeam.orbits(several, drive, start=vibeam.orbits(replace(plain, law=None), drive)[0])
    assert again.velocity == pytest.approx(orbit.velocity, rel=1e-12)


def test_published_numbers_of_coco() -> None:
    """COCO's impact demo, ẍ + 0.1ẋ + x = cos t with a stop at 1, e = 0.8: all printed digits, from rest."""
    [orbit] = vibeam.orbits(COCO, vibeam.Drive(1.0, 1.0), start=vibeam.State([0.0], [0.0]))
    assert (orbit.phase - np.pi / 2) % (2 * np.pi) == pytest.approx(0.07595216, abs=5e-8)
    assert orbit.velocity == pytest.approx(1.69573294, abs=6e-8)
    assert orbit.multipliers[0] == pytest.approx(-0.584295 + 0.005600j, abs=1.2e-6)


@pytest.mark.parametrize("second", [False, True])
def test_one_mode_between_symmetric_stops(second: bool) -> None:
    """Closed form of the motion that strikes both stops in turn, x(t + T/2) = −x(t); a second stop, a second contact.

    With p (a, b) the free part just after the impact at t = 0 and P its flow over T/2: (P + 1)(a, b) = (0, 1),
    Im(H e^iψ) + pa = Δ, Ω Re(H e^iψ) + p(b − 1) = v = −p/(1 + R), a quadratic in p (Masri & Caughey 1966; Shaw 1985).
    """
    gap, restitution, rate, drive = 0.4, 0.7, 1.4, vibeam.Drive(1.4, 0.5)
    other = {"second_gap": gap} if second else {"further": [vibeam.Contact([-1.0], gap, restitution)]}
    system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, gap=gap, restitution=restitution, **other)
    flow = expm(np.array([[0.0, 1.0], [-1.0, -0.1]]) * np.pi / rate)
    a, b = np.linalg.solve(flow + np.eye(2), [0.0, 1.0])
    response = abs(rate**2 * 0.5 / (1 - rate**2 + 0.1j * rate))
    kappa = (1 - 1 / (1 + restitution) - b) / rate
    impulse = np.roots([a**2 + kappa**2, -2 * a * gap, gap**2 - response**2]).real.min()
    velocity = -impulse / (1 + restitution)
    found = vibeam.orbits(system, drive)
    [orbit] = [each for each in found if each.contacts.tolist() in ([0, 1], [1, 0])]
    np.testing.assert_allclose(orbit.velocities, velocity, rtol=1e-12)
    assert np.diff(orbit.times) == pytest.approx(np.pi / rate, rel=1e-12)
    before = response * np.exp(1j * np.angle(rate**2 * 0.5 / (1 - rate**2 + 0.1j * rate)))
    upper = orbit.times[orbit.contacts == 0][0]
    assert (before * np.exp(1j * rate * upper)).imag + impulse * a == pytest.approx(gap, rel=1e-11)
    half = turned(velocity, gap, upper, drive, restitution) @ flow
    np.testing.assert_allclose(
        np.sort_complex(orbit.multipliers), np.sort_complex(np.linalg.eigvals(half @ half)), rtol=1e-9
    )
    assert orbit.stable == (np.abs(orbit.multipliers[0]) < 1)


def turned(velocity: float, gap: float, time: float, drive: vibeam.Drive, restitution: float) -> np.ndarray:
    """Saltation matrix at the first stop."""
    force = drive.omega**2 * drive.amplitude * np.sin(drive.omega * time)
    before, after = (force - 0.1 * v - gap for v in (velocity, -restitution * velocity))
    return np.array([[-restitution, 0.0], [(restitution * before + after) / velocity, -restitution]])


def test_shot_motions_are_those_in_closed_form() -> None:
    """Every value that motions in closed form have, to 1e-12."""
    system = vibeam.ImpactSystem.from_modes([1.0, 6.0], [0.05, 0.03], [1.0, 0.4], [1.0, 0.3], restitution=0.5)
    stable = 0
    for omega in np.linspace(1.8, 2.4, 7):
        drive = vibeam.Drive(float(omega), 0.1)
        for want in filter(lambda each: each.stable, closed_orbits(system, drive)):
            (got,) = vibeam.orbits(system, drive, start=want.state, time=want.time)
            assert got.stable
            assert got.corrections  # shot: those in closed form have none
            assert got.velocities == pytest.approx(want.velocities, rel=1e-12)
            assert got.amplitude() == pytest.approx(want.amplitude(), rel=1e-12)
            assert got.reach == pytest.approx(want.reach, rel=1e-12)
            assert np.sin(got.phase - want.phase) == pytest.approx(0, abs=1e-12)
            stable += 1
    assert stable >= 6
