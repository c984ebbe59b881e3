"""Impacts, releases and accumulations exactly where an interval ends or begins."""

from __future__ import annotations

import numpy as np
import pytest
from motions import COMPLETE, EPSILON, NONE, one, state

import vibeam


def pieces(system: vibeam.ImpactSystem, drive: vibeam.Drive, start: vibeam.State, cuts: list[float]) -> list:
    """The motion in intervals from 0 to each of the cuts."""
    done, t = [], 0.0
    for cut in cuts:
        path = vibeam.simulate(system, drive, cut, start, t_start=t)
        assert path.ended is COMPLETE
        assert path.t_end == cut
        done.append(path)
        start, t = path.state, cut
    return done


@pytest.mark.parametrize("steps", [-100, -2, -1, 0, 1, 2, 100])
@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_an_interval_that_ends_at_an_impact(restitution: float, steps: int) -> None:
    """x = −cos 2t strikes 0 at π/4 with velocity 2: once, in whichever of the intervals."""
    system, start = one(2.0, gap=0.0, restitution=restitution), state(-1.0, 0.0)
    hit = vibeam.simulate(system, NONE, 1.0, start).impact_times[0]
    assert hit == pytest.approx(np.pi / 4, rel=4 * EPSILON)
    first, second = pieces(system, NONE, start, [hit + steps * np.spacing(hit), 2.0])
    times = np.concatenate([first.impact_times, second.impact_times])
    speeds = np.concatenate([first.impact_velocities, second.impact_velocities])
    assert len(times) == 1
    assert times[0] == pytest.approx(np.pi / 4, abs=200 * EPSILON)
    assert speeds[0] == pytest.approx(2.0, rel=1e-12)
    assert second.at(1.5) == pytest.approx(-restitution * np.sin(2 * (1.5 - np.pi / 4)), abs=1e-12)


SYSTEM = vibeam.ImpactSystem.from_modes(
    [1.0, 3.3, 7.1], [0.05, 0.03, 0.04], [1.0, -0.6, 0.3], [1.0, 0.4, -0.2], gap=0.02, restitution=0.7,
    static=[0.005, 0.0, 0.01],
)  # fmt: skip
DRIVE = vibeam.Drive(1.9, 0.05)
START = state([-0.05, 0.01, 0.0], [0.02, 0.0, 0.01])


@pytest.mark.parametrize("steps", [-1, 0, 1])
def test_cut_at_every_impact(steps: int) -> None:
    """Every interval ends at an impact of the whole motion: none is lost, none counted twice."""
    whole = vibeam.simulate(SYSTEM, DRIVE, 40.0, START)
    hits = whole.impact_times[whole.impact_velocities > 1e-3]
    parts = pieces(SYSTEM, DRIVE, START, [*(hits + steps * np.spacing(hits)), 40.0])
    times = np.concatenate([path.impact_times for path in parts])
    speeds = np.concatenate([path.impact_velocities for path in parts])
    assert len(times) == len(whole.impact_times) > 10
    np.testing.assert_allclose(times, whole.impact_times, rtol=1e-11)
    np.testing.assert_allclose(speeds, whole.impact_velocities, rtol=1e-10)


def test_cut_into_a_thousand_pieces() -> None:
    whole = vibeam.simulate(SYSTEM, DRIVE, 40.0, START)
    parts = pieces(SYSTEM, DRIVE, START, np.linspace(0, 40.0, 1001)[1:].tolist())
    times = np.concatenate([path.impact_times for path in parts])
    assert len(times) == len(whole.impact_times)
    np.testing.assert_allclose(times, whole.impact_times, rtol=1e-11)
    np.testing.assert_allclose(parts[-1].state.displacement, whole.state.displacement, atol=1e-12)


@pytest.mark.parametrize("share", [1e-3, 0.1, 0.5, 0.9, 0.99, 0.9999, 1.0, 1.0001])
def test_cut_within_an_accumulation(share: float) -> None:
    """A ball, R = 0.9: the end of all impacts does not know of the cut."""
    system, start = one(0.0, load=0.0, static=9.81, restitution=0.9), state(-1.0, 0.0)
    over = 19 * np.sqrt(2 / 9.81)
    first, second = pieces(system, NONE, start, [share * over, 20.0])
    ends = np.concatenate([first.rests, second.rests])
    assert ends[0, 0] == pytest.approx(over, rel=1e-10)
    assert ends[-1, 1] == 20.0
    assert second.state.resting
    assert len(second.chatters) + len(first.chatters) == 1


@pytest.mark.parametrize("velocity", [1.0, 1e-8, 1e-15, 5e-324])
def test_a_start_on_the_stop_moving_in_strikes_at_once(velocity: float) -> None:
    path = vibeam.simulate(one(2.0, gap=0.3, restitution=0.8), NONE, 0.5, state(0.3, velocity))
    assert path.impact_times[0] == 0.0
    assert path.impact_velocities[0] == velocity
    assert path.at(0.25) <= 0.3


@pytest.mark.parametrize("velocity", [1.0, 1e-8, 1e-15, 5e-324])
def test_a_start_on_the_stop_moving_out_does_not_strike(velocity: float) -> None:
    path = vibeam.simulate(one(2.0, gap=0.3, restitution=0.8), NONE, 0.5, state(0.3, -velocity))
    assert len(path.impact_times) == 0
