"""Up to 10⁹ drive periods from time zero: the phase stays that of the double that the time is."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from agreement import true_motion
from motions import COMPLETE, EPSILON, one, state
from mpmath import mpf
from random_systems import Case

import vibeam

PERIODS = [1e3, 1e6, 1e9]
SYSTEM = vibeam.ImpactSystem.from_modes(
    [1.0, 3.3, 7.1], [0.05, 0.03, 0.04], [1.0, -0.6, 0.3], [1.0, 0.4, -0.2], gap=0.02, restitution=0.7,
    static=[0.005, 0.0, 0.01],
)  # fmt: skip
DRIVE = vibeam.Drive(1.9, 0.05)
START = state([-0.05, 0.01, 0.0], [0.02, 0.0, 0.01])


@pytest.mark.parametrize("periods", PERIODS)
def test_impacts_after_many_periods(periods: float) -> None:
    """Started at that time: times to their last digit, velocities as if it were the first period."""
    begin = periods * 2 * np.pi / DRIVE.omega
    motion = true_motion(Case(SYSTEM, DRIVE, START), begin)
    motion.run(count=12, t_end=begin + 60.0)
    hits = [event for event in motion.events if event.kind == "impact"]
    assert len(hits) == 12
    path = vibeam.simulate(SYSTEM, DRIVE, float(hits[-1].time) + 1e-3, START, t_start=begin)
    np.testing.assert_allclose(path.impact_times[:12], [float(e.time) for e in hits], atol=2e-12, rtol=2 * EPSILON)
    np.testing.assert_allclose(path.impact_velocities[:12], [float(e.speed) for e in hits], rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("periods", PERIODS)
@pytest.mark.parametrize("omega", [1.9, 1e-3, 1e4, 0.1 + 0.2])
def test_the_steady_motion_after_many_periods(periods: float, omega: float) -> None:
    """One flight in steady state begun there: u = Im(A e^{iΩt}) in 40 digits."""
    begin = periods * 2 * np.pi / omega
    with mpmath.workdps(40):
        W, w, z = mpf(omega), mpf(1.3 * omega), mpf(0.05)
        A = W**2 * mpf(0.05) / (w * w - W * W + 2j * z * w * W)
        turn = mpmath.expj(W * mpf(begin))
        x, v = float(mpmath.im(A * turn)), float(mpmath.im(A * turn * 1j * W))
        ends = begin + np.linspace(0.0, 3.0, 7) / omega
        exact = np.array([float(mpmath.im(A * mpmath.expj(W * mpf(t)))) for t in ends])
    system = one(1.3 * omega, 0.05, gap=1.0)
    path = vibeam.simulate(system, vibeam.Drive(omega, 0.05), ends[-1], state(x, v), t_start=begin)
    np.testing.assert_allclose(path.at(ends), exact, rtol=0, atol=64 * EPSILON * float(abs(A)))


@pytest.mark.parametrize("periods", [1e3, 1e5])
def test_one_flight_over_many_periods(periods: float) -> None:
    """No impact on the way: where it ends is where the steady motion is, and no time has leaked."""
    drive = vibeam.Drive(1.9, 0.05)
    with mpmath.workdps(40):
        W = mpf(drive.omega)
        A = W**2 * mpf(0.05) / (1 - W * W + 2j * mpf(0.05) * W)
        end = periods * 2 * np.pi / 1.9 + 0.7
        exact = float(mpmath.im(A * mpmath.expj(W * mpf(end))))
        x, v = float(mpmath.im(A)), float(mpmath.im(A * 1j * W))
    path = vibeam.simulate(one(1.0, 0.05, gap=1.0), drive, end, state(x, v))
    assert path.ended is COMPLETE
    assert path.at(end) == pytest.approx(exact, abs=64 * EPSILON * float(abs(A)))
    assert path.state.displacement[0] == pytest.approx(exact, abs=64 * EPSILON * float(abs(A)))


@pytest.mark.parametrize("periods", [10_000, 200_000])
def test_an_orbit_over_many_periods_keeps_its_phase(periods: int) -> None:
    """A stable motion with one impact a period: the last impact is the first, that many periods later."""
    system = vibeam.ImpactSystem.from_modes(1.0, 0.015, 1.0, 1.0, gap=0.0, restitution=0.7)
    drive = vibeam.Drive(2.0, 0.5e-3)
    orbit = next(each for each in vibeam.orbits(system, drive) if each.stable and each.admissible)
    end = orbit.time + periods * orbit.span + 1.0
    path = vibeam.simulate(system, drive, end, orbit.state, t_start=orbit.time)
    assert len(path.impact_times) == periods
    phases = np.array([float(mpmath.fmod(mpf(2) * mpf(t), 2 * mpmath.pi)) for t in path.impact_times[-5:]])
    np.testing.assert_allclose(phases, orbit.phase % (2 * np.pi), rtol=0, atol=8 * EPSILON * end + 1e-12)
    np.testing.assert_allclose(path.impact_velocities[-1000:], orbit.velocity, rtol=1e-12)
