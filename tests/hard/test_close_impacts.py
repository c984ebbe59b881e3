"""Two impacts much closer to each other than any mode's period."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from motions import NONE, judged, one, state
from mpmath import mpf

import vibeam


@pytest.mark.parametrize("share", [1e-1, 1e-2, 1e-3, 1e-4, 1e-5])
def test_the_second_impact_of_a_slow_approach(share: float) -> None:
    """Pressed on by a = 1 and struck with share: 2 arctan(Rv/ωa)/ω later it strikes again."""
    w, R = 1.7, 0.8
    path = vibeam.simulate(one(w, gap=-1.0, restitution=R), NONE, 3 * share, state(-1.0, share))
    with mpmath.workdps(30):
        first = float(2 / mpf(w) * mpmath.atan2(mpf(R) * mpf(share), mpf(w)))
        second = first + float(2 / mpf(w) * mpmath.atan2(mpf(R) * mpf(R * share), mpf(w)))
    assert path.impact_times[:3] == pytest.approx([0.0, first, second], rel=1e-11)
    assert path.impact_velocities[:3] == pytest.approx([share, R * share, R * R * share], rel=1e-11)
    assert first < share * 2 * np.pi / w


@pytest.mark.parametrize("press", [1.0, 1e2, 1e4, 1e6])
def test_modes_thrown_at_a_hard_pressed_stop(press: float) -> None:
    """Flights of 1/press: all modes stand still in them but for the press."""
    system = vibeam.ImpactSystem.from_modes(
        [1.0, 3.3, 7.9], 0.02, [1.0, -0.5, 0.3], [1.0, 0.2, 0.1], gap=0.0, restitution=0.9, static=[press, 0.0, 0.0]
    )
    readout = judged(system, vibeam.Drive(1.3, 0.1), state([-1e-3, 0.0, 0.0], [0.5, 0.1, 0.0]), 30)
    assert readout.impacts >= 30


@pytest.mark.parametrize("fast", [1e2, 1e3])
def test_a_ringing_mode_strikes_twice(fast: float) -> None:
    """After the blow the fast mode brings the contact back within a fraction of its own turn."""
    system = vibeam.ImpactSystem.from_modes(
        [1.0, fast], [0.01, 0.002], [1.0, 1.0], [1.0, 0.0], gap=0.1, restitution=0.3
    )
    start = state([0.0, 0.0], [1.0, 0.0])
    path = vibeam.simulate(system, NONE, 1.0, start)
    gaps = np.diff(path.impact_times)
    assert gaps.min() < 0.5 * 2 * np.pi / fast
    judged(system, NONE, start, 12, least=5)
