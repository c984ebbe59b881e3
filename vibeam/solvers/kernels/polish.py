"""From a panel with one root to the root: closed form, repeated until it settles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.solvers.kernels.jit import kernel
from vibeam.solvers.kernels.layout import (
    ATTACHED,
    CONST,
    DRIVE,
    HARMONIC,
    KAPPA,
    OMEGA,
    P0,
    P1,
    S0,
    S1,
    SIGMA,
    XT,
    YT,
    E,
)
from vibeam.solvers.kernels.signal import quotient_at, value_at

Array = NDArray[np.float64]
EPSILON = 2.220446049250313e-16
ROUNDS = 80


@kernel
def evaluate(
    pairs: Array, signal: Array, attached: Array, order: int, rise: float, node: float, t: float
) -> tuple[float, float, float]:
    """What the panel works on, the signal (order 0) or its quotient: value, slope, curvature at flight time t."""
    if order > 0:
        return quotient_at(pairs, signal, attached, order, rise, t)
    return value_at(pairs, signal, attached, node, t)


@kernel
def guess(signal: Array, h: float, bracket: float) -> float:
    """The root of the cubic Hermite interpolant of the last panel in (0, bracket)."""
    p0, s0, p1, s1 = signal[P0], h * signal[S0], signal[P1], h * signal[S1]
    a, b = 2.0 * (p0 - p1) + s0 + s1, 3.0 * (p1 - p0) - 2.0 * s0 - s1
    low, high = 0.0, bracket / h
    u = low + (high - low) * (p0 / (p0 - p1) if p1 < 0.0 < p0 else 0.5)
    for _ in range(6):
        value = p0 + u * (s0 + u * (b + u * a))
        if value > 0.0:
            low = u
        else:
            high = u
        slope = s0 + u * (2.0 * b + 3.0 * a * u)
        step = u - value / slope if slope < 0.0 else 0.5 * (low + high)
        u = step if low < step < high else 0.5 * (low + high)
    return u * h


@kernel
def shift(pairs: Array, step: float) -> None:
    """Carry XT, YT on by a step so short that the Taylor terms written here reach round-off."""
    for k in range(pairs.shape[1]):
        damp, spring = 2.0 * pairs[SIGMA, k], pairs[OMEGA, k] * pairs[OMEGA, k]
        x, y = pairs[XT, k], pairs[YT, k]
        second = -damp * y - spring * x
        third = -damp * second - spring * y
        pairs[XT, k] = x + step * (y + 0.5 * step * second)
        pairs[YT, k] = y + step * (second + 0.5 * step * third)


@kernel
def shift_limit(pairs: Array, signal: Array) -> float:
    """The cube of the longest step that ``shift`` takes to round-off: M₃Δ³/6, M₄Δ³/6 below that of value and slope."""
    harmonic, w = signal[HARMONIC], signal[DRIVE]
    cube = w * w * w
    size, first = abs(signal[CONST]) + harmonic, harmonic * w
    third, fourth = harmonic * cube, harmonic * cube * w
    for k in range(pairs.shape[1]):
        rate, energy = pairs[KAPPA, k], pairs[E, k]
        cube = energy * rate * rate * rate
        size += energy
        first += energy * rate
        third += cube
        fourth += cube * rate
    value = size / third if third > 0.0 else np.inf
    slope = first / fourth if fourth > 0.0 else np.inf
    return float(6.0 * EPSILON * min(value, slope))


@kernel
def polish(
    pairs: Array, signal: Array, attached: Array, order: int, rise: float, node: float, start: float, bracket: float
) -> float:
    """The one root in (node, node + bracket]; XT, YT and the trial receive the pairs there."""
    low, high = node, node + bracket
    t = min(max(start, low), high)
    limit = shift_limit(pairs, signal) if order == 0 and signal[ATTACHED] == 0.0 else 0.0
    for _ in range(ROUNDS):
        value, slope, curvature = evaluate(pairs, signal, attached, order, rise, node, t)
        if value == 0.0:
            break
        if value > 0.0:
            low = t
        else:
            high = t
        newton = -value / slope if slope < 0.0 else np.inf
        step = newton / (1.0 + 0.5 * newton * curvature / slope) if slope < 0.0 else np.inf
        if not low < t + step < high:
            step = newton if low < t + newton < high else 0.5 * (low + high) - t
        else:
            cube = abs(step * step * step)
            if cube < limit and cube * (curvature / slope) ** 2 <= EPSILON * t:
                shift(pairs, step)
                return t + step
        if abs(step) <= EPSILON * t or high - low <= EPSILON * t:
            break
        t += step
    return t


@kernel
def polish_minimum(
    pairs: Array, signal: Array, attached: Array, order: int, rise: float, node: float, h: float
) -> tuple[float, float]:
    """(where after the node, value) of the one minimum of a convex panel, or of the first point found at or below zero."""
    low, high = 0.0, h
    down, up = signal[S0], signal[S1]
    if down >= 0.0:
        return h, 1.0
    value, where = 1.0, h
    for i in range(ROUNDS):
        where = low + (high - low) * (0.5 if i % 3 == 2 else min(max(down / (down - up), 1e-3), 0.999))
        value, slope, _ = evaluate(pairs, signal, attached, order, rise, node, node + where)
        if value <= 0.0 or slope == 0.0 or high - low <= 1e-11 * h:
            break
        if slope < 0.0:
            low, down = where, slope
        else:
            high, up = where, slope
    return where, value
