"""The extremes of a signal over a span: panels whose hull cannot reach beyond what is known are passed over."""

from __future__ import annotations

from math import hypot, sqrt

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.roots import taylor_pairs as att
from vibeam.flight.kernels.roots.bounds import Ends
from vibeam.flight.kernels.roots.pair import norm
from vibeam.flight.kernels.roots.panels import Node, accept, measure, next_node
from vibeam.flight.kernels.roots.signal import Signal, to_node, value_at

Array = NDArray[np.float64]

ACCURACY = 1e-11  # share of the size of the signal's parts

LIGHTLY = 1e-6  # and where not everything is read off

FINE = 1e-2  # share of that which Newton's last step may be off

ROUNDS = 60

MOST_WORK = 1_000_000_000  # panels, times modes and a few, then a span is given up: a mode rings too fast beside it

GLANCE = 1024  # panels after which it is asked whether what is left can reach beyond what is known at all

EPSILON = 2.220446049250313e-16


@kernel
def extremes(g: Signal, span: float, coarsest: int, least: float, most: float) -> tuple[float, float]:
    """(least, most) widened to the signal's values over [0, span]."""
    return extremes_to(g, span, coarsest, least, most, ACCURACY)


@kernel
def extremes_to(g: Signal, span: float, coarsest: int, least: float, most: float, share: float) -> tuple[float, float]:
    """(least, most) widened to the signal's values over [0, span], to a ``share`` of the size of its parts.

    A panel whose hull, widened by M₄h⁴/384 + slack (``roots.bounds``), stays within what is known is passed over; where
    g is proved convex or concave its turning point is found by Newton's method. (−∞, ∞) where that takes more than
    ``MOST_WORK``.
    """
    pairs, _, levels, signal, attached = g
    total = to_node(pairs)
    att.restart(attached, signal)
    re, im = signal[layout.ZR], signal[layout.ZI]
    signal[layout.HARMONIC] = norm(re, im)
    accuracy = share * (abs(signal[layout.CONST]) + signal[layout.HARMONIC] + total + att.swing(attached, signal, span))
    node, level, panels = Node(0.0, re, im), coarsest, 0
    while panels < MOST_WORK // (pairs.shape[1] + 8):
        panels += 1
        h, time = levels[layout.STEP, level], node.time
        part, bounds, rest = measure(g, node, level)
        if time == 0.0:
            least, most = min(least, part.p0 + rest.p0), max(most, part.p0 + rest.p0)
        if time >= span:
            return least, most
        error = bounds.fourth * h * h * h * h / 384.0 + bounds.value
        low, high = hull(part, h)
        if low - error < least or high + error > most:
            last = min(span - time, h)
            if error > accuracy and level < layout.LEVELS - 1:
                bend = bent(part, h, bounds.fourth * h * h / 12.0 + bounds.curvature)
                if bend == 0.0:
                    level += 1
                    continue
                low, high = turning(g, time, part.s0 + rest.s0, last, bend, accuracy)
            else:
                low, high = cubic_range(together(part, rest), h, last)
            least, most = min(least, low), max(most, high)
        if signal[layout.ATTACHED] > 0.0:
            att.carry(attached, signal, time, h)
        accept(g)
        node = next_node(levels, level, node)
        level = max(level - 1, coarsest)
        if panels % GLANCE == 0 and contained(pairs, signal, least - accuracy, most + accuracy):
            return least, most
    return -np.inf, np.inf


@kernel
def contained(pairs: Array, signal: Array, least: float, most: float) -> bool:
    """Whether const ± (|z| + Σ e_k + |s_k|), and with it the signal from the node on, stays within [least, most]."""
    reach = hypot(signal[layout.ZR], signal[layout.ZI])
    for k in range(pairs.shape[1]):
        reach += pairs[layout.E, k] + pairs[layout.CREEP, k]
    low, high = signal[layout.CONST] - reach, signal[layout.CONST] + reach
    return bool(signal[layout.ATTACHED] == 0.0 and low >= least and high <= most)


@joined
def together(part: Ends, rest: Ends) -> Ends:
    """The whole signal at both ends: what is interpolated and what is not."""
    return Ends(part.p0 + rest.p0, part.s0 + rest.s0, part.p1 + rest.p1, part.s1 + rest.s1)


@kernel
def hull(ends: Ends, h: float) -> tuple[float, float]:
    """Least and greatest of the Bernstein coefficients p₀, p₀ + hs₀/3, p₁ − hs₁/3, p₁ of the Hermite interpolant."""
    p0, s0, p1, s1 = ends
    b1, b2 = p0 + h * s0 / 3.0, p1 - h * s1 / 3.0
    return min(min(p0, b1), min(b2, p1)), max(max(p0, b1), max(b2, p1))


@kernel
def bent(ends: Ends, h: float, error: float) -> float:
    """1 where the signal is proved convex on the panel, −1 where concave, 0 where neither is.

    The interpolant's curvature lies between 2(d − s₀)/h and 2(s₁ − d)/h, d = 3(p₁ − p₀)/h − s₀ − s₁; ``error`` bounds
    what it misses.
    """
    p0, s0, p1, s1 = ends
    middle = 3.0 * (p1 - p0) / h - s0 - s1  # the interpolant's slope in the middle of its hull
    left, right = 2.0 * (middle - s0) / h, 2.0 * (s1 - middle) / h
    if min(left, right) > error:
        return 1.0
    return -1.0 if max(left, right) < -error else 0.0


@kernel
def turning(g: Signal, node: float, slope: float, last: float, bend: float, accuracy: float) -> tuple[float, float]:
    """Least and greatest value on (node, node + last], convex (bend 1) or concave (−1) there; ``slope`` at the node.

    The root of g' by Newton's method in a bracket.
    """
    end, down, _ = value_at(g, node, node + last)
    low, high = end, end
    if bend * slope >= 0.0 or bend * down <= 0.0:
        return low, high
    left, right, t = 0.0, last, last * slope / (slope - down)
    for _ in range(ROUNDS):
        value, rate, curvature = value_at(g, node, node + t)
        low, high = min(low, value), max(high, value)
        if rate * rate <= abs(curvature) * FINE * accuracy or right - left <= EPSILON * (node + t):
            break
        if bend * rate < 0.0:
            left = t
        else:
            right = t
        t = t - rate / curvature if bend * curvature > 0.0 else 0.5 * (left + right)
        if not left < t < right:
            t = 0.5 * (left + right)
    return low, high


@kernel
def cubic_range(ends: Ends, h: float, end: float) -> tuple[float, float]:
    """Least and greatest value on [0, end], end ≤ h, of the cubic Hermite interpolant.

    p₀ + u(c₁ + u(c₂ + uc₃)) with u = t/h, at its ends and at the roots of c₁ + 2c₂u + 3c₃u².
    """
    p0, s0, p1, s1 = ends
    c1, c2 = h * s0, 3.0 * (p1 - p0) - h * (2.0 * s0 + s1)
    c3 = 2.0 * (p0 - p1) + h * (s0 + s1)
    last = end / h
    value = p0 + last * (c1 + last * (c2 + last * c3))
    low, high = min(p0, value), max(p0, value)
    root = c2 * c2 - 3.0 * c1 * c3
    if root >= 0.0:
        middle = -(c2 + (sqrt(root) if c2 >= 0.0 else -sqrt(root)))
        for i in range(2):
            top, bottom = (middle, 3.0 * c3) if i == 0 else (c1, middle)
            u = top / bottom if bottom != 0.0 else -1.0
            if 0.0 < u < last:
                value = p0 + u * (c1 + u * (c2 + u * c3))
                low, high = min(low, value), max(high, value)
    return low, high
