"""Record of motions: its states against the orbits', one by one, and the flights from them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vibeam import Drive, ImpactSystem, orbits, simulate
from vibeam.periodic.motions import FREE, HARDER, SOFTER, Motions, OrbitKind, closed_motions
from vibeam.system.state import State

THREE = ImpactSystem.from_modes(
    [1.0, 3.1, 9.4], [0.02, 0.9, 1.4], [1.0, 0.5, 0.2], [1.0, 0.4, 0.1], gap=0.05, restitution=0.6,
    outputs={"sensor": [0.8, 0.3, 0.2]}, static=[0.01, 0.0, 0.02],
)  # fmt: skip
OMEGA = np.linspace(0.7, 3.2, 41)


HARD = {OrbitKind.ORBIT, OrbitKind.STRIKES, OrbitKind.UNSTABLE}
SOFT = {OrbitKind.UNSTABLE, OrbitKind.NO_ORBIT}


@pytest.mark.parametrize(("kind", "gap", "kinds"), [(HARDER, 0.05, HARD), (SOFTER, 0.3, SOFT)])
def test_states_and_kinds_are_those_of_the_orbits(kind: int, gap: float, kinds: set[OrbitKind]) -> None:
    """Stability, clearance and extremes come another way there: from all multipliers, and from flights."""
    system, seen = replace(THREE, gap=gap), set()
    found = closed_motions(system, OMEGA, np.full(41, 0.2), "sensor", kind)
    for point, omega in enumerate(OMEGA):
        drive = Drive(omega, 0.2)
        own = next((each for each in orbits(system, drive) if abs(each.phase - found.phases[point, 0]) < 1e-9), None)
        assert (own is not None) == found.admissible[point] == np.isfinite(found.maximum[point])
        seen.add(list(OrbitKind)[found.found[point]])
        if own is not None:
            assert found.velocities[point] == pytest.approx([own.velocity], rel=1e-12)
            assert found.time[point] == pytest.approx(own.time, rel=1e-12)
            size = np.abs(own.state.displacement).max()
            assert found.displacement[point] == pytest.approx(own.state.displacement, abs=1e-13 * size)
            assert found.speed[point] == pytest.approx(own.state.velocity, abs=1e-13 * omega * size + 1e-14)
            assert found.stable[point] == own.stable
            assert found.amplitude[point] == pytest.approx(own.amplitude("sensor"), rel=1e-6)
    assert seen == kinds


def test_a_motion_without_contact_comes_back_to_its_state() -> None:
    free = closed_motions(THREE, np.array([0.3]), np.array([0.1]), "contact", FREE)
    state = State(free.displacement[0], free.speed[0])
    path = simulate(THREE, Drive(0.3, 0.1), 2 * np.pi / 0.3, state=state)
    end = path.modes_at(2 * np.pi / 0.3)
    assert end == pytest.approx(np.stack([free.displacement[0], free.speed[0]]), abs=1e-13)
    assert free.phases.shape == (1, 0)
    assert free.stable[0]


def test_parts_are_joined_again() -> None:
    found = closed_motions(THREE, OMEGA, np.full(41, 0.2), "sensor", HARDER)
    which = np.arange(41)
    assert Motions.joined([found.at(which[:7]), found.at(which[7:])]) == found
    assert found.at(which[:7]) != found.at(which[:8])
