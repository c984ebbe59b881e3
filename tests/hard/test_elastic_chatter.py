"""R = 1, pressed and damped: impacts without end, algebraically weaker; exact as long as they count, then bounded."""

from __future__ import annotations

from math import cos, cosh, exp, log, pi, sin, sinh, sqrt

import mpmath
import numpy as np
import pytest
from bounded import Bound
from motions import COMPLETE, NONE, one, state

import vibeam

FAINT = sqrt(0.5e-11)  # share of the largest impact velocity at which an accumulation without end is left


def pressed(ratio: float, press: float, restitution: float = 1.0, **rest: object) -> vibeam.ImpactSystem:
    """One mode, ω = 1, pressed on a stop at 0."""
    return one(1.0, ratio, load=1.0, static=press, restitution=restitution, **rest)


@pytest.mark.parametrize("ratio", [3.0, 10.0])
@pytest.mark.parametrize("press", [1.0, 0.2])
def test_impacts_weaken_like_one_over_n_and_come_like_a_logarithm(ratio: float, press: float) -> None:
    """vₙ₊₁ = vₙ − κvₙ² with κ = 4σ/3a: 1/vₘ − 1/vₙ = κ (m − n) to a logarithm, tₘ − tₙ = (2/aκ) ln(m/n)."""
    path = vibeam.simulate(
        pressed(ratio, press), NONE, 1.5 / press + 40.0 / ratio, state(0.0, -1.0), max_impacts=20_000
    )
    v, t, kappa = path.impact_velocities, path.impact_times, 4 * ratio / (3 * press)
    count = len(v)
    assert count > 400
    n = count // 4
    assert (1 / v[-1] - 1 / v[n]) / (count - 1 - n) == pytest.approx(kappa, rel=0.02)
    offset = 1 / (kappa * v[n]) - n
    assert t[-1] - t[n] == pytest.approx(2 / (press * kappa) * log((count - 1 + offset) / (n + offset)), rel=0.02)


def recoil(ratio: float, press: float, speed: float) -> tuple[mpmath.mpf, mpmath.mpf]:
    """Duration of one flight off the stop at ``speed``, and the velocity at its end, to 30 digits."""
    sigma, w = mpmath.mpf(ratio), mpmath.sqrt(mpmath.mpc(1 - ratio**2))
    a, u = mpmath.mpf(press), mpmath.mpf(speed)

    def gap(t: mpmath.mpf) -> mpmath.mpf:
        decay = mpmath.exp(-sigma * t)
        return (decay * (a * mpmath.cos(w * t) + (u + sigma * a) * mpmath.sin(w * t) / w) - a).real

    t = 2 * u / a
    for _ in range(50):
        slope = mpmath.diff(gap, t)
        t, before = t - gap(t) / slope, t
        if abs(t - before) < t * mpmath.mpf(10) ** -25:
            break
    return t, -mpmath.diff(gap, t)


@pytest.mark.parametrize("ratio", [2.0, 30.0])
def test_every_flight_is_the_closed_form(ratio: float) -> None:
    path = vibeam.simulate(pressed(ratio, 0.7), NONE, 2.5 + 10.0 / ratio, state(0.0, -1.0), max_impacts=4000)
    v, t = path.impact_velocities, path.impact_times
    with mpmath.workdps(40):
        for i in [0, 1, 2, 10, len(v) // 2, len(v) - 2]:
            flight, speed = recoil(ratio, 0.7, float(v[i]))
            assert v[i + 1] == pytest.approx(float(speed), rel=1e-11)
            assert t[i + 1] - t[i] == pytest.approx(float(flight), rel=1e-9, abs=1e-14)


@pytest.mark.parametrize(("ratio", "restitution"), [(3.0, 1.0), (5.0, 1 - 1e-9), (20.0, 1.0)])
def test_an_endless_chatter_is_left_at_a_stated_energy(ratio: float, restitution: float) -> None:
    system = pressed(ratio, 0.5, restitution)
    path = vibeam.simulate(system, NONE, 30.0, state(0.0, -1.0), certify=True)
    assert path.ended is COMPLETE
    assert path.state.resting
    assert len(path.chatters) == 1
    assert np.isinf(path.chatters[0, 1])
    v, kappa = path.impact_velocities, 4 * ratio / (3 * 0.5)
    assert v[-1] <= 1.0001 * FAINT * v.max()
    assert v[-2] > FAINT * v.max()
    assert len(v) <= 1.1 * (1 / v[-1]) / kappa + 10
    when, energy, most = path.left_out[0]
    assert when == pytest.approx(path.impact_times[-1], rel=1e-14)
    assert energy == pytest.approx((restitution * v[-1]) ** 2 / 2, rel=1e-14)
    assert most == pytest.approx(energy, rel=1e-9)  # the force that presses is constant
    assert path.certificate is not None
    assert [each.begin for each in path.certificate.unproved] == pytest.approx([when], rel=1e-14)
    assert "without end" in path.certificate.unproved[0].reason


@pytest.mark.parametrize("ratio", [1e2, 1e7])
def test_far_overdamped_an_endless_chatter_is_left_all_the_same(ratio: float) -> None:
    """Flights far below round-off of the displacement: their work is that of any ratio, each loses its κv²."""
    path = vibeam.simulate(pressed(ratio, 0.5), NONE, 30.0, state(0.0, -1.0), max_impacts=1_000_000)
    assert path.ended is COMPLETE
    assert path.state.resting
    v, kappa = path.impact_velocities, 4 * ratio / (3 * 0.5)
    assert v[-1] <= (1 + 1e-9) * FAINT * v.max() <= (1 + 2e-9) * v[-2]
    assert len(v) == pytest.approx(1 / (kappa * v[-1]), rel=1e-3)
    lost = -np.diff(v[1000:]) / (kappa * v[1000:-1] * v[1001:])
    np.testing.assert_allclose(lost, 1.0, atol=2e-3)


class Bouncer:
    """η'' + 2ση' + η = s + Ω²B sin Ωt in closed form, η ≤ 0, R = 1: a program of its own."""

    def __init__(self, sigma: float, press: float, w: float, strength: float) -> None:
        self.sigma, self.press, self.w = sigma, press, w
        self.h = strength / complex(1 - w * w, 2 * sigma * w)
        self.strength = strength

    def steady(self, t: float) -> tuple[float, float]:
        """Steady displacement and velocity."""
        turned = self.h * complex(cos(self.w * t), sin(self.w * t))
        return self.press + turned.imag, self.w * turned.real

    def force(self, t: float) -> float:
        """What holds it on the stop."""
        return self.press + self.strength * sin(self.w * t)

    def flight(self, begun: float, speed: float) -> tuple[float, float]:
        """Time of the next impact and its velocity, off the stop at ``speed`` at ``begun``; by Newton's method."""
        level, rate = self.steady(begun)
        x, y, mu = -level, -speed - rate, sqrt(self.sigma**2 - 1)

        def at(t: float) -> tuple[float, float]:
            decay, c, s = exp(-self.sigma * t), cosh(mu * t), sinh(mu * t) / mu
            place, pace = self.steady(begun + t)
            free = decay * (c * x + s * (y + self.sigma * x))
            return free + place, decay * (c * y - s * (x + self.sigma * y)) + pace

        t = 2 * speed / self.force(begun)
        for _ in range(60):
            place, pace = at(t)
            step = place / pace
            t -= step
            if abs(step) < 1e-13 * t:
                break
        return begun + t, at(t)[1]


def test_the_bound_holds_for_a_driven_motion_that_goes_on_bouncing() -> None:
    """W = ½v² on the stop never exceeds W₀ max f/f₀ until the held motion's release, over hundreds of impacts."""
    bouncer = Bouncer(3.0, 0.5, 1.0, 1.0)
    release = pi + np.arcsin(0.5)
    t, speed = 0.0, 3e-3
    first, count, largest = speed, 0, 0.0
    within = Bound()
    while within(t < release - 0.05):
        t, speed = bouncer.flight(t, speed)
        highest = 1.5 if t > pi / 2 else bouncer.force(t)
        largest = max(largest, speed**2 / (first**2 * highest / 0.5))
        count += 1
    assert count > 100
    assert 0.0 < largest <= 1.0


def test_the_bound_is_that_of_the_force() -> None:
    """Pressed by 0.5 + sin t: f rises to 1.5 and falls to the release, so W ≤ W₀ 1.5/f₀."""
    path = vibeam.simulate(pressed(10.0, 0.5), vibeam.Drive(1.0, 1.0), 3 * 2 * pi, state(-0.2, 0.0))
    assert path.ended is COMPLETE
    assert len(path.left_out) >= 2
    for (when, energy, most), (_, end) in zip(path.left_out, path.rests, strict=True):
        if end == path.t_end:
            continue
        force = 0.5 + sin(when)
        assert most == pytest.approx(energy * (1.5 / force if cos(when) > 0 else 1.0), rel=1e-4)
        assert 0.5 + sin(end) == pytest.approx(0.0, abs=1e-9)
        assert sqrt(2 * most) < 1e-4 * path.impact_velocities.max()


@pytest.mark.parametrize("modes", [1, 3])
@pytest.mark.parametrize("ratio", [0.1, 1.0, 5.0, 1e3, 1e6])
def test_any_number_of_periods_ends_in_bounded_work(modes: int, ratio: float) -> None:
    omega, contact = np.r_[1.0, 2.0 + np.arange(modes - 1)], np.r_[1.0, 0.4 * (-1.0) ** np.arange(1, modes)]
    system = vibeam.ImpactSystem.from_modes(omega, ratio, contact, contact, gap=-0.1, restitution=1.0)
    start = state(np.r_[-1.0, np.zeros(modes - 1)], np.zeros(modes))
    path = vibeam.simulate(system, vibeam.Drive(1.0, 0.5), 4 * 2 * pi, start, max_impacts=1_000_000)
    assert path.ended is COMPLETE
    assert path.at(np.linspace(0, path.t_end, 2001)).max() <= -0.1 + 1e-12
