"""Where motions with several impacts end or lose stability: the flight on both sides, the formula for one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.boundaries import boundaries
from vibeam.periodic.train_boundaries import TrainBoundary, train_boundaries
from vibeam.periodic.train_branch import clearance
from vibeam.periodic.train_orbits import TrainOrbit, settled_orbit, train_orbit
from vibeam.periodic.trains import Train
from vibeam.system.impact_system import Drive, ImpactSystem

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
