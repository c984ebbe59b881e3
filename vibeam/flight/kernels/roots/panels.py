"""One panel: the pairs one step on, what is interpolated and what is only bounded, and the verdict.

A flight that starts on the stop has a root of known order m at t = 0; its first panel works on the quotient
p = g / t^m, whose fourth derivative is bounded by 24/(m+4)! times a bound on g^{(m+4)}.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import joined, kernel, summing
from vibeam.flight.kernels.layout import (
    ATTACHED,
    AWEIGHT,
    CONST,
    COUNT,
    DRIVE,
    FIRST_IM,
    FIRST_RE,
    HARMONIC,
    INVERSE,
    KAPPA,
    LOW,
    NODE_X,
    NODE_Y,
    OMEGA,
    P0,
    P1,
    S0,
    S1,
    SECOND_IM,
    SECOND_RE,
    SIGMA,
    STEP,
    TRIAL_X,
    TRIAL_Y,
    TURN_IM,
    TURN_RE,
    WHOLE,
    X0,
    X2,
    Y0,
    Y2,
    ZI,
    ZR,
    E,
    X,
    Y,
)
from vibeam.flight.kernels.roots import taylor_pairs as att
from vibeam.flight.kernels.roots.bounds import CLEAR, verdict
from vibeam.flight.kernels.roots.pair import norm, power
from vibeam.flight.kernels.roots.signal import derivatives, quotient

Array = NDArray[np.float64]

FACTORIAL = np.array([1.0, 1.0, 2.0, 6.0, 24.0, 120.0, 720.0, 5040.0])


@summing
def step_pairs(pairs: Array, table: Array, level: int) -> None:
    """Trial pairs one panel on from the node."""
    for k in range(pairs.shape[1]):
        x, y = pairs[X, k], pairs[Y, k]
        pairs[X2, k] = table[0, level, k] * x + table[1, level, k] * y
        pairs[Y2, k] = table[2, level, k] * x + table[3, level, k] * y


@joined
def accept(pairs: Array, signal: Array, attached: Array) -> None:
    """The trial end becomes the node."""
    for k in range(pairs.shape[1]):
        x, y = pairs[X2, k], pairs[Y2, k]
        pairs[X, k], pairs[Y, k], pairs[E, k] = x, y, norm(x, y * pairs[INVERSE, k])
    if signal[ATTACHED] > 0.0:
        att.accept(attached, signal)


@summing
def measure(
    pairs: Array,
    table: Array,
    levels: Array,
    signal: Array,
    attached: Array,
    time: float,
    re: float,
    im: float,
    level: int,
) -> tuple[float, float, float, float, float, float, float, float, float, float, float, float]:
    """Trial pairs, and what the panel from the node shows.

    Value and slope at both ends of the interpolated part; the bound of its fourth derivative; bounds on value, slope
    and curvature of the rest; value and slope of the rest at both ends.
    """
    w, count = signal[DRIVE], int(levels[COUNT, level])
    re2 = re * levels[TURN_RE, level] - im * levels[TURN_IM, level]
    im2 = im * levels[TURN_RE, level] + re * levels[TURN_IM, level]
    p0, s0, p1, s1 = signal[CONST] + im, w * re, signal[CONST] + im2, w * re2
    fourth = signal[HARMONIC] * (w * w) * (w * w)
    slack0, slack1, slack2 = 0.0, 0.0, 0.0
    begin, begin_slope, end, end_slope = 0.0, 0.0, 0.0, 0.0
    for k in range(count):
        x, y = pairs[X, k], pairs[Y, k]
        x2 = table[0, level, k] * x + table[1, level, k] * y
        y2 = table[2, level, k] * x + table[3, level, k] * y
        pairs[X2, k], pairs[Y2, k] = x2, y2
        square = pairs[KAPPA, k] * pairs[KAPPA, k]
        fourth += pairs[E, k] * square * square
        p0 += x
        s0 += y
        p1 += x2
        s1 += y2
    for k in range(count, pairs.shape[1]):
        x, y, bound = pairs[X, k], pairs[Y, k], pairs[E, k]
        x2 = table[0, level, k] * x + table[1, level, k] * y
        y2 = table[2, level, k] * x + table[3, level, k] * y
        pairs[X2, k], pairs[Y2, k] = x2, y2
        slack0 += bound
        slack1 += bound * pairs[KAPPA, k]
        slack2 += bound * pairs[KAPPA, k] * pairs[KAPPA, k]
        begin += x
        begin_slope += y
        end += x2
        end_slope += y2
    if signal[ATTACHED] > 0.0:
        h = levels[STEP, level]
        fourth += att.bound(attached, signal, time, 4, h)
        att.carry(attached, signal, time, h)
        for j in range(int(signal[ATTACHED])):
            p0 += attached[AWEIGHT, j] * attached[NODE_X, j]
            s0 += attached[AWEIGHT, j] * attached[NODE_Y, j]
            p1 += attached[AWEIGHT, j] * attached[TRIAL_X, j]
            s1 += attached[AWEIGHT, j] * attached[TRIAL_Y, j]
    return p0, s0, p1, s1, fourth, slack0, slack1, slack2, begin, begin_slope, end, end_slope


@joined
def ordinary(
    pairs: Array, table: Array, levels: Array, signal: Array, attached: Array,
    time: float, re: float, im: float, level: int, tolerance: float,
) -> int:  # fmt: skip
    """Verdict on the panel that starts at the node; signal[P0 … S1] receive the whole signal at its ends."""
    p0, s0, p1, s1, fourth, slack0, slack1, slack2, begin, begin_slope, end, end_slope = measure(
        pairs, table, levels, signal, attached, time, re, im, level
    )
    h, end, end_slope = levels[STEP, level], p1 + end, s1 + end_slope
    found = verdict(p0, s0, p1, s1, h, fourth, slack0, slack1, slack2, end, end_slope, tolerance)
    if found != CLEAR:
        signal[P0], signal[S0], signal[P1], signal[S1] = p0 + begin, s0 + begin_slope, end, end_slope
    return found


@joined
def launching(
    pairs: Array, table: Array, levels: Array, signal: Array, attached: Array, order: int, rise: float, level: int
) -> int:
    """Verdict on the first panel of a flight that starts on the stop with g^{(order)}(0) = ``rise`` > 0, exactly.

    signal[P0 … S1] receive the whole quotient at its ends.
    """
    h, count = levels[STEP, level], int(levels[COUNT, level])
    derivatives(pairs, signal, attached, count, LOW, order + 1)
    m4 = signal[HARMONIC] * power(signal[DRIVE], order + 4)
    for k in range(count):
        m4 += pairs[E, k] * power(pairs[KAPPA, k], order + 4)
    slack, hidden = 0.0, 0.0
    slack1, slack2 = 0.0, 0.0
    for k in range(count, pairs.shape[1]):
        part = pairs[E, k] * power(pairs[KAPPA, k], order)
        slack += part
        slack1 += part * pairs[KAPPA, k]
        slack2 += part * pairs[KAPPA, k] * pairs[KAPPA, k]
        hidden += initial_derivative(pairs, k, order)
    if signal[ATTACHED] > 0.0:
        m4 += att.bound(attached, signal, 0.0, order + 4, h)
    gamma, delta, rest_gamma, rest_delta = growths(pairs, table, levels, signal, attached, count, level)
    low = rise - hidden
    p1, s1 = quotient(order, low, signal[LOW + 2], gamma, delta, h)
    end, end_slope = quotient(order, rise, signal[WHOLE + 2], gamma + rest_gamma, delta + rest_delta, h)
    signal[P0], signal[S0] = rise / FACTORIAL[order], signal[WHOLE + order + 1] / FACTORIAL[order + 1]
    signal[P1], signal[S1] = end, end_slope
    return verdict(
        low / FACTORIAL[order], signal[LOW + order + 1] / FACTORIAL[order + 1], p1, s1, h,
        m4 * 24.0 / FACTORIAL[order + 4], slack / FACTORIAL[order], slack1 / FACTORIAL[order + 1],
        2.0 * slack2 / FACTORIAL[order + 2], end, end_slope, 0.0,
    )  # fmt: skip


@summing
def growths(
    pairs: Array, table: Array, levels: Array, signal: Array, attached: Array, count: int, level: int
) -> tuple[float, float, float, float]:
    """γ and δ over one panel from the start: of the interpolated part, and of the rest."""
    gamma = signal[ZR] * levels[SECOND_IM, level] + signal[ZI] * levels[SECOND_RE, level]
    delta = signal[DRIVE] * (signal[ZR] * levels[FIRST_RE, level] - signal[ZI] * levels[FIRST_IM, level])
    if signal[ATTACHED] > 0.0:
        more = att.growth(attached, signal, levels[STEP, level])
        gamma += more[0]
        delta += more[1]
    rest_gamma, rest_delta = 0.0, 0.0
    for k in range(pairs.shape[1]):
        x, y = pairs[X0, k], pairs[Y0, k]
        if k < count:
            gamma += table[4, level, k] * x + table[5, level, k] * y
            delta += table[6, level, k] * x + table[7, level, k] * y
        else:
            rest_gamma += table[4, level, k] * x + table[5, level, k] * y
            rest_delta += table[6, level, k] * x + table[7, level, k] * y
    return gamma, delta, rest_gamma, rest_delta


@kernel
def initial_derivative(pairs: Array, k: int, order: int) -> float:
    """x_k^{(order)} at the start."""
    before, now = pairs[X0, k], pairs[Y0, k]
    for _ in range(order - 1):
        before, now = now, -2.0 * pairs[SIGMA, k] * now - pairs[OMEGA, k] * pairs[OMEGA, k] * before
    return float(now)
