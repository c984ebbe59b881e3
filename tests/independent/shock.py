"""First impact of one mode under a half-sine and a saw-tooth, in closed form.

    x'' + 2ζωx' + ω²x = a(t),  x(0) = x'(0) = 0,  a stop at x = gap > 0

While the pulse lasts x is a particular solution and e^{−ζωt} turns; after it, those turns alone. Without damping
(Harris & Crede, Shock and Vibration Handbook, ch. 8): under the half-sine A sin πt/τ, with β = π/ωτ,

    x = A (sin πt/τ − β sin ωt) / ω²(1−β²),  after it  x = A 2β cos(ωτ/2) sin ω(t − τ/2) / ω²(β²−1)

so that a stop which the pulse does not reach is met at t = τ/2 + arcsin(…)/ω; under the saw-tooth A t/τ it is met at
the root of Kepler's equation for e = 1, E − sin E = gap ω³τ/A, E = ωt, for x' = A (1 − cos ωt)/ω²τ is never negative.
"""

from __future__ import annotations

from itertools import pairwise

import mpmath
from mpmath import mp, mpf


def half_sine(omega: mpf, zeta: mpf, peak: mpf, duration: mpf, t: mpf) -> mpf:
    """x(t) under a half-sine: the response to A sin Ωt for all t, and to the same again from τ on."""
    found = _after_sine(omega, zeta, peak, mp.pi / duration, t)
    return found + (_after_sine(omega, zeta, peak, mp.pi / duration, t - duration) if t > duration else 0)


def saw_tooth(omega: mpf, zeta: mpf, peak: mpf, duration: mpf, t: mpf) -> mpf:
    """x(t) under a terminal-peak saw-tooth: the response to a ramp, less a ramp and a step from τ on."""
    slope = peak / duration
    found = slope * _after_ramp(omega, zeta, t)
    if t > duration:
        found -= slope * _after_ramp(omega, zeta, t - duration) + peak * _after_step(omega, zeta, t - duration)
    return found


def first_impact(response, gap: mpf, end: mpf, steps: int = 2000) -> mpf:
    """First t with response(t) = gap: bracketed on a grid far finer than any turn, then all digits."""
    near = mpf(10) ** (8 - 2 * mp.dps)
    times = [end * k / steps for k in range(steps + 1)]
    for low, high in pairwise(times):
        if response(high) > gap:
            return mpmath.findroot(lambda t: response(t) - gap, (low, high), solver="anderson", tol=near)
    raise ValueError("the stop is not reached")


def first_impact_half_sine(omega: mpf, peak: mpf, duration: mpf, gap: mpf) -> mpf:
    """Without damping, of a stop that the pulse itself does not reach."""
    beta = mp.pi / (omega * duration)
    size = peak * 2 * beta * mpmath.cos(omega * duration / 2) / (omega**2 * (beta**2 - 1))
    turn = mpmath.asin(abs(gap / size))
    phase = turn if size > 0 else mp.pi + turn
    after = duration / 2 + phase / omega
    while after < duration:
        after += 2 * mp.pi / omega
    return after


def first_impact_saw_tooth(omega: mpf, peak: mpf, duration: mpf, gap: mpf) -> mpf:
    """Without damping, while the pulse lasts."""
    share = gap * omega**3 * duration / peak
    return mpmath.findroot(lambda turn: turn - mpmath.sin(turn) - share, mpmath.cbrt(6 * share)) / omega


def _turn(omega: mpf, zeta: mpf, x: mpf, v: mpf, t: mpf) -> mpf:
    """Free decay from (x, v)."""
    damped = omega * mpmath.sqrt(1 - zeta**2)
    sine = (v + zeta * omega * x) / damped
    return mpmath.exp(-zeta * omega * t) * (x * mpmath.cos(damped * t) + sine * mpmath.sin(damped * t))


def _after_sine(omega: mpf, zeta: mpf, peak: mpf, rate: mpf, t: mpf) -> mpf:
    phasor = peak / mpmath.mpc(omega**2 - rate**2, 2 * zeta * omega * rate)
    steady = mpmath.im(phasor * mpmath.expj(rate * t))
    return steady - _turn(omega, zeta, mpmath.im(phasor), rate * mpmath.re(phasor), t)


def _after_step(omega: mpf, zeta: mpf, t: mpf) -> mpf:
    return (1 - _turn(omega, zeta, mpf(1), mpf(0), t)) / omega**2


def _after_ramp(omega: mpf, zeta: mpf, t: mpf) -> mpf:
    late = 2 * zeta / omega
    return (t - late - _turn(omega, zeta, -late, mpf(1), t)) / omega**2
