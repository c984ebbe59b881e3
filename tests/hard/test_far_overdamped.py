"""Modes far beyond critical damping: rates 4ζ² apart; impacts against the closed form in 40 digits, bounded work."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from motions import NONE, one, state
from mpmath import mpf

import vibeam

DIGITS = 40

PANELS = 64  # panels an impact and a drive period, whatever the damping

RATIOS = [1.0, 3.0, 1e2, 1e4, 1e6, 1e8, 1e9]


class Exact:
    """η'' + 2ζωη' + ω²η = s + l Ω²B sin Ωt mode by mode, in closed form from the last impact."""

    def __init__(self, system: vibeam.ImpactSystem, drive: vibeam.Drive, start: vibeam.State) -> None:
        self.system, self.w, self.begun = system, mpf(drive.omega), mpf(0)
        self.strength = self.w**2 * mpf(drive.amplitude)
        self.x = [mpf(float(each)) for each in start.displacement]
        self.y = [mpf(float(each)) for each in start.velocity]

    def mode(self, k: int, t: mpf) -> tuple[mpf, mpf]:
        """Displacement and velocity of mode k at time t."""
        own, since, j = mpf(float(self.system.omega[k])), t - self.begun, mpmath.mpc(0, 1)
        sigma = mpf(float(self.system.zeta[k])) * own
        h = mpf(float(self.system.load[k])) * self.strength / (own**2 - self.w**2 + 2 * j * sigma * self.w)
        rest = mpf(float(self.system.static[k])) / own**2
        began, now = h * mpmath.expj(self.w * self.begun), h * mpmath.expj(self.w * t)
        x, y = self.x[k] - rest - began.imag, self.y[k] - self.w * began.real
        turn = mpmath.sqrt(mpmath.mpc(sigma**2 - own**2))
        if turn == 0:
            decay = mpmath.exp(-sigma * since)
            free, rate = decay * (x + (y + sigma * x) * since), decay * (y - sigma * (y + sigma * x) * since)
        else:
            a, b = sigma - turn, sigma + turn
            s, f = (b * x + y) / (b - a) * mpmath.exp(-a * since), -(a * x + y) / (b - a) * mpmath.exp(-b * since)
            free, rate = (s + f).real, -(a * s + b * f).real
        return free + rest + now.imag, rate + self.w * now.real

    def gap(self, t: mpf) -> tuple[mpf, mpf]:
        """Gap and the contact's velocity toward the stop."""
        modes = [self.mode(k, t) for k in range(self.system.size)]
        row = [mpf(float(c)) for c in self.system.contact]
        moved, speed = (sum(c * mode[i] for c, mode in zip(row, modes, strict=True)) for i in (0, 1))
        return mpf(self.system.gap) - moved, speed

    def root_near(self, t: float) -> mpf:
        """The root by Newton's method."""
        found = mpf(t)
        for _ in range(60):
            gap, speed = self.gap(found)
            found += gap / speed
            if abs(gap / speed) <= mpf(10) ** (8 - DIGITS) * (found - self.begun):
                break
        return found

    def strike(self, t: mpf) -> mpf:
        """Impact at t; the velocity before it."""
        modes = [self.mode(k, t) for k in range(self.system.size)]
        row = [mpf(float(c)) for c in self.system.contact]
        speed = sum(c * y for c, (_, y) in zip(row, modes, strict=True))
        push = (1 + mpf(self.system.restitution)) * speed / sum(c * c for c in row)
        self.x = [x for x, _ in modes]
        self.y = [y - c * push for c, (_, y) in zip(row, modes, strict=True)]
        self.begun = t
        return speed


def follow(path: vibeam.Trajectory, start: vibeam.State, impacts: int, bar: float) -> None:
    """The first ``impacts`` impacts, if it has as many, agree, and no root of the gap lies before any of them."""
    with mpmath.workdps(DIGITS):
        exact = Exact(path.system, path.drive, start)
        for time, speed in list(zip(path.impact_times, path.impact_velocities, strict=True))[:impacts]:
            root = exact.root_near(float(time))
            flown = root - exact.begun
            assert abs(mpf(float(time)) - root) <= mpf(bar) * root
            for share in np.concatenate([np.geomspace(1e-14, 0.5, 120), 1 - np.geomspace(0.5, 1e-6, 60)]):
                assert exact.gap(exact.begun + mpf(float(share)) * flown)[0] > 0
            assert abs(mpf(float(speed)) / exact.strike(root) - 1) <= mpf(bar)


@pytest.mark.parametrize("ratio", RATIOS)
def test_thrown_at_the_stop_and_crept_back(ratio: float) -> None:
    """The fast decay throws it there and back in 1/2ζ, a static force makes it creep there in 2ζ."""
    system, speed = one(1.0, ratio, load=0.0, gap=0.1, restitution=0.6, static=0.3), 2.0 * max(ratio, 1.0)
    start = state(0.0, speed)
    path = vibeam.simulate(system, NONE, 100.0 * ratio, start)
    assert path.ended is vibeam.Ended.COMPLETE
    assert len(path.impact_times) >= 2
    assert path.stats["evaluations"] <= PANELS * (len(path.impact_times) + 1)
    follow(path, start, 2, 1e-12)


@pytest.mark.parametrize(
    "ratio", [ratio if ratio in (1.0, 1e4, 1e9) else pytest.param(ratio, marks=pytest.mark.slow) for ratio in RATIOS]
)
@pytest.mark.parametrize("others", [1, 3])
def test_a_mode_that_swings_beside_others_that_creep(ratio: float, others: int) -> None:
    system = vibeam.ImpactSystem.from_modes(
        np.r_[1.0, np.geomspace(0.7, 30.0, others)], np.r_[0.02, np.full(others, ratio)],
        np.r_[1.0, 0.4 * (-1.0) ** np.arange(others)], np.r_[1.0, 0.5 * np.ones(others)],
        gap=0.2, restitution=0.7,
    )  # fmt: skip
    start = state(np.r_[-0.5, 0.05 * np.ones(others)], np.zeros(1 + others))
    drive, periods = vibeam.Drive(1.3, 0.4), 20
    path = vibeam.simulate(system, drive, periods * 2 * np.pi / 1.3, start)
    assert path.ended is vibeam.Ended.COMPLETE
    assert len(path.impact_times) > 10
    assert path.stats["evaluations"] <= PANELS * (len(path.impact_times) + periods)
    follow(path, start, 4, 1e-10)


@pytest.mark.parametrize("ratio", [1.0, 1e2, 1e4, 1e6, 1e8, 1e9])
def test_a_first_flight_without_an_impact(ratio: float) -> None:
    """It creeps to 1 − 1e-9 of the stop, as slowly as 1/2ζ, and never arrives: proved in bounded work."""
    system = one(1.0, ratio, load=0.0, gap=0.1, restitution=0.6, static=0.1 * (1 - 1e-9))
    path = vibeam.simulate(system, NONE, 60.0 * ratio, state(-1.0, 0.0), certify=True)
    assert path.ended is vibeam.Ended.COMPLETE
    assert len(path.impact_times) == 0
    assert path.stats["evaluations"] <= 10 * PANELS
    assert path.certificate is not None
    assert path.certificate.complete
    with mpmath.workdps(DIGITS):
        exact = Exact(system, NONE, state(-1.0, 0.0))
        for t in np.geomspace(1e-3 / ratio, 10.0 * ratio, 40):
            x, y = exact.mode(0, mpf(float(t)))
            found = path.modes_at(t)
            assert abs(found[0, 0] - float(x)) <= 1e-13
            assert abs(found[1, 0] - float(y)) <= 1e-11 * abs(float(y))
