"""Where motions with several impacts are born, end or lose stability: births by a subcritical doubling, the flight."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
from scipy.optimize import fsolve, minimize_scalar

from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.boundaries import Boundary, boundaries
from vibeam.periodic.train_boundaries import TrainBoundary, train_boundaries
from vibeam.periodic.train_branch import clearance
from vibeam.periodic.train_orbits import TrainOrbit, settled_orbit, train_orbit
from vibeam.periodic.trains import Train, equations
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
        values, _ = equations(system, Drive(omega, AMPLITUDE), span, Train(times, np.array(impulses)))
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
    while (found[-1].omega - doubling(name).omega) * (found[0].omega - doubling(name).omega) > 0:
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


def orbit_of(name: str, pair: Pair) -> TrainOrbit:
    system = RIGS[name][0]
    span = 4 * np.pi / pair.omega
    times = [(pair.phase + pair.apart) / pair.omega, (pair.phase - pair.apart) / pair.omega + span / 2]
    velocities = -np.array(pair.impulses) * float(system.contact @ system.contact) / (1 + system.restitution)
    found = train_orbit(system, Drive(pair.omega, AMPLITUDE), 2, times, velocities)
    assert found is not None
    assert found.admissible
    return found


def folds(found: tuple[TrainBoundary, ...]) -> list[float]:
    return [each.omega for each in found if each.kind is Kind.FOLD]


@pytest.mark.parametrize("name", RIGS)
def test_the_doubling_is_subcritical(name: str) -> None:
    """The motion with two impacts is there, unstable, where that with one is stable; the fold makes it stable."""
    pairs = curve(name)
    assert not orbit_of(name, pairs[0]).stable
    assert orbit_of(name, pairs[-1]).stable
    assert 0 < abs(fold_of(name) / doubling(name).omega - 1) < 4e-3


@pytest.mark.parametrize("name", RIGS)
@pytest.mark.parametrize(("steps", "wide"), [(5, 0.2), pytest.param(50, 0.2, marks=pytest.mark.slow), (50, 0.01)])
def test_both_folds_are_found_from_the_stable_side(name: str, steps: int, wide: float) -> None:
    """However long a step is beside the way from fold to birth; each once, though the branch goes on as its mirror."""
    at, start = doubling(name).omega, orbit_of(name, curve(name)[-1])
    side = np.sign(curve(name)[0].omega - at)
    found = folds(train_boundaries(start, "omega", at * (1 + wide * side), steps=steps))
    assert found == pytest.approx([fold_of(name), at], rel=1e-9)
    assert found[1] == pytest.approx(at, rel=1e-13)


@pytest.mark.parametrize("name", RIGS)
@pytest.mark.parametrize("steps", [5, pytest.param(50, marks=pytest.mark.slow)])
def test_a_start_between_birth_and_fold_finds_either(name: str, steps: int) -> None:
    at, start = doubling(name).omega, orbit_of(name, curve(name)[2])
    side = np.sign(start.drive.omega - at)
    assert folds(train_boundaries(start, "omega", at * (1 - 0.1 * side), steps=steps)) == pytest.approx([at], rel=1e-13)
    away = folds(train_boundaries(start, "omega", at * (1 + 0.1 * side), steps=steps))
    assert away[0] == pytest.approx(fold_of(name), rel=1e-9)


def test_a_birth_is_the_shorter_motion_gone_through_twice() -> None:
    at, pairs = doubling("3e-3"), curve("3e-3")
    birth = train_boundaries(orbit_of("3e-3", pairs[2]), "omega", at.omega - 0.1)[-1]
    assert birth.kind is Kind.FOLD
    assert birth.velocities == pytest.approx([at.velocity] * 2, rel=1e-12)
    assert np.diff(birth.phases) == pytest.approx([2 * np.pi], rel=1e-12)
    squares = np.sort(np.abs(at.multipliers**2))
    assert np.sort(np.abs(birth.multipliers)) == pytest.approx(squares, rel=1e-9)


def test_a_supercritical_birth_is_one_fold() -> None:
    """The family that a stable doubling gives birth to turns there, and nowhere else on the way."""
    system = ImpactSystem.from_modes([1.0], 0.015, 1.0, 1.0, restitution=0.9)
    at = next(b for b in boundaries(system, 0.2, (2.5, 2.8), points=31) if b.kind is Kind.DOUBLING)
    start = settled_orbit(system, Drive(at.omega * 1.002, 0.2), 2, settle=3000)
    assert start is not None
    back = train_boundaries(start, "omega", at.omega * 0.9)
    assert [each.kind for each in back] == [Kind.FOLD]
    assert back[0].omega == pytest.approx(at.omega, rel=1e-13)


NOMINAL = ImpactSystem.from_modes([1.0], 0.015, 1.0, 1.0, restitution=0.9)
THREE = ImpactSystem.from_modes(
    [1.0, 5.3, 13.0], 0.02, [1.0, 1.5 / 5.3, -1.1 / 13], [1.0, 1 / 5.3, 1 / 13], gap=0.1, restitution=0.7,
    static=[0.05, 0.0, 0.3],
)  # fmt: skip


@pytest.fixture(scope="module")
def doubled() -> tuple[float, TrainOrbit]:
    """The frequency of a period doubling, and the motion with two impacts that grows out of it."""
    at = next(b for b in boundaries(NOMINAL, 0.2, (2.5, 2.8), points=31) if b.kind is Kind.DOUBLING)
    found = settled_orbit(NOMINAL, Drive(at.omega * 1.002, 0.2), 2, settle=3000)
    assert found is not None
    return at.omega, found


def test_one_impact_is_the_formula() -> None:
    """Doublings and touches of m = 1 followed by its arc are those of the quadratic."""
    start = settled_orbit(THREE, Drive(1.0, 0.2), 1, settle=600)
    assert start is not None
    assert len(start.times) == 1
    down, up = (train_boundaries(start, "omega", omega, steps=20) for omega in (0.88, 1.04))
    exact = boundaries(THREE, 0.2, (0.88, 1.04), points=101)
    assert [b.kind for b in (*down, *up)] == [Kind.TOUCHING, Kind.DOUBLING]
    for found in (*down, *up):
        near = [b.omega for b in exact if b.kind is found.kind]
        assert np.abs(np.array(near) - found.omega).min() < 1e-10, found.kind


def sides(b: TrainBoundary, parameter: str, system: ImpactSystem, share: float) -> list[TrainOrbit | None]:
    found = []
    for sign in (-1, 1):
        values = {"omega": b.omega, "amplitude": b.amplitude, "gap": b.gap}
        values[parameter] *= 1 + sign * share
        drive = Drive(values["omega"], values["amplitude"])
        one = replace(system, gap=values["gap"])
        periods = 2 if system is NOMINAL else 1
        found.append(train_orbit(one, drive, periods, b.phases / drive.omega, b.velocities))
    return found


def test_a_doubling_of_two_impacts_parts_stable_from_unstable(doubled: tuple[float, TrainOrbit]) -> None:
    omega, orbit = doubled
    first = train_boundaries(orbit, "omega", omega * 1.03)[0]
    assert first.kind is Kind.DOUBLING
    assert np.abs(first.multipliers + 1).min() < 1e-9
    before, after = sides(first, "omega", NOMINAL, 1e-7)
    assert before is not None
    assert after is not None
    assert (before.stable, after.stable) == (True, False)


def test_two_impacts_fold_graze_and_touch() -> None:
    start = settled_orbit(THREE, Drive(0.8, 0.2), 1, settle=600)
    assert start is not None
    assert len(start.times) == 2
    wide = train_boundaries(start, "gap", 0.16)
    assert [b.kind for b in wide] == [Kind.FOLD, Kind.GRAZING]
    fold, grazing = wide
    assert np.abs(fold.multipliers - 1).min() < 1e-5
    below, above = sides(fold, "gap", THREE, 1e-4)
    assert below is not None
    assert above is None
    assert abs(grazing.velocities).min() < 1e-10 * grazing.velocities.max()
    touch = train_boundaries(start, "omega", 0.74, steps=15)[-1]
    assert touch.kind is Kind.TOUCHING
    inside = sorted(bool(side.admissible) for side in sides(touch, "omega", THREE, 1e-8) if side is not None)
    assert inside == [False, True]


def test_the_proof_agrees_with_the_one_by_flight(doubled: tuple[float, TrainOrbit]) -> None:
    for orbit in (doubled[1], settled_orbit(THREE, Drive(0.8, 0.2), 1, settle=600)):
        assert orbit is not None
        span = 2 * np.pi * orbit.periods / orbit.drive.omega
        assert clearance(orbit.system, orbit.drive, span, Train(orbit.times, orbit.impulses)) > 0
        assert orbit.admissible


def test_wrong_questions_are_named(doubled: tuple[float, TrainOrbit]) -> None:
    with pytest.raises(ValueError, match="parameter"):
        train_boundaries(doubled[1], "speed", 1.0)
    with pytest.raises(ValueError, match="through the stop"):
        train_boundaries(replace(doubled[1], admissible=False), "omega", 1.0)
    assert train_boundaries(doubled[1], "gap", 0.0) == ()
