"""Where motions with several impacts are born, end or lose stability: births by a subcritical doubling, the flight."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
from bounded import Bound
from scipy.optimize import fsolve, minimize_scalar
from settled_orbits import missed, settled, shot, trains

from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.boundaries import Boundary, boundaries
from vibeam.periodic.branch_walk import BranchEnd
from vibeam.periodic.follow import follow
from vibeam.periodic.orbit import Orbit
from vibeam.system.impact_system import Drive, ImpactSystem

AMPLITUDE = 0.3


def three(omega: list[float], zeta: float, contact: list[float], load: list[float], gap: float, restitution: float):  # type: ignore[no-untyped-def]
    return ImpactSystem.from_modes(
        [1.0, *omega], zeta, [1.0, *contact], [1.0, *load], gap=gap, restitution=restitution
    )  # fmt: skip


#: found by searching random systems; the fold lies 5e-4 … 7e-7 of the frequency from the doubling
RIGS = {
    "5e-4": (three([4.672, 10.516], 0.02, [0.439, 0.466], [-0.088, -0.422], 0.25, 0.9), 0.80676),
    "3e-3": (three([5.93, 7.9], 0.05, [-0.347, 0.519], [0.569, 0.008], 0.37, 0.82), 0.77595),
    "4e-5": (three([4.462, 9.845], 0.05, [0.373, -0.147], [0.837, -0.645], -0.19, 0.87), 2.97152),
    "7e-7": (three([5.863, 8.116], 0.02, [0.381, -0.209], [-0.266, 0.144], -0.24, 0.41), 2.94142),
}


class Pair(NamedTuple):
    """Two impacts in two periods: frequency, mean phase, impulses, and half the difference of the phases."""

    omega: float
    phase: float
    impulses: tuple[float, float]
    apart: float


@cache
def doubling(name: str) -> Boundary:
    """The doubling of the motion with one impact."""
    system, omega = RIGS[name]
    found = boundaries(system, AMPLITUDE, (0.995 * omega, 1.005 * omega), points=101, kinds=(Kind.DOUBLING,))
    return min((b for b in found if b.clear), key=lambda b: abs(b.omega - omega))


def pair_at(name: str, apart: float, near: Pair | None = None) -> Pair:
    """The motion with two impacts whose phases differ by π + 2 ``apart``: the frequency is solved for, not given."""
    system, at = RIGS[name][0], doubling(name)
    impulse = -(1 + system.restitution) * at.velocity / float(system.contact @ system.contact)
    start = near or Pair(at.omega, at.phase, (impulse, impulse), apart)

    def residual(unknown: np.ndarray) -> np.ndarray:
        omega, phase, *impulses = unknown * [at.omega, 1.0, impulse, impulse]
        span = 4 * np.pi / omega
        times = np.array([(phase + apart) / omega, (phase - apart) / omega + span / 2])
        values = missed(system, trains(Drive(omega, AMPLITUDE), 2, times, np.array(impulses)))
        return values / np.repeat([at.velocity / at.omega, at.velocity], 2)

    guess = np.array([start.omega / at.omega, start.phase, *(p / impulse for p in start.impulses)])
    found, _, _, _ = fsolve(residual, guess, xtol=1e-14, full_output=True)
    assert np.abs(residual(found)).max() < 1e-10
    omega, phase, first, second = found * [at.omega, 1.0, impulse, impulse]
    return Pair(float(omega), float(phase), (float(first), float(second)), apart)


@cache
def curve(name: str) -> list[Pair]:
    """The branch from its birth on, past its fold and back beyond the doubling's frequency."""
    found = [pair_at(name, 0.004)]
    within = Bound()
    while within((found[-1].omega - doubling(name).omega) * (found[0].omega - doubling(name).omega) > 0):
        found.append(pair_at(name, found[-1].apart + 0.004, found[-1]))
    return found


def fold_of(name: str) -> float:
    """The extreme of the frequency along the branch, on which its distance from the birth is the parameter."""
    at, pairs = doubling(name).omega, curve(name)
    side = np.sign(pairs[0].omega - at)
    peak = int(np.argmax([side * pair.omega for pair in pairs]))

    def below(apart: float) -> float:
        return -side * pair_at(name, apart, pairs[peak]).omega

    bounds = pairs[peak - 1].apart, pairs[peak + 1].apart
    return abs(float(minimize_scalar(below, bounds=bounds, method="bounded", options={"xatol": 1e-7}).fun))


def orbit_of(name: str, pair: Pair) -> Orbit:
    system = RIGS[name][0]
    span = 4 * np.pi / pair.omega
    times = np.array([(pair.phase + pair.apart) / pair.omega, (pair.phase - pair.apart) / pair.omega + span / 2])
    drive = Drive(pair.omega, AMPLITUDE)
    found = shot(system, drive, trains(drive, 2, times, np.array(pair.impulses)))
    want = -np.array(pair.impulses) * float(system.contact @ system.contact) / (1 + system.restitution)
    assert np.sort(found.velocities) == pytest.approx(np.sort(want), rel=1e-8)
    return found


@pytest.mark.parametrize("name", RIGS)
def test_the_doubling_is_subcritical(name: str) -> None:
    """The motion with two impacts is there, unstable, where that with one is stable; the fold makes it stable."""
    pairs = curve(name)
    assert not orbit_of(name, pairs[0]).stable
    assert orbit_of(name, pairs[-1]).stable
    assert 0 < abs(fold_of(name) / doubling(name).omega - 1) < 4e-3


@pytest.mark.parametrize("name", RIGS)
@pytest.mark.parametrize("step", [0.05, 0.2])
def test_fold_and_birth_are_found_from_the_stable_side(name: str, step: float) -> None:
    """However long a step is beside the way from fold to birth; the branch ends there: it goes on as its mirror."""
    at, start = doubling(name).omega, orbit_of(name, curve(name)[-1])
    side = np.sign(curve(name)[0].omega - at)
    branch = follow(start, "omega", at * (1 + 0.2 * side), behind=at * (1 - 0.2 * side), step=step)
    assert [each.kind for each in branch.boundaries] == [Kind.FOLD, Kind.DOUBLING]
    assert branch.end is BranchEnd.BIRTH
    assert branch.boundaries[0].value == pytest.approx(fold_of(name), rel=1e-9)
    assert branch.boundaries[1].value == pytest.approx(at, rel=1e-13)


@pytest.mark.parametrize("name", RIGS)
def test_a_start_between_birth_and_fold_finds_either(name: str) -> None:
    at, start = doubling(name).omega, orbit_of(name, curve(name)[2])
    side = np.sign(start.drive.omega - at)
    near = follow(start, "omega", at * (1 - 0.1 * side))
    assert near.end is BranchEnd.BIRTH
    assert near.boundaries[-1].value == pytest.approx(at, rel=1e-13)
    away = follow(start, "omega", at * (1 + 0.1 * side))
    assert away.boundaries[0].kind is Kind.FOLD
    assert away.boundaries[0].value == pytest.approx(fold_of(name), rel=1e-9)


def test_a_birth_is_the_shorter_motion() -> None:
    at, pairs = doubling("3e-3"), curve("3e-3")
    birth = follow(orbit_of("3e-3", pairs[2]), "omega", at.omega - 0.1).boundaries[-1]
    assert birth.orbit.periods == 1
    assert birth.orbit.velocities == pytest.approx([at.velocity], rel=1e-12)
    assert np.sort(np.abs(birth.multipliers)) == pytest.approx(np.sort(np.abs(at.multipliers)), rel=1e-9)


def test_a_supercritical_birth_has_no_fold() -> None:
    """The family that a stable doubling gives birth to ends there, and has nothing else on the way."""
    system = ImpactSystem.from_modes([1.0], 0.015, 1.0, 1.0, restitution=0.9)
    at = next(b for b in boundaries(system, 0.2, (2.5, 2.8), points=31) if b.kind is Kind.DOUBLING)
    back = follow(settled(system, Drive(at.omega * 1.002, 0.2), 2, settle=3000), "omega", at.omega * 0.9)
    assert [each.kind for each in back.boundaries] == [Kind.DOUBLING]
    assert back.boundaries[0].value == pytest.approx(at.omega, rel=1e-13)


NOMINAL = ImpactSystem.from_modes([1.0], 0.015, 1.0, 1.0, restitution=0.9)
THREE = ImpactSystem.from_modes(
    [1.0, 5.3, 13.0], 0.02, [1.0, 1.5 / 5.3, -1.1 / 13], [1.0, 1 / 5.3, 1 / 13], gap=0.1, restitution=0.7,
    static=[0.05, 0.0, 0.3],
)  # fmt: skip


@pytest.fixture(scope="module")
def doubled() -> tuple[float, Orbit]:
    """The frequency of a period doubling, and the motion with two impacts that grows out of it."""
    at = next(b for b in boundaries(NOMINAL, 0.2, (2.5, 2.8), points=31) if b.kind is Kind.DOUBLING)
    return at.omega, settled(NOMINAL, Drive(at.omega * 1.002, 0.2), 2, settle=3000)


def test_one_impact_is_the_formula() -> None:
    """Doublings and touches with static forces are those of the quadratic."""
    start = settled(THREE, Drive(1.0, 0.2), settle=600)
    assert len(start.times) == 1
    met = [each for omega in (0.88, 1.04) for each in follow(start, "omega", omega).boundaries]
    exact = boundaries(THREE, 0.2, (0.88, 1.04), points=101)
    assert [each.kind for each in met] == [Kind.TOUCHING, Kind.DOUBLING]
    for each in met:
        near = [b.omega for b in exact if b.kind is each.kind]
        assert np.abs(np.array(near) - each.value).min() < 1e-10, each.kind


def test_a_doubling_of_two_impacts_parts_stable_from_unstable(doubled: tuple[float, Orbit]) -> None:
    omega, orbit = doubled
    branch = follow(orbit, "omega", omega * 1.03)
    first = branch.boundaries[0]
    assert first.kind is Kind.DOUBLING
    assert np.abs(first.multipliers + 1).min() < 1e-9
    before, after = (branch.at(first.value * (1 + share))[0] for share in (-1e-7, 1e-7))
    assert (before.stable, after.stable) == (True, False)


def test_two_impacts_fold_graze_and_touch() -> None:
    start = settled(THREE, Drive(0.8, 0.2), settle=600)
    assert len(start.times) == 2
    wide = follow(start, "gap", 0.16)
    fold, grazing = wide.boundaries
    assert (fold.kind, grazing.kind) == (Kind.FOLD, Kind.GRAZING)
    assert np.abs(fold.multipliers - 1).min() < 1e-5
    assert len(wide.at(fold.value - 1e-4)) == 2
    assert wide.at(fold.value + 1e-5) == ()
    last = wide.orbits[-1].velocities
    assert last.min() < 0.1 * last.max()
    touch = follow(start, "omega", 0.74)
    assert touch.end is BranchEnd.GRAZING
    assert touch.boundaries[-1].kind is Kind.TOUCHING
