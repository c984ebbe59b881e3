"""Flights among several contacts against ``several``, in 30 digits."""

from __future__ import annotations

from typing import Any

import mpmath as mp
import numpy as np
import pytest
from several import ContactRig

import vibeam
from vibeam_models.laws.compliant import LinearStop

SPRINGS = {
    "rigid": (None, None),
    "linear beside rigid": (LinearStop(2e5), None),
    "damped": (LinearStop(1e5, 8.0), None),
}


def rig(seed: int, laws: tuple[Any, ...]) -> tuple[vibeam.ImpactSystem, vibeam.Drive]:
    """Two to four modes and two or three contacts, R from 0.6 to 0.9."""
    rng = np.random.default_rng(seed)
    n, k = int(rng.integers(2, 5)), int(rng.integers(2, 4))
    rows, gaps, coefficients = rng.uniform(-1, 1, (k, n)), rng.uniform(0.5e-4, 3e-4, k), rng.uniform(0.6, 0.9, k)
    laws = (*laws, None)[:k]
    further = [vibeam.Contact(rows[j], gaps[j], coefficients[j], laws[j]) for j in range(1, k)]
    system = vibeam.ImpactSystem.from_modes(
        np.sort(rng.uniform(30, 300, n)), 0.02, rows[0], rng.uniform(0.3, 1, n), gap=gaps[0],
        restitution=coefficients[0], law=laws[0], further=further,
    )  # fmt: skip
    return system, vibeam.Drive(float(rng.uniform(30, 120)), 3e-4)


@pytest.mark.parametrize("laws", SPRINGS.values(), ids=SPRINGS)
@pytest.mark.parametrize("seed", [0, 1, 3, 5])
def test_impacts_are_those_of_thirty_digits(seed: int, laws: tuple[Any, ...]) -> None:
    """Times to 1e-12 s, velocities to 1e-10 of the hardest: what round-off of doubles becomes over these impacts."""
    system, drive = rig(seed, laws)
    still = vibeam.State(np.zeros(system.size), np.zeros(system.size))
    path = vibeam.simulate(system, drive, 0.12, still)
    assert not len(path.holds()), "a seed that rests"
    with mp.workdps(30):
        hits, last = ContactRig(system, drive).fly(0.12)
    assert len(hits) > 1
    assert path.impact_contacts.tolist() == [contact for _, contact, _ in hits]
    assert path.impact_times == pytest.approx([float(time) for time, _, _ in hits], rel=0, abs=1e-12)
    speeds = np.array([float(speed) for _, _, speed in hits])
    assert path.impact_velocities == pytest.approx(speeds, rel=0, abs=1e-10 * speeds.max())
    state = np.array([float(x) for x in last])
    assert path.state.displacement == pytest.approx(state[: system.size], rel=0, abs=1e-11 * np.abs(state).max())


def test_two_stops_at_one_place_in_thirty_digits() -> None:
    """Two contacts struck in one instant: one is met, the other stands at its stop; impulses in turn."""
    rows = [[0.8, -0.3, 0.2], [0.8, -0.3, 0.2], [-0.5, 0.6, 0.4]]
    system = vibeam.ImpactSystem.from_modes(
        [60.0, 140.0, 250.0], 0.01, rows[0], [1.0, 0.5, 0.3], gap=1e-4, restitution=0.7,
        further=[vibeam.Contact(rows[1], 1e-4, 0.9), vibeam.Contact(rows[2], 2e-4, 0.8)],
    )  # fmt: skip
    drive = vibeam.Drive(75.0, 3e-4)
    path = vibeam.simulate(system, drive, 0.1, vibeam.State(np.zeros(3), np.zeros(3)))
    with mp.workdps(30):
        hits, _ = ContactRig(system, drive).fly(0.1)
    assert path.impact_contacts.tolist() == [contact for _, contact, _ in hits]
    assert path.impact_times == pytest.approx([float(time) for time, _, _ in hits], rel=0, abs=1e-12)
