"""Units, gaps and drives from nearly nothing to huge, and frequencies spread over eight decades."""

from __future__ import annotations

import contextlib
from dataclasses import replace

import numpy as np
import pytest
from motions import COMPLETE, EPSILON, NONE, assert_lawful, judged, one, state

import vibeam
from vibeam_models.laws.compliant import LinearStop

SYSTEM = vibeam.ImpactSystem.from_modes(
    [1.0, 3.3, 7.1], [0.05, 0.03, 0.04], [1.0, -0.6, 0.3], [1.0, 0.4, -0.2], gap=0.02, restitution=0.7,
    static=[0.005, 0.0, 0.01],
)  # fmt: skip
PRESSED = replace(SYSTEM, gap=-0.02, restitution=0.5)
DRIVE = vibeam.Drive(1.9, 0.05)
START = state([-0.05, 0.01, 0.0], [0.02, 0.0, 0.01])


def scaled(
    system: vibeam.ImpactSystem, length: float, time: float, end: float = 30.0
) -> tuple[vibeam.Trajectory, vibeam.Trajectory]:
    """A motion, and the same with all lengths and times multiplied."""
    other = replace(system, omega=system.omega / time, static=system.static * length / time**2, gap=system.gap * length)
    start = vibeam.State(START.displacement * length, START.velocity * length / time)
    drive = vibeam.Drive(DRIVE.omega / time, DRIVE.amplitude * length)
    return vibeam.simulate(system, DRIVE, end, START), vibeam.simulate(other, drive, end * time, start)


@pytest.mark.parametrize("length", [-900, -600, -500, -300, -40, 40, 300, 500, 600, 900])
@pytest.mark.parametrize("system", [SYSTEM, PRESSED], ids=["open", "pressed"])
def test_lengths_of_any_power_of_two_keep_every_bit(system: vibeam.ImpactSystem, length: int) -> None:
    here, there = scaled(system, 2.0**length, 1.0)
    assert there.ended is COMPLETE
    np.testing.assert_array_equal(there.impact_times, here.impact_times)
    np.testing.assert_array_equal(there.impact_velocities, here.impact_velocities * 2.0**length)
    np.testing.assert_array_equal(there.rests, here.rests)
    np.testing.assert_array_equal(there.state.displacement, here.state.displacement * 2.0**length)


@pytest.mark.parametrize("time", [-100, -30, 30, 100])
@pytest.mark.parametrize("system", [SYSTEM, PRESSED], ids=["open", "pressed"])
def test_times_of_any_power_of_two_keep_every_bit(system: vibeam.ImpactSystem, time: int) -> None:
    here, there = scaled(system, 1.0, 2.0**time)
    assert there.ended is COMPLETE
    np.testing.assert_array_equal(there.impact_times, here.impact_times * 2.0**time)
    np.testing.assert_array_equal(there.impact_velocities, here.impact_velocities / 2.0**time)
    np.testing.assert_array_equal(there.rests, here.rests * 2.0**time)


@pytest.mark.parametrize("time", [-300, 300])
def test_times_that_no_bound_can_hold_are_refused(time: int) -> None:
    """Bounds take eighth powers of the rates: beyond 1e±36 1/s the solver says so, and does not hang."""
    with pytest.raises(ValueError, match="take another unit of time"):
        scaled(SYSTEM, 1.0, 2.0**time)


@pytest.mark.parametrize("law", [None, LinearStop(1e4, 1.0)])
@pytest.mark.parametrize("omega", [1e-310, 1e-300, 1e300])
def test_a_frequency_that_no_square_holds_is_flown_or_refused(omega: float, law: LinearStop | None) -> None:
    """No number is made of infinity, and nothing warns of it."""
    system = vibeam.ImpactSystem.from_modes([omega], 0.02, [1.0], [1.0], gap=0.1, law=law)
    for drive in (vibeam.Drive(1.0, 1.0), vibeam.Drive(omega, 1.0)):
        with contextlib.suppress(ValueError):
            vibeam.simulate(system, drive, 60.0)


@pytest.mark.parametrize(("length", "time"), [(1e-9, 1.0), (1e3, 1.0), (1e-9, 1e-6), (1e3, 3600.0), (1e-250, 1e5)])
def test_nanometres_and_kilometres(length: float, time: float) -> None:
    here, there = scaled(SYSTEM, length, time)
    assert len(there.impact_times) == len(here.impact_times) > 8
    np.testing.assert_allclose(there.impact_times / time, here.impact_times, rtol=1e-12)
    np.testing.assert_allclose(there.impact_velocities * time / length, here.impact_velocities, rtol=1e-11)


def test_subnormal_lengths() -> None:
    """A motion of 1e-310 m has ten digits: it strikes when the large one does, to those."""
    here, there = scaled(SYSTEM, 1e-308, 1.0, end=8.0)
    assert there.ended is COMPLETE
    assert len(there.impact_times) == len(here.impact_times)
    np.testing.assert_allclose(there.impact_times, here.impact_times, rtol=1e-6)


@pytest.mark.parametrize("gap", [0.0, 1e-12, -1e-12, 1e-300, -1e-300, 5e-324, -5e-324])
def test_gaps_of_next_to_nothing(gap: float) -> None:
    system = replace(SYSTEM, gap=gap, static=np.zeros(3))
    judged(system, DRIVE, START, 30)


@pytest.mark.parametrize("amplitude", [5e-324, 1e-300, 1e-12])
def test_a_drive_of_next_to_nothing_changes_nothing(amplitude: float) -> None:
    system = replace(SYSTEM, static=np.zeros(3), zeta=np.full(3, 0.005))
    here = vibeam.simulate(system, NONE, 20.0, START)
    there = vibeam.simulate(system, vibeam.Drive(1.9, amplitude), 20.0, START)
    assert len(there.impact_times) == len(here.impact_times) > 4
    np.testing.assert_allclose(there.impact_times, here.impact_times, rtol=1e-12 + 1e3 * amplitude)


def test_a_drive_of_1e12() -> None:
    judged(SYSTEM, vibeam.Drive(1.9, 1e12), START, 30)
    judged(PRESSED, vibeam.Drive(1.9, 1e12), START, 20)


@pytest.mark.parametrize("modes", [2, pytest.param(9, marks=pytest.mark.slow)])
def test_frequencies_over_eight_decades(modes: int) -> None:
    """Fast modes at any place of the row; the truth follows the fastest for as long as it can."""
    omega = np.geomspace(1e-4, 1e4, modes)
    contact = np.ones(modes) / np.arange(1, modes + 1)
    system = vibeam.ImpactSystem.from_modes(omega, 0.01, contact, contact, gap=1e-5, restitution=0.8)
    start = state(np.zeros(modes), 0.5 * contact)
    judged(system, vibeam.Drive(2000.0, 1e-5), start, 2, least=1)


@pytest.mark.parametrize("modes", [3, 9])
def test_frequencies_over_eight_decades_for_long(modes: int) -> None:
    """Thirty thousand turns of the fastest mode, a hair of the slowest's: nothing beyond the stop."""
    omega = np.geomspace(1e-4, 1e4, modes)
    contact = np.ones(modes) / np.arange(1, modes + 1)
    system = vibeam.ImpactSystem.from_modes(omega, 0.01, contact, contact, gap=1e-3, restitution=0.8)
    path = vibeam.simulate(system, vibeam.Drive(20.0, 1e-3), 20.0, state(np.zeros(modes), 0.5 * contact))
    assert len(path.impact_times) > 0
    assert_lawful(path, 20_001)


@pytest.mark.parametrize("omega", [0.0, 5e-324, 1e-300, 1e-160, 1e-12])
def test_next_to_no_stiffness(omega: float) -> None:
    """A ball under g = 1 with a spring that does nothing."""
    path = vibeam.simulate(one(omega, load=0.0, static=1.0, restitution=0.5), NONE, 3.0, state(-0.5, 0.0))
    hits = 1 + 2 * (1 - 0.5 ** np.arange(5))
    np.testing.assert_allclose(path.impact_times[:5], hits, rtol=1e-13)


@pytest.mark.parametrize("ratio", [1e-8, 1e-6, 1e6, 1e8])
def test_a_drive_millions_of_times_slower_or_faster_than_the_mode(ratio: float) -> None:
    """Its steady response in closed form: F/(1 − W²), started on it; no damping, the stop far away."""
    force = 0.3
    drive = vibeam.Drive(ratio, force / ratio**2)
    B = force / (1 - ratio**2)
    path = vibeam.simulate(one(1.0, gap=10.0), drive, 3.0, state(0.0, B * ratio))
    t = np.array([0.1, 1.0, 2.0, 3.0])
    np.testing.assert_allclose(
        path.at(t), B * np.sin(ratio * t), atol=64 * EPSILON * abs(B) * max(1.0, 3 * ratio) + 1e-300
    )
