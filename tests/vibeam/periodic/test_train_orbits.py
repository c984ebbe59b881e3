"""Motions with several impacts a span: against the equations of impact trains, and differences of flights."""

from __future__ import annotations

import numpy as np
import pytest
from settled_orbits import closed_multipliers, missed, settled, train_of

import vibeam
from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.boundaries import boundaries
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.orbit_search import orbits
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State

NOMINAL = ImpactSystem.from_modes([1.0], 0.015, 1.0, 1.0, restitution=0.9)
THREE = ImpactSystem.from_modes(
    [1.0, 5.3, 13.0], 0.02, [1.0, 1.5 / 5.3, -1.1 / 13], [1.0, 1 / 5.3, 1 / 13], gap=0.1, restitution=0.7,
    static=[0.05, 0.0, 0.3],
)  # fmt: skip
CASES = [(THREE, 1.3, 2), (THREE, 1.0, 1), (THREE, 2.6, 1), (NOMINAL, 2.7, 2), (THREE, 0.8, 1), (THREE, 2.35, 1)]


MANY = [settled(system, Drive(omega, 0.2), periods, settle=600) for system, omega, periods in CASES]


def returned(orbit: Orbit, start: State) -> State:
    return vibeam.simulate(orbit.system, orbit.drive, orbit.time + orbit.span, start, t_start=orbit.time).state


def test_there_is_something_to_judge() -> None:
    assert len(MANY) >= 4
    assert len({len(orbit.times) for orbit in MANY}) >= 2
    assert max(len(orbit.times) for orbit in MANY) >= 2


@pytest.mark.parametrize("orbit", MANY, ids=lambda o: f"{len(o.times)}-in-{o.periods}")
def test_the_impacts_solve_their_equations(orbit: Orbit) -> None:
    """Contact and restitution by the periodic Green's function, which flies nothing; multipliers by the same."""
    m, speed = len(orbit.times), float(orbit.velocities.max())
    bar = 1e-11 * max(1.0, abs(orbit.multipliers[0])) * speed
    np.testing.assert_allclose(
        missed(orbit.system, train_of(orbit)) * np.repeat([orbit.drive.omega, 1], m), 0, atol=bar
    )
    loud = np.abs(orbit.multipliers) > 1e-6 * np.abs(orbit.multipliers[0])
    want = closed_multipliers(orbit)
    np.testing.assert_allclose(np.abs(orbit.multipliers[loud]), np.abs(want[loud]), rtol=1e-9)


@pytest.mark.parametrize("orbit", MANY, ids=lambda o: f"{len(o.times)}-in-{o.periods}")
def test_the_flight_comes_back(orbit: Orbit) -> None:
    end, start = returned(orbit, orbit.state), orbit.state
    size = float(np.linalg.norm(start.velocity)) + orbit.velocities.max()
    bar = 1e-11 * size * max(1.0, abs(orbit.multipliers[0]))
    np.testing.assert_allclose(end.velocity, start.velocity, atol=bar)
    np.testing.assert_allclose(end.displacement, start.displacement, atol=bar)
    path = vibeam.simulate(orbit.system, orbit.drive, orbit.time + 100, orbit.state, t_start=orbit.time)
    m = len(orbit.times)
    np.testing.assert_allclose(path.impact_times[:m], orbit.times, rtol=1e-11)
    np.testing.assert_allclose(path.impact_velocities[m : 2 * m], orbit.velocities, rtol=1e-9)


@pytest.mark.parametrize("orbit", MANY, ids=lambda o: f"{len(o.times)}-in-{o.periods}")
def test_multipliers_against_differences_of_the_flight(orbit: Orbit) -> None:
    start, n, step = orbit.state, orbit.system.size, 1e-7 * orbit.velocities.min()
    columns = []
    for k in range(2 * n):
        shift = step * np.eye(2 * n)[k]
        ends = [
            returned(orbit, State(start.displacement + s * shift[:n], start.velocity + s * shift[n:])) for s in (1, -1)
        ]
        both = [np.concatenate([end.displacement, end.velocity]) for end in ends]
        columns.append((both[0] - both[1]) / (2 * step))
    got = np.linalg.eigvals(np.array(columns).T)
    np.testing.assert_allclose(np.sort(np.abs(got))[-1], abs(orbit.multipliers[0]), rtol=1e-4)
    np.testing.assert_allclose(got.prod().real, orbit.multipliers.prod().real, rtol=1e-2, atol=1e-7)
    assert orbit.stable


def test_two_impacts_in_two_periods_grow_out_of_the_doubling() -> None:
    """Just after the doubling the pair of impacts is near the single one, and stable where that is not."""
    at = next(b for b in boundaries(NOMINAL, 0.2, (2.5, 2.8), points=31) if b.kind is Kind.DOUBLING)
    drive = Drive(at.omega * 1.002, 0.2)
    found = settled(NOMINAL, drive, 2, settle=3000)
    assert len(found.times) == 2
    assert found.stable
    assert not orbits(NOMINAL, drive)[0].stable
    assert abs(found.velocities[0] / found.velocities[1] - 1) > 1e-3
