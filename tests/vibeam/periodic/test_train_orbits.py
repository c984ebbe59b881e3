"""Motions with several impacts a span: against the formula for one, and the flight solver for more."""

from __future__ import annotations

import numpy as np
import pytest

import vibeam
from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.boundaries import boundaries
from vibeam.periodic.orbit_search import orbits
from vibeam.periodic.train_orbits import TrainOrbit, settled_orbit, train_orbit
from vibeam.periodic.trains import carried
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State

NOMINAL = ImpactSystem.from_modes([1.0], 0.015, 1.0, 1.0, restitution=0.9)
THREE = ImpactSystem.from_modes(
    [1.0, 5.3, 13.0], 0.02, [1.0, 1.5 / 5.3, -1.1 / 13], [1.0, 1 / 5.3, 1 / 13], gap=0.1, restitution=0.7,
    static=[0.05, 0.0, 0.3],
)  # fmt: skip
CASES = [(THREE, 1.3, 1), (THREE, 1.0, 1), (THREE, 2.6, 2), (NOMINAL, 2.7, 2), (THREE, 0.8, 1), (THREE, 2.35, 2)]


def settled() -> list[TrainOrbit]:
    found = [settled_orbit(s, Drive(w, 0.2), n, settle=600) for s, w, n in CASES]
    return [orbit for orbit in found if orbit is not None]


MANY = settled()


def returned(orbit: TrainOrbit, start: State, begin: float) -> State:
    end = begin + 2 * np.pi * orbit.periods / orbit.drive.omega
    return vibeam.simulate(orbit.system, orbit.drive, end, start, t_start=begin).state


def middle(orbit: TrainOrbit) -> tuple[State, float]:
    """Between the first impact and the one after it."""
    span = 2 * np.pi * orbit.periods / orbit.drive.omega
    after = (np.append(orbit.times, orbit.times[0] + span)[:2]).mean()
    x, y = carried(orbit.system, orbit.drive, orbit.state, float(orbit.times[0]), np.array([after]))
    return State(x[0], y[0]), float(after)


def test_there_is_something_to_judge() -> None:
    assert len(MANY) >= 4
    assert len({len(orbit.times) for orbit in MANY}) >= 2
    assert max(len(orbit.times) for orbit in MANY) >= 2


@pytest.mark.parametrize("orbit", MANY, ids=lambda o: f"{len(o.times)}-in-{o.periods}")
def test_the_flight_comes_back(orbit: TrainOrbit) -> None:
    assert orbit.admissible
    start, begin = middle(orbit)
    end = returned(orbit, start, begin)
    size = float(np.linalg.norm(start.velocity)) + orbit.velocities.max()
    bar = 1e-11 * size * max(1.0, abs(orbit.multipliers[0]))
    np.testing.assert_allclose(end.velocity, start.velocity, atol=bar)
    np.testing.assert_allclose(end.displacement, start.displacement, atol=bar)
    path = vibeam.simulate(orbit.system, orbit.drive, orbit.times[0] + 100, orbit.state, t_start=orbit.times[0])
    m = len(orbit.times)
    np.testing.assert_allclose(path.impact_times[: m - 1], orbit.times[1:], rtol=1e-11)
    np.testing.assert_allclose(path.impact_velocities[:m], np.roll(orbit.velocities, -1), rtol=1e-9)


@pytest.mark.parametrize("orbit", MANY, ids=lambda o: f"{len(o.times)}-in-{o.periods}")
def test_multipliers_against_differences_of_the_flight(orbit: TrainOrbit) -> None:
    start, begin = middle(orbit)
    n, step = orbit.system.size, 1e-7 * orbit.velocities.min()
    columns = []
    for k in range(2 * n):
        shift = step * np.eye(2 * n)[k]
        ends = [
            returned(orbit, State(start.displacement + s * shift[:n], start.velocity + s * shift[n:]), begin)
            for s in (1, -1)
        ]
        both = [np.concatenate([end.displacement, end.velocity]) for end in ends]
        columns.append((both[0] - both[1]) / (2 * step))
    got = np.linalg.eigvals(np.array(columns).T)
    np.testing.assert_allclose(np.sort(np.abs(got))[-1], abs(orbit.multipliers[0]), rtol=1e-4)
    np.testing.assert_allclose(got.prod().real, orbit.multipliers.prod().real, rtol=1e-2, atol=1e-7)
    assert orbit.stable


def test_one_impact_is_the_formula() -> None:
    drive = Drive(2.0, 0.2)
    (exact, *_) = orbits(THREE, drive)
    found = train_orbit(THREE, drive, 1, [exact.time * 1.01], [exact.velocity * 0.97])
    assert found is not None
    assert found.times[0] == pytest.approx(exact.time, rel=1e-12)
    assert found.impulses[0] == pytest.approx(exact.impulse, rel=1e-12)
    np.testing.assert_allclose(np.abs(found.multipliers), np.abs(exact.multipliers), rtol=1e-9)
    np.testing.assert_allclose(found.state.velocity, exact.state.velocity, rtol=1e-10, atol=1e-14)


def test_two_impacts_in_two_periods_grow_out_of_the_doubling() -> None:
    """Just after the doubling the pair of impacts is near the single one, and stable where that is not."""
    at = next(b for b in boundaries(NOMINAL, 0.2, (2.5, 2.8), points=31) if b.kind is Kind.DOUBLING)
    drive = Drive(at.omega * 1.002, 0.2)
    found = settled_orbit(NOMINAL, drive, 2, settle=3000)
    assert found is not None
    assert len(found.times) == 2
    assert found.stable
    assert not orbits(NOMINAL, drive)[0].stable
    assert abs(found.velocities[0] / found.velocities[1] - 1) > 1e-3


def test_wrong_questions_are_named() -> None:
    with pytest.raises(ValueError, match="1 to 4"):
        train_orbit(NOMINAL, Drive(2.0, 0.1), 1, np.arange(5.0), np.ones(5))
    with pytest.raises(ValueError, match="stiffness"):
        train_orbit(ImpactSystem.from_modes([0.0], 0.0, 1.0, 1.0, static=1.0), Drive(2.0, 0.1), 1, 1.0, 1.0)
    assert settled_orbit(ImpactSystem.from_modes([1.0], 0.1, 1.0, 1.0, gap=9.0), Drive(2.0, 0.1)) is None
