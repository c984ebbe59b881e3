"""From a panel with one root to the root: closed form, repeated until it settles."""

from __future__ import annotations

from math import cos, sin

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.roots.pair import power
from vibeam.flight.kernels.roots.signal import EventSignal, Start, decays_at, quotient_at, value_at
from vibeam_models.arrays import Array

EPSILON = 2.220446049250313e-16
ROUNDS = 80
DEGREE = 7  # of the Taylor polynomial at a guess
RECIPROCAL = np.array([1.0, *(1.0 / j for j in range(1, DEGREE + 2))])


@kernel
def evaluate(g: EventSignal, start: Start, node: float, t: float) -> tuple[float, float, float]:
    """Value, slope and curvature at flight time t of what the panel works on: g (order m = 0) or its quotient g/t^m."""
    if start.order > 0:
        return quotient_at(g, start, t)
    return value_at(g, node, t)


@joined
def guess(signal: Array, h: float, bracket: float) -> float:
    """About the root in (0, bracket) of H, the cubic Hermite interpolant of the last panel: two Newton steps."""
    p0, s0, p1, s1 = signal[layout.P0], h * signal[layout.S0], signal[layout.P1], h * signal[layout.S1]
    a, b = 2.0 * (p0 - p1) + s0 + s1, 3.0 * (p1 - p0) - 2.0 * s0 - s1
    last = bracket / h
    u = min(p0 / (p0 - p1), last) if p1 < 0.0 < p0 else 0.5 * last
    for _ in range(2):
        slope = s0 + u * (2.0 * b + 3.0 * a * u)
        step = (p0 + u * (s0 + u * (b + u * a))) / slope if slope < 0.0 else 0.0
        if 0.0 < u - step < last:
            u -= step
    return u * h


@joined
def expand(pairs: Array, signal: Array, t: float, value: float, slope: float, curvature: float) -> float:
    """terms[TAYLOR + j] = g^{(j)}(t)/j!, j < d = DEGREE + 1, from XT, YT; returns the bound Ω^d |z| + Σ κ_k^d e_k.

    Of |g^{(d)}|; derivatives of a pair by x'' = −2σx' − ω²x.
    """
    w = signal[layout.DRIVE]
    re = signal[layout.ZR] * cos(w * t) - signal[layout.ZI] * sin(w * t)
    im = curvature
    for k in range(pairs.shape[1]):
        if pairs[layout.SLOW, k] > 0.0:
            s, f = decays_at(pairs, k, t)
            im -= pairs[layout.SLOW, k] * pairs[layout.SLOW, k] * s + pairs[layout.TILT, k] * pairs[layout.TILT, k] * f
            continue
        sigma, own = pairs[layout.SIGMA, k], pairs[layout.OMEGA, k]
        im += 2.0 * sigma * pairs[layout.YT, k] + own * own * pairs[layout.XT, k]
    im = -im  # w² times the harmonic's imaginary part
    signal[layout.TAYLOR], signal[layout.TAYLOR + 1], signal[layout.TAYLOR + 2] = value, slope, curvature
    signal[layout.TAYLOR + 3] = -w * w * w * re
    signal[layout.TAYLOR + 4] = w * w * im
    for j in range(5, DEGREE + 1):
        signal[layout.TAYLOR + j] = -w * w * signal[layout.TAYLOR + j - 2]
    rest, factor = signal[layout.HARMONIC] * power(w, DEGREE + 1), 1.0
    for k in range(pairs.shape[1]):
        rest += pairs[layout.E, k] * power(pairs[layout.KAPPA, k], DEGREE + 1)
        if pairs[layout.SLOW, k] > 0.0:
            s, f = decays_at(pairs, k, t)
            rest += pairs[layout.CREEP, k] * power(pairs[layout.SLOW, k], DEGREE + 1)
            for j in range(3, DEGREE + 1):
                signal[layout.TAYLOR + j] += s * power(-pairs[layout.SLOW, k], j) + f * power(pairs[layout.TILT, k], j)
            continue
        damp, spring = 2.0 * pairs[layout.SIGMA, k], pairs[layout.OMEGA, k] * pairs[layout.OMEGA, k]
        before, now = pairs[layout.YT, k], -damp * pairs[layout.YT, k] - spring * pairs[layout.XT, k]
        for j in range(3, DEGREE + 1):
            before, now = now, -damp * now - spring * before
            signal[layout.TAYLOR + j] += now
    for j in range(2, DEGREE + 1):
        factor *= RECIPROCAL[j]
        signal[layout.TAYLOR + j] *= factor
    return float(rest)


@joined
def taylor_root(signal: Array, step: float) -> float:
    """The root near ``step`` of the polynomial Σ terms[TAYLOR + j] Δ^j; infinite where Newton does not settle."""
    for _ in range(3):
        value, slope = signal[layout.TAYLOR + DEGREE], 0.0
        for j in range(DEGREE - 1, -1, -1):
            slope = value + slope * step
            value = signal[layout.TAYLOR + j] + value * step
        change = value / slope
        step -= change
        if abs(change) <= 1e-9 * abs(step):
            return step
    return np.inf


@joined
def shift(pairs: Array, t: float, step: float) -> None:
    """Carry XT, YT on from t by a short step Δ: x ← Σ x^{(j)} Δ^j/j!, j ≤ DEGREE, x'' = −2σx' − ω²x."""
    for k in range(pairs.shape[1]):
        if pairs[layout.SLOW, k] > 0.0:
            s, f = decays_at(pairs, k, t + step)
            pairs[layout.XT, k], pairs[layout.YT, k] = s + f, pairs[layout.TILT, k] * f - pairs[layout.SLOW, k] * s
            continue
        damp, spring = 2.0 * pairs[layout.SIGMA, k], pairs[layout.OMEGA, k] * pairs[layout.OMEGA, k]
        x, y = pairs[layout.XT, k], pairs[layout.YT, k]
        before, now = x, y
        for j in range(1, DEGREE + 1):
            before, now = now * step * RECIPROCAL[j], (-damp * now - spring * before) * step * RECIPROCAL[j]
            x += before
            y += now
        pairs[layout.XT, k], pairs[layout.YT, k] = x, y


@joined
def polish(g: EventSignal, start: Start, node: float, near: float, bracket: float) -> float:
    """The one root in (node, node + bracket], about ``near``; XT, YT and the trial receive the pairs there.

    Newton's method in a bracket; off the stop on the Taylor polynomial about the last iterate (``expand``).
    """
    pairs, signal = g.pairs, g.terms
    low, high = node, node + bracket
    t = min(max(near, low), high)
    for _ in range(ROUNDS):
        value, slope, curvature = evaluate(g, start, node, t)
        if value == 0.0:
            break
        if value > 0.0:
            low = t
        else:
            high = t
        step = -value / slope if slope < 0.0 else np.inf
        if not low < t + step < high:
            step = 0.5 * (low + high) - t
        elif start.order == 0 and signal[layout.ATTACHED] == 0.0:
            rest = expand(pairs, signal, t, value, slope, curvature)
            ahead = taylor_root(signal, step)
            if low < t + ahead < high:
                step = ahead
                if converged(signal, rest, abs(ahead), t):
                    shift(pairs, t, ahead)
                    return t + ahead
        if abs(step) <= EPSILON * t or high - low <= EPSILON * t:
            break
        t += step
    return t


@joined
def converged(signal: Array, rest: float, step: float, t: float) -> bool:
    """True where what the Taylor polynomial leaves out moves the root by less than round-off: rest Δ⁸/8! ≤ ε t |g'|."""
    term = rest * (1.0 / 40320.0)
    for _ in range(DEGREE + 1):
        term *= step
    return term <= 0.5 * EPSILON * t * abs(signal[layout.TAYLOR + 1]) or term == 0.0


@kernel
def polish_minimum(g: EventSignal, start: Start, node: float, h: float) -> tuple[float, float]:
    """(where after the node, value) of the one minimum of a convex panel, or of the first point found ≤ 0.

    The root of the slope between s₀ < 0 and s₁ > 0, by regula falsi with every third step a bisection.
    """
    low, high = 0.0, h
    down, up = g.terms[layout.S0], g.terms[layout.S1]
    if down >= 0.0:
        return h, 1.0
    value, where = 1.0, h
    for i in range(ROUNDS):
        where = low + (high - low) * (0.5 if i % 3 == 2 else min(max(down / (down - up), 1e-3), 0.999))
        value, slope, _ = evaluate(g, start, node, node + where)
        if value <= 0.0 or slope == 0.0 or high - low <= 1e-11 * h:
            break
        if slope < 0.0:
            low, down = where, slope
        else:
            high, up = where, slope
    return where, value
