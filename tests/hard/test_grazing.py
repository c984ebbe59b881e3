"""Impacts without velocity: from both sides of the graze, at a drive extremum, at double and fourfold roots."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from motions import EPSILON, NONE, assert_lawful, one, state
from mpmath import mpf

import vibeam

SHARES = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 3e-7]  # grazing speed over the scale of speeds: the crest stands out
UNDECIDED = [1e-8, 1e-10, 1e-12, 1e-15, 0.0]  # the crest is within the last digits of its own value


def throw(height: float) -> tuple[vibeam.ImpactSystem, vibeam.State]:
    """A ball thrown up under g = 1 from −½ with velocity 1: u = −½ + t − t²/2, its crest at t = 1 on u = 0."""
    return one(0.0, load=0.0, gap=height, static=-1.0, restitution=0.5), state(-0.5, 1.0)


@pytest.mark.parametrize("share", SHARES)
def test_a_throw_touches(share: float) -> None:
    """The stop share²/2 below the crest: struck at 1 − share with velocity share."""
    system, start = throw(-(share**2) / 2)
    path = vibeam.simulate(system, NONE, 1.5, start)
    blur = 16 * EPSILON / share
    assert len(path.impact_times) == 1
    assert path.impact_times[0] == pytest.approx(1 - share, abs=blur)
    assert path.impact_velocities[0] == pytest.approx(share, abs=blur)
    after = 1.5 - (1 - share)
    assert path.at(1.5) == pytest.approx(-(share**2) / 2 - 0.5 * share * after - after**2 / 2, abs=4 * blur)


@pytest.mark.parametrize("share", SHARES)
def test_a_throw_misses(share: float) -> None:
    system, start = throw(share**2 / 2)
    path = vibeam.simulate(system, NONE, 1.5, start)
    assert len(path.impact_times) == 0
    assert path.at(1.5) == pytest.approx(-0.125, rel=1e-14)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("share", UNDECIDED)
def test_a_throw_that_round_off_decides(share: float, side: int) -> None:
    """Touch or miss, both are lawful: the speed is within what the last digits of the crest make of it."""
    system, start = throw(side * share**2 / 2)
    path = vibeam.simulate(system, NONE, 1.5, start)
    assert_lawful(path)
    faint = np.sqrt(2 * 8 * EPSILON)
    assert len(path.impact_times) <= 1
    assert np.all(path.impact_velocities <= faint)
    assert np.all(np.abs(path.impact_times - 1) <= faint)
    assert path.at(1.5) == pytest.approx(-0.125, abs=2 * faint)


def extremum(part: float) -> tuple[vibeam.ImpactSystem, vibeam.Drive, vibeam.State, float]:
    """Undamped, driven below its frequency: u = A sin Ωt crests where the drive does; the gap is (1 − part) A."""
    w, W, B = 2.0, 0.75, 0.4
    with mpmath.workdps(30):
        A = mpf(W) ** 2 * mpf(B) / (mpf(w) ** 2 - mpf(W) ** 2)
        gap, speed = float(A * (1 - mpf(part))), float(A * mpf(W))
        when = float(mpmath.asin(min(mpf(gap) / A, mpf(1))) / mpf(W))
    return one(w, gap=gap, restitution=0.5), vibeam.Drive(W, B), state(0.0, speed), when


@pytest.mark.parametrize("part", [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12])
def test_a_graze_at_a_drive_extremum(part: float) -> None:
    system, drive, start, when = extremum(part)
    path = vibeam.simulate(system, drive, 3.0, start)
    assert path.impact_times[0] == pytest.approx(when, abs=32 * EPSILON / np.sqrt(2 * part))
    speed = start.velocity[0] * np.sqrt(1 - (1 - part) ** 2)
    assert path.impact_velocities[0] == pytest.approx(speed, rel=1e-9 + 32 * EPSILON / part)
    assert_lawful(path)


@pytest.mark.parametrize("part", [1e-2, 1e-6, 1e-10, 1e-13])
def test_no_graze_at_a_hundred_drive_extremes(part: float) -> None:
    system, drive, start, _ = extremum(-part)
    path = vibeam.simulate(system, drive, 100 * 2 * np.pi / 0.75, start)
    assert len(path.impact_times) == 0


@pytest.mark.parametrize("part", [0.0, 1e-16, -1e-16, 1e-15, -1e-15])
def test_a_double_root_at_a_drive_extremum(part: float) -> None:
    system, drive, start, _ = extremum(part)
    path = vibeam.simulate(system, drive, 5.0, start)
    assert_lawful(path)
    assert np.all(path.impact_velocities <= 1e-7)
    t = np.linspace(0, 5.0, 101)
    np.testing.assert_allclose(path.at(t), start.velocity[0] / 0.75 * np.sin(0.75 * t), atol=2e-7)


def flat(part: float) -> tuple[vibeam.ImpactSystem, vibeam.State, float, float]:
    """u = a₁ cos s + a₂ cos 3s with u'' = 0 on the crest: a root of order four where the gap is u(0)."""
    a1, a2 = mpf(9) / 8, mpf(-1) / 8
    begin = mpf(-1)
    with mpmath.workdps(40):
        crest = a1 + a2
        gap = mpf(float(crest * (1 - mpf(part))))
        x = [float(a * mpmath.cos(w * begin)) for a, w in ((a1, 1), (a2, 3))]
        v = [float(-a * w * mpmath.sin(w * begin)) for a, w in ((a1, 1), (a2, 3))]
        when = speed = 0.0
        if part > 0:
            s = mpmath.findroot(
                lambda s: a1 * mpmath.cos(s) + a2 * mpmath.cos(3 * s) - gap, -((mpf(8) * part / 3) ** 0.25)
            )
            when, speed = float(s - begin), float(-a1 * mpmath.sin(s) - 3 * a2 * mpmath.sin(3 * s))
    system = vibeam.ImpactSystem.from_modes([1.0, 3.0], 0.0, [1.0, 1.0], 0.0, gap=float(gap), restitution=0.5)
    return system, state(x, v), when, speed


@pytest.mark.parametrize("part", [1e-2, 1e-4, 1e-6, 1e-8, 1e-10])
def test_a_flat_crest_touches(part: float) -> None:
    system, start, when, speed = flat(part)
    path = vibeam.simulate(system, NONE, 1.2, start)
    blur = 32 * EPSILON / speed
    assert path.impact_times[0] == pytest.approx(when, abs=blur)
    assert path.impact_velocities[0] == pytest.approx(speed, rel=blur / part**0.25)
    assert_lawful(path)


@pytest.mark.parametrize("part", [1e-2, 1e-6, 1e-10, 1e-13])
def test_a_flat_crest_misses(part: float) -> None:
    system, start, _, _ = flat(-part)
    assert len(vibeam.simulate(system, NONE, 2.0, start).impact_times) == 0


def test_a_fourfold_root() -> None:
    system, start, _, _ = flat(0.0)
    path = vibeam.simulate(system, NONE, 2.0, start)
    assert_lawful(path)
    assert np.all(path.impact_velocities <= 32 * EPSILON**0.75)
    t = np.linspace(0, 2.0, 101)
    np.testing.assert_allclose(path.at(t), 9 / 8 * np.cos(t - 1) - np.cos(3 * (t - 1)) / 8, atol=1e-10)
