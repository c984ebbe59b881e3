"""R = 0 and R = 1: nothing left, nothing lost, over a million impacts."""

from __future__ import annotations

import numpy as np
import pytest
from motions import EPSILON, NONE, assert_lawful, judged, one, state

import vibeam

MILLION = 1_000_000


@pytest.mark.parametrize("gap", [0.3, -0.3])
def test_a_million_impacts_keep_time_and_speed(gap: float) -> None:
    """ẍ + x = 0 from −1 at rest: t_k = (2k + 1)θ with θ = arccos(−gap), speed sin θ, for ever."""
    path = vibeam.simulate(one(1.0, gap=gap), NONE, 1e8, state(-1.0, 0.0), max_impacts=MILLION)
    assert path.ended is vibeam.Ended.EVENT_LIMIT
    assert len(path.impact_times) == MILLION
    theta = np.arccos(-gap)
    exact = (2 * np.arange(MILLION) + 1) * theta
    np.testing.assert_allclose(path.impact_times, exact, rtol=1e-11)
    np.testing.assert_allclose(path.impact_velocities, np.sin(theta), rtol=1e-10)
    np.testing.assert_allclose(path.at(path.impact_times[-1000:-1]), gap, rtol=0, atol=1e-12 + EPSILON * path.t_end)


def test_a_million_impacts_of_three_modes_keep_the_energy() -> None:
    omega, contact = np.array([1.0, np.sqrt(7.3), np.pi * 1.7]), np.array([1.0, -0.6, 0.4])
    system = vibeam.ImpactSystem.from_modes(omega, 0.0, contact, 0.0, gap=0.3)
    start = state([-1.0, 0.1, 0.05], [0.1, 0.7, -0.2])
    path = vibeam.simulate(system, NONE, 1e8, start, max_impacts=MILLION // 5)
    ends = path.modes_at(path.impact_times[:: MILLION // 100])
    energy = np.sum(ends[:, 1] ** 2 + (omega * ends[:, 0]) ** 2, axis=1) / 2
    first = (start.velocity @ start.velocity + (omega * start.displacement) @ (omega * start.displacement)) / 2
    assert np.abs(energy / first - 1).max() < 4 * EPSILON * MILLION / 5


@pytest.mark.parametrize("modes", [1, 2, 5])
def test_plastic_impacts_of_many_modes(modes: int) -> None:
    """R = 0: the contact stops dead, the rest rings on; driven and pressed, rests begin at once."""
    omega = 1.7 ** np.arange(modes)
    contact = np.r_[1.0, 0.4 * (-1.0) ** np.arange(1, modes)]
    for gap in (0.1, 0.0, -0.1):
        system = vibeam.ImpactSystem.from_modes(omega, 0.02, contact, contact, gap=gap, restitution=0.0)
        start = state(np.r_[-0.5, np.zeros(modes - 1)], np.zeros(modes))
        path = vibeam.simulate(system, vibeam.Drive(1.3, 0.5), 60.0, start)
        assert len(path.impact_times) > 5
        assert_lawful(path)
        readout = judged(system, vibeam.Drive(1.3, 0.5), start, 10, least=0)
        assert readout.releases + readout.impacts > 3


@pytest.mark.parametrize("restitution", [1 - 1e-16, 1 - 1e-12, 1 - 1e-6, 1e-16, 1e-300, 5e-324])
def test_restitution_by_a_last_digit(restitution: float) -> None:
    path = vibeam.simulate(one(1.0, gap=-0.3, restitution=restitution), NONE, 30.0, state(-1.0, 0.0))
    assert_lawful(path)
    limit = vibeam.simulate(one(1.0, gap=-0.3, restitution=float(restitution > 0.5)), NONE, 30.0, state(-1.0, 0.0))
    t = np.linspace(0, 30.0, 301)
    off = min(restitution, 1 - restitution)
    np.testing.assert_allclose(path.at(t), limit.at(t), atol=100 * off + 1e-12)


@pytest.mark.parametrize("restitution", [0.021, 0.3])
@pytest.mark.parametrize("zeta", [0.0, 0.0008289, 0.01])
def test_a_mode_that_bounces_on_its_equilibrium_never_comes_to_rest(zeta: float, restitution: float) -> None:
    """Nothing presses it on: half a turn and the factor R e^{−πσ/ω_d} from one impact to the next, however weak."""
    omega, contact = 178.4, 0.561
    system = vibeam.ImpactSystem.from_modes(omega, zeta, contact, 1.0, gap=0.0, restitution=restitution)
    decay, turn = zeta * omega, omega * np.sqrt(1 - zeta**2)
    first, steps = (np.pi - np.arctan2(turn, decay)) / turn, np.arange(20)
    path = vibeam.simulate(system, NONE, first + 19.5 * np.pi / turn, state(-0.0058, 0.0))
    assert path.ended is vibeam.Ended.COMPLETE
    np.testing.assert_allclose(path.impact_times, first + steps * np.pi / turn, rtol=1e-13)
    speed = contact * 0.0058 * omega**2 / turn * np.exp(-decay * first) * np.sin(turn * first)
    exact = speed * (restitution * np.exp(-decay * np.pi / turn)) ** steps
    np.testing.assert_allclose(path.impact_velocities, exact, rtol=1e-9)
