"""The flight solver against scipy's DOP853 with events, over 150 impacts, by name 500 of stable periodic motions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import vibeam
from vibeam.runs.sweep import march

IMPACTS = [150, pytest.param(500, marks=pytest.mark.slow)]
BAR = 1e-8
NOMINAL = (vibeam.ImpactSystem.from_modes(1.0, 0.015, 1.0, 1.0, gap=0.0, restitution=0.9), vibeam.Drive(2.0, 0.5e-3))
DEMO = (vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, gap=1.0, restitution=0.8), vibeam.Drive(1.0, 1.0))
TWO = (
    vibeam.ImpactSystem.from_modes([1.0, 3.3], [0.03, 0.05], [1.0, 0.6], [1.0, 0.3], gap=0.02, restitution=0.7),
    vibeam.Drive(1.9, 0.02),
)
FOUR = (
    vibeam.ImpactSystem.from_modes(
        [1.0, 2.7, 5.1, 8.3], [0.02, 0.054, 0.102, 0.166], [1.0, -0.5, 0.3, -0.2], [1.0, 0.4, 0.2, 0.1],
        gap=0.01, restitution=0.6, static=[0.002, 0.0, 0.0, 0.0],
    ),
    vibeam.Drive(2.1, 0.02),
)  # fmt: skip
CASES = {"nominal": NOMINAL, "demo": DEMO, "two modes": TWO, "four modes": FOUR}


def peer_impacts(
    system: vibeam.ImpactSystem, drive: vibeam.Drive, state: vibeam.State, count: int
) -> Iterator[tuple[float, float]]:
    """Times and velocities of the first ``count`` impacts.

    After an impact the event is g/(t − t₀), which starts at the rebound velocity instead of at a root: nothing is
    triggered twice and no flight, however short, is passed over.
    """
    n, c = system.size, system.contact
    damping, stiffness = 2 * system.zeta * system.omega, system.omega**2
    push = system.load * drive.omega**2 * drive.amplitude

    def slope(t: float, y: np.ndarray) -> np.ndarray:
        force = push * np.sin(drive.omega * t) + system.static
        return np.concatenate([y[n:], force - damping * y[n:] - stiffness * y[:n]])

    def gap_left(t: float, y: np.ndarray) -> float:
        if not struck:
            return float(system.gap - c @ y[:n])
        return float((system.gap - c @ y[:n]) / (t - begun)) if t > begun else float(-(c @ y[n:]))

    gap_left.terminal, gap_left.direction = True, -1.0  # type: ignore[attr-defined]
    begun, y, struck = 0.0, np.concatenate([state.displacement, state.velocity]), False
    scale = 1e-12 * np.abs(y).max()
    longest = 2 * np.pi / drive.omega / 25
    for _ in range(count):
        found = solve_ivp(
            slope, (begun, begun + 200 * longest), y, method="DOP853", events=gap_left, rtol=1e-12, atol=scale,
            max_step=longest,
        )  # fmt: skip
        begun, y, struck = float(found.t_events[0][0]), np.array(found.y_events[0][0]), True
        speed = float(c @ y[n:])
        yield begun, speed
        y[n:] -= c * (1 + system.restitution) * speed / (c @ c)
        y[:n] -= c * (c @ y[:n] - system.gap) / (c @ c)


def near_the_orbit(system: vibeam.ImpactSystem, drive: vibeam.Drive) -> vibeam.State:
    """A state a little off the periodic motion."""
    ((response, state),) = march(system, drive.omega, drive.amplitude, settle=400, hold=8)
    assert response.period[0] == 1
    assert not state.resting
    return replace(state, displacement=state.displacement - 0.02 * np.abs(state.displacement))


def assert_the_same(path: vibeam.Trajectory, expected: np.ndarray) -> None:
    times, speeds = expected.T
    assert len(path.impact_times) == len(times)
    np.testing.assert_allclose(path.impact_times, times, rtol=BAR, atol=BAR)
    np.testing.assert_allclose(path.impact_velocities, speeds, rtol=BAR, atol=BAR * speeds.max())


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow) if name == "four modes" else name for name in CASES]
)
@pytest.mark.parametrize("impacts", IMPACTS)
def test_impacts_one_by_one(name: str, impacts: int) -> None:
    system, drive = CASES[name]
    start = near_the_orbit(system, drive)
    expected = np.array(list(peer_impacts(system, drive, start, impacts)))
    assert_the_same(vibeam.simulate(system, drive, expected[-1, 0] + 1e-3, start), expected)
    wrong = replace(system, restitution=system.restitution + 1e-6)
    with pytest.raises(AssertionError):
        assert_the_same(vibeam.simulate(wrong, drive, expected[-1, 0] + 1e-3, start), expected)
