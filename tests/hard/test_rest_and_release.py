"""Leaving the stop: on the very instant, at a tangent, and where intervals begin or end just there."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from motions import COMPLETE, EPSILON, assert_lawful, one, state
from mpmath import mpf

import vibeam

W, GAP, DRIVE = 1.5, -0.3, 2.2


def pressed(excess: float) -> tuple[vibeam.ImpactSystem, vibeam.Drive, float]:
    """One mode pressed on by ω²|gap|, pulled by Ω²B = excess ω²|gap|; and the first instant without force."""
    drive = vibeam.Drive(DRIVE, excess * W**2 * abs(GAP) / DRIVE**2)
    system = one(W, 0.02, gap=GAP, restitution=0.7)
    with mpmath.workdps(30):
        share = mpf(W) ** 2 * abs(mpf(GAP)) / (mpf(DRIVE) ** 2 * mpf(drive.amplitude))
        when = (mpmath.pi + mpmath.asin(share)) / mpf(DRIVE) if share <= 1 else 3 * mpmath.pi / 2 / mpf(DRIVE)
    return system, drive, float(when)


REST = state(GAP, 0.0, True)


def assert_the_same(path: vibeam.Trajectory, whole: vibeam.Trajectory) -> None:
    """But for an impact with what round-off has left of a velocity at the start."""
    found = path.impact_times[path.impact_velocities > 1e-14]
    first = np.argmax(whole.impact_velocities < 1e-4) or len(whole.impact_times)
    assert len(found) >= first > 2
    np.testing.assert_allclose(found[:first], whole.impact_times[:first], rtol=1e-10)


@pytest.mark.parametrize("steps", [-1000, -1, 0, 1, 1000])
@pytest.mark.parametrize("excess", [1.01, 1.5, 20.0])
def test_a_restart_about_the_instant_of_release(excess: float, steps: int) -> None:
    """Within some last digits before, on or after it: it leaves, and the motion after is the same."""
    system, drive, when = pressed(excess)
    begin = when + steps * np.spacing(when)
    whole = vibeam.simulate(system, drive, when + 9.0, REST)
    path = vibeam.simulate(system, drive, when + 9.0, REST, t_start=begin)
    first = path.rests[path.rests[:, 0] == begin]
    assert not len(first) or first[0, 1] <= when + 1e-12 / np.sqrt(1 - 1 / excess**2)
    assert path.at(when + 0.05) < GAP
    assert_the_same(path, whole)


@pytest.mark.parametrize("steps", [-1, 0, 1])
def test_an_interval_that_ends_on_the_release(steps: int) -> None:
    system, drive, when = pressed(1.5)
    whole = vibeam.simulate(system, drive, when + 9.0, REST)
    middle = whole.rests[0, 1] + steps * np.spacing(when)
    first = vibeam.simulate(system, drive, middle, REST)
    second = vibeam.simulate(system, drive, when + 9.0, first.state, t_start=middle)
    assert first.ended is second.ended is COMPLETE
    assert len(first.impact_times) == 0
    assert_the_same(second, whole)


@pytest.mark.parametrize("off", [0.0, 1e-16, -1e-16, 1e-14, -1e-14, 1e-12, -1e-12, 1e-10])
def test_a_tangential_release(off: float) -> None:
    """The force just touches zero: whatever round-off decides, the contact hardly leaves.

    With excess 1 + d the pull is positive for √(8d)/Ω: it cannot carry further than its height times that, squared.
    """
    system, drive, when = pressed(1 + off)
    path = vibeam.simulate(system, drive, when + 1.0, REST, max_impacts=100_000)
    assert_lawful(path)
    span = 4 * np.sqrt(8 * (abs(off) + 4 * EPSILON)) / DRIVE
    height = W**2 * abs(GAP) * (abs(off) + 4 * EPSILON)
    far = height * span**2 + 4 * EPSILON
    assert np.abs(path.at(np.linspace(0, when + 1.0, 4001)) - GAP).max() <= far
    if off < -1e-15:
        np.testing.assert_array_equal(path.rests, [[0.0, when + 1.0]])


def test_a_tangential_release_period_after_period() -> None:
    """Twenty touches of zero force: still on the stop, in bounded work."""
    system, drive, _ = pressed(1.0)
    path = vibeam.simulate(system, drive, 20 * 2 * np.pi / DRIVE, REST, max_impacts=100_000)
    assert_lawful(path)
    assert np.abs(path.at(np.linspace(0, path.t_end, 4001)) - GAP).max() <= 1e-14
    assert len(path.impact_times) < 1000


def test_the_force_may_vanish_on_the_start_with_rising_pull_only() -> None:
    """Force zero at t = 0 and pressing ever after: it stays; the same with the load's sign turned: it leaves."""
    for push, stays in ((1.0, True), (-1.0, False)):
        path = vibeam.simulate(one(1.0, load=push, gap=0.0), vibeam.Drive(2.3, 0.1), 1.0, state(0.0, 0.0, True))
        assert (path.at(0.5) == 0.0) == stays
        assert path.state.resting == stays
