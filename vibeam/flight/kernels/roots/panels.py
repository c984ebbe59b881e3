"""One panel: the pairs one step on, what is interpolated and what is only bounded, and the verdict.

A flight that starts on the stop has a root of known order m at t = 0; its first panel works on the quotient
p = g / t^m, whose fourth derivative is bounded by 24/(m+4)! times a bound on g^{(m+4)}.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import joined, kernel, summing
from vibeam.flight.kernels.layout import (
    ATTACHED,
    AWEIGHT,
    CONST,
    COUNT,
    CREEP,
    DRIVE,
    FIRST_IM,
    FIRST_RE,
    HARMONIC,
    JOIN,
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
    SLOW,
    STEP,
    TILT,
    TRIAL_X,
    TRIAL_Y,
    TURN_IM,
    TURN_RE,
    WALK,
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
from vibeam.flight.kernels.roots.bounds import CLEAR, Bounds, Ends, verdict
from vibeam.flight.kernels.roots.pair import decay_growths, power
from vibeam.flight.kernels.roots.signal import Signal, Start, decays, derivatives, quotient, set_node
from vibeam.flight.kernels.thresholds import RESOLVED

Array = NDArray[np.float64]

FACTORIAL = np.array([1.0, 1.0, 2.0, 6.0, 24.0, 120.0, 720.0, 5040.0])


class Node(NamedTuple):
    """Left end of a panel: its flight time t and the drive's phasor z e^{iΩt} there."""

    time: float
    re: float
    im: float


@joined
def next_node(levels: Array, level: int, node: Node) -> Node:
    """t + h and z e^{iΩ(t + h)}."""
    time, re, im = node
    return Node(
        time + levels[STEP, level],
        re * levels[TURN_RE, level] - im * levels[TURN_IM, level],
        im * levels[TURN_RE, level] + re * levels[TURN_IM, level],
    )


@summing
def step_pairs(pairs: Array, table: Array, level: int) -> None:
    """Trial pairs one panel on from the node: x ← P00 x + P01 x', x' ← P10 x + P11 x'; or their two decays."""
    for k in range(pairs.shape[1]):
        x, y = pairs[X, k], pairs[Y, k]
        pairs[X2, k] = table[WALK, level, k] * x + table[WALK + 1, level, k] * y
        pairs[Y2, k] = table[WALK + 2, level, k] * x + table[WALK + 3, level, k] * y


@joined
def accept(g: Signal) -> None:
    """The trial end becomes the node; e_k = ‖(x, x'/ω)‖ there."""
    pairs, _, _, signal, attached = g
    for k in range(pairs.shape[1]):
        set_node(pairs, k, pairs[X2, k], pairs[Y2, k])
    if signal[ATTACHED] > 0.0:
        att.accept(attached, signal)


@summing
def measure(g: Signal, node: Node, level: int) -> tuple[Ends, Bounds, Ends]:
    """Trial pairs, and what the panel from the node shows: ends of what is interpolated, bounds, ends of the rest.

    Interpolated is g less the pairs with κ_k h > 1.2: p = const + Im(z e^{iΩt}) + Σ x_k, with the bound M₄ = Ω⁴|z| +
    Σ κ_k⁴ e_k. The rest enters as slack Σ e_k, Σ κ_k e_k, Σ κ_k² e_k on value, slope and curvature. Of a pair far
    beyond critical damping the slow decay s e^{−at} is interpolated as long as ah ≤ 1.2, and the fast one is the rest.
    """
    pairs, table, levels, signal, attached = g
    time, re, im = node
    w, count = signal[DRIVE], int(levels[COUNT, level])
    re2 = re * levels[TURN_RE, level] - im * levels[TURN_IM, level]
    im2 = im * levels[TURN_RE, level] + re * levels[TURN_IM, level]
    p0, s0, p1, s1 = signal[CONST] + im, w * re, signal[CONST] + im2, w * re2
    fourth = signal[HARMONIC] * (w * w) * (w * w)
    slack0, slack1, slack2 = 0.0, 0.0, 0.0
    begin, begin_slope, end, end_slope = 0.0, 0.0, 0.0, 0.0
    for k in range(count):
        x, y = pairs[X, k], pairs[Y, k]
        x2 = table[WALK, level, k] * x + table[WALK + 1, level, k] * y
        y2 = table[WALK + 2, level, k] * x + table[WALK + 3, level, k] * y
        pairs[X2, k], pairs[Y2, k] = x2, y2
        square, slow = pairs[KAPPA, k] * pairs[KAPPA, k], pairs[SLOW, k] * pairs[SLOW, k]
        fourth += pairs[E, k] * square * square + pairs[CREEP, k] * slow * slow
        p0 += x + pairs[JOIN, k] * y
        s0 += pairs[TILT, k] * y - pairs[SLOW, k] * x
        p1 += x2 + pairs[JOIN, k] * y2
        s1 += pairs[TILT, k] * y2 - pairs[SLOW, k] * x2
    for k in range(count, pairs.shape[1]):
        x, y, bound = pairs[X, k], pairs[Y, k], pairs[E, k]
        x2 = table[WALK, level, k] * x + table[WALK + 1, level, k] * y
        y2 = table[WALK + 2, level, k] * x + table[WALK + 3, level, k] * y
        pairs[X2, k], pairs[Y2, k] = x2, y2
        if pairs[SLOW, k] > 0.0:
            slow = pairs[SLOW, k]
            if slow * levels[STEP, level] <= RESOLVED:
                fourth += abs(x) * slow * slow * slow * slow
                p0, s0, p1, s1 = p0 + x, s0 - slow * x, p1 + x2, s1 - slow * x2
                x, x2 = 0.0, 0.0
            else:
                slack0, slack1, slack2 = slack0 + abs(x), slack1 + slow * abs(x), slack2 + slow * slow * abs(x)
            x, y = x + y, pairs[TILT, k] * y - slow * x
            x2, y2 = x2 + y2, pairs[TILT, k] * y2 - slow * x2
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
    return Ends(p0, s0, p1, s1), Bounds(fourth, slack0, slack1, slack2), Ends(begin, begin_slope, end, end_slope)


@joined
def ordinary(g: Signal, node: Node, level: int, tolerance: float) -> int:
    """Verdict on the panel that starts at the node; terms[P0 … S1] receive the whole signal at its ends."""
    part, bounds, rest = measure(g, node, level)
    signal, end, end_slope = g.terms, part.p1 + rest.p1, part.s1 + rest.s1
    found = verdict(part, g.levels[STEP, level], bounds, end, end_slope, tolerance)
    if found != CLEAR:
        signal[P0], signal[S0], signal[P1], signal[S1] = part.p0 + rest.p0, part.s0 + rest.s0, end, end_slope
    return found


@joined
def launching(g: Signal, start: Start, level: int) -> int:
    """Verdict on the first panel of a flight that starts on the stop with g^{(m)}(0) = ``start.rise`` > 0, exactly.

    On p = g/t^m: p(0) = g^{(m)}(0)/m!, p'(0) = g^{(m+1)}(0)/(m + 1)!, |p⁗| ≤ 24/(m + 4)! M_{m+4}, and the slack
    likewise from bounds of order m, m + 1, m + 2. terms[P0 … S1] receive the whole quotient at the panel's ends.
    """
    pairs, _, levels, signal, attached = g
    order, rise = start
    h, count = levels[STEP, level], int(levels[COUNT, level])
    derivatives(g, count, LOW, order + 1)
    m4 = signal[HARMONIC] * power(signal[DRIVE], order + 4)
    for k in range(count):
        m4 += pairs[E, k] * power(pairs[KAPPA, k], order + 4) + pairs[CREEP, k] * power(pairs[SLOW, k], order + 4)
    slack, hidden = 0.0, 0.0
    slack1, slack2 = 0.0, 0.0
    for k in range(count, pairs.shape[1]):
        part = pairs[E, k] * power(pairs[KAPPA, k], order)
        slack += part
        slack1 += part * pairs[KAPPA, k]
        slack2 += part * pairs[KAPPA, k] * pairs[KAPPA, k]
        if pairs[SLOW, k] == 0.0:
            hidden += initial_derivative(pairs, k, order)
            continue
        hidden += pairs[Y, k] * power(pairs[TILT, k], order)
        slow = pairs[CREEP, k] * power(pairs[SLOW, k], order)
        if pairs[SLOW, k] * h <= RESOLVED:
            m4 += slow * power(pairs[SLOW, k], 4)
            for j in range(order + 2):
                signal[LOW + j] += pairs[X, k] * power(-pairs[SLOW, k], j)
        else:
            hidden += pairs[X, k] * power(-pairs[SLOW, k], order)
            slack += slow
            slack1 += slow * pairs[SLOW, k]
            slack2 += slow * pairs[SLOW, k] * pairs[SLOW, k]
    if signal[ATTACHED] > 0.0:
        m4 += att.bound(attached, signal, 0.0, order + 4, h)
    gamma, delta, rest_gamma, rest_delta = growths(g, count, level)
    low = rise - hidden
    p1, s1 = quotient(Start(order, low), signal[LOW + 2], gamma, delta, h)
    end, end_slope = quotient(start, signal[WHOLE + 2], gamma + rest_gamma, delta + rest_delta, h)
    signal[P0], signal[S0] = rise / FACTORIAL[order], signal[WHOLE + order + 1] / FACTORIAL[order + 1]
    signal[P1], signal[S1] = end, end_slope
    part = Ends(low / FACTORIAL[order], signal[LOW + order + 1] / FACTORIAL[order + 1], p1, s1)
    bounds = Bounds(
        m4 * 24.0 / FACTORIAL[order + 4],
        slack / FACTORIAL[order],
        slack1 / FACTORIAL[order + 1],
        2.0 * slack2 / FACTORIAL[order + 2],
    )
    return verdict(part, h, bounds, end, end_slope, 0.0)


@summing
def growths(g: Signal, count: int, level: int) -> tuple[float, float, float, float]:
    """γ and δ over one panel from the start: of the interpolated part, and of the rest.

    γ = (g(h) − g(0) − hg'(0))/h², δ = (g'(h) − g'(0))/h; of a pair D0 x + D1 x' and V0 x + V1 x' (``pair.increments``).
    """
    pairs, table, levels, signal, attached = g
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
            h, slow = levels[STEP, level], pairs[SLOW, k]
            if slow > 0.0 and slow * h <= RESOLVED:
                s, _ = decays(pairs, k, x, y)
                one, two = decay_growths(slow, h)
                gamma, rest_gamma = gamma + one * s, rest_gamma - one * s
                delta, rest_delta = delta + two * s, rest_delta - two * s
    return gamma, delta, rest_gamma, rest_delta


@kernel
def initial_derivative(pairs: Array, k: int, order: int) -> float:
    """x_k^{(j)}(0), j = ``order`` ≥ 1, by x'' = −2σx' − ω²x."""
    before, now = pairs[X0, k], pairs[Y0, k]
    for _ in range(order - 1):
        before, now = now, -2.0 * pairs[SIGMA, k] * now - pairs[OMEGA, k] * pairs[OMEGA, k] * before
    return float(now)
