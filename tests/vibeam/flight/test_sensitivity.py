"""How errors grow: against neighbours that start a little apart, and against forty digits."""

from __future__ import annotations

import numpy as np
import pytest
from exact_motion import exact_motion

import vibeam
from vibeam.flight.proof.errors import errors_of

CHAOTIC = vibeam.ImpactSystem.from_modes(1.0, 0.01, 1.0, 1.0, gap=0.0, restitution=0.9)
WILD = vibeam.Drive(2.9, 1.0)
BEAM = vibeam.ImpactSystem.from_modes(
    [1.0, 2.6, 7.1], 0.02, [1.0, 0.6, -0.4], [1.0, 0.3, 0.1], gap=0.3, restitution=0.7
)


@pytest.mark.parametrize("system", [CHAOTIC, BEAM], ids=["one mode", "three modes"])
def test_a_neighbour_goes_where_the_matrices_say(system: vibeam.ImpactSystem) -> None:
    """A start off by δ in one direction: first-order errors of times and velocities, impact by impact."""
    n, small = system.size, 1e-9
    start = vibeam.State(np.full(n, -0.1), np.linspace(0.5, 0.2, n))
    direction = np.arange(1.0, 2 * n + 1) / n
    moved = vibeam.State(start.displacement + small * direction[:n], start.velocity + small * direction[n:])
    path, beside = (vibeam.simulate(system, WILD, 30.0, state) for state in (start, moved))
    found = errors_of(path, small**2 * np.outer(direction, direction))
    count = min(len(path.impact_times), len(beside.impact_times), 12)
    assert count >= 8
    for estimate, one, other in (
        (found.time, path.impact_times, beside.impact_times),
        (found.velocity, path.impact_velocities, beside.impact_velocities),
    ):
        apart = np.abs(one - other)[:count]
        np.testing.assert_allclose(estimate[:count], apart, rtol=2e-3, atol=1e-4 * apart.max())


def test_the_estimate_is_of_the_size_of_the_true_error() -> None:
    start = vibeam.State(np.array([-0.1]), np.array([0.5]))
    path = vibeam.simulate(CHAOTIC, WILD, 150.0, start)
    motion = exact_motion(CHAOTIC, WILD, start)
    motion.run(count=40, t_end=150.0)
    hits = np.array([(float(e.time), float(e.speed)) for e in motion.events if e.kind == "impact"])[:40]
    true = np.abs(path.impact_velocities[: len(hits)] - hits[:, 1])
    estimate = path.errors.velocity[: len(hits)]
    assert np.all(true <= 10 * estimate + 1e-15)
    assert np.median(estimate / np.maximum(true, 1e-16)) < 100


def test_digits_that_a_huge_steady_response_swallows_are_counted() -> None:
    """The first impact under a drive of 10⁶, against 30 digits: the motion is small beside what is taken out of it."""
    system = vibeam.ImpactSystem.from_modes(
        [1.0, 3.3, 7.1], [0.05, 0.03, 0.04], [1.0, -0.6, 0.3], [1.0, 0.4, -0.2], gap=0.02, restitution=0.7
    )
    start, drive = vibeam.State(np.array([-0.05, 0.01, 0.0]), np.array([0.02, 0.0, 0.01])), vibeam.Drive(1.9, 1e6)
    path = vibeam.simulate(system, drive, 0.1, start)
    motion = exact_motion(system, drive, start)
    motion.run(count=1, t_end=0.1)
    true = abs(path.impact_times[0] - float(motion.events[0].time))
    assert true < 10 * path.errors.time[0] < 1e4 * true


def test_a_contact_that_begins_on_the_stop_costs_no_meaning() -> None:
    system = vibeam.ImpactSystem.from_modes([47.7, 635.0], 0.017, [2.12, 0.31], [0.46, 0.09], restitution=0.72)
    path = vibeam.simulate(system, vibeam.Drive(95.0, 1e-4), 2.0)
    assert path.rests[0, 0] == 0
    assert path.errors.meaningful == len(path.impact_times)


def test_chaos_says_from_where_on_it_means_nothing_and_a_stable_orbit_never_does() -> None:
    wild = vibeam.simulate(CHAOTIC, WILD, 2000.0, vibeam.State(np.array([-0.1]), np.array([0.5])))
    other = vibeam.simulate(CHAOTIC, WILD, 2000.0, vibeam.State(np.array([-0.1 * (1 + 4e-16)]), np.array([0.5])))
    known = wild.errors.meaningful
    assert 20 < known < len(wild.impact_times)
    apart = np.abs(wild.impact_velocities[:known] - other.impact_velocities[:known])
    assert np.median(apart) < 1e-3  # what is said to be known is known
    far = slice(known + 50, known + 150)
    assert np.abs(wild.impact_velocities[far] - other.impact_velocities[far]).max() > 0.1  # and the rest is not
    calm = vibeam.simulate(CHAOTIC, vibeam.Drive(2.0, 1.0), 2000.0)
    assert calm.errors.meaningful == len(calm.impact_times)
    assert calm.errors.velocity[-1] < 1e-12


@pytest.mark.parametrize(
    ("static", "drive", "expected"),
    [
        (0.5, vibeam.Drive(0.0, 0.0), "SETTLED_ON_STOP"),
        (-0.5, vibeam.Drive(0.0, 0.0), "SETTLED"),
        (0.5, vibeam.Drive(1.5, 0.01), "RESTING"),
        (-0.5, vibeam.Drive(1.5, 0.1), "MOVING"),
    ],
)
def test_outcomes(static: float, drive: vibeam.Drive, expected: str) -> None:
    system = vibeam.ImpactSystem.from_modes([1.0, 2.3], 0.2, [1.0, 0.5], 1.0, gap=0.0, restitution=0.5, static=static)
    path = vibeam.simulate(system, drive, 400.0, vibeam.State(np.array([-1.0, 0.0]), np.zeros(2)))
    assert path.outcome is vibeam.Outcome[expected]
    assert len(path.chatters) >= (1 if static > 0 else 0)


def test_a_start_beyond_the_stop_is_an_outcome() -> None:
    path = vibeam.simulate(CHAOTIC, WILD, 1.0, vibeam.State(np.array([0.1]), np.array([0.0])))
    assert path.outcome is vibeam.Outcome.PENETRATED
    assert "beyond the stop" in path.outcome.value
