"""One panel: the pairs one step on, what is interpolated and what is only bounded, and the verdict.

A flight that starts on the stop has a root of known order m at t = 0; its first panel works on the quotient
p = g / t^m, whose fourth derivative is bounded by 24/(m+4)! times a bound on g^{(m+4)}.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel, summing
from vibeam.flight.kernels.layout import RESOLVED
from vibeam.flight.kernels.roots import taylor_pairs as att
from vibeam.flight.kernels.roots.bounds import CLEAR, Bounds, PanelEnds, verdict
from vibeam.flight.kernels.roots.pair import decay_growths, power
from vibeam.flight.kernels.roots.signal import EventSignal, Start, decays, derivatives, quotient, set_node
from vibeam_models.arrays import Array

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
    c, s = levels[layout.TURN_RE, level], levels[layout.TURN_IM, level]
    return Node(time + levels[layout.STEP, level], re * c - im * s, im * c + re * s)


@summing
def step_pairs(pairs: Array, table: Array, level: int) -> None:
    """Trial pairs one panel on from the node: x ← P00 x + P01 x', x' ← P10 x + P11 x'; or their two decays."""
    for k in range(pairs.shape[1]):
        x, y = pairs[layout.X, k], pairs[layout.Y, k]
        pairs[layout.X2, k] = table[layout.WALK, level, k] * x + table[layout.WALK + 1, level, k] * y
        pairs[layout.Y2, k] = table[layout.WALK + 2, level, k] * x + table[layout.WALK + 3, level, k] * y


@joined
def accept(g: EventSignal) -> None:
    """The trial end becomes the node; e_k = ‖(x, x'/ω)‖ there."""
    pairs, _, _, signal, attached = g
    for k in range(pairs.shape[1]):
        set_node(pairs, k, pairs[layout.X2, k], pairs[layout.Y2, k])
    if signal[layout.ATTACHED] > 0.0:
        att.accept(attached, signal)


@summing
def measure(g: EventSignal, node: Node, level: int) -> tuple[PanelEnds, Bounds, PanelEnds]:
    """Trial pairs, and what the panel from the node shows: ends of what is interpolated, bounds, ends of the rest.

    Interpolated is g less the pairs with κ_k h > 1.2: p = const + Im(z e^{iΩt}) + Σ x_k, with the bound M₄ = Ω⁴|z| +
    Σ κ_k⁴ e_k. The rest enters as slack Σ e_k, Σ κ_k e_k, Σ κ_k² e_k on value, slope and curvature. Of a pair far
    beyond critical damping the slow decay s e^{−at} is interpolated as long as ah ≤ 1.2, and the fast one is the rest.
    """
    pairs, table, levels, signal, attached = g
    time, re, im = node
    w, count = signal[layout.DRIVE], int(levels[layout.COUNT, level])
    re2 = re * levels[layout.TURN_RE, level] - im * levels[layout.TURN_IM, level]
    im2 = im * levels[layout.TURN_RE, level] + re * levels[layout.TURN_IM, level]
    p0, s0, p1, s1 = signal[layout.CONST] + im, w * re, signal[layout.CONST] + im2, w * re2
    fourth = signal[layout.HARMONIC] * (w * w) * (w * w)
    slack0, slack1, slack2 = 0.0, 0.0, 0.0
    begin, begin_slope, end, end_slope = 0.0, 0.0, 0.0, 0.0
    for k in range(count):
        x, y = pairs[layout.X, k], pairs[layout.Y, k]
        x2 = table[layout.WALK, level, k] * x + table[layout.WALK + 1, level, k] * y
        y2 = table[layout.WALK + 2, level, k] * x + table[layout.WALK + 3, level, k] * y
        pairs[layout.X2, k], pairs[layout.Y2, k] = x2, y2
        square, slow = pairs[layout.KAPPA, k] * pairs[layout.KAPPA, k], pairs[layout.SLOW, k] * pairs[layout.SLOW, k]
        fourth += pairs[layout.E, k] * square * square + pairs[layout.CREEP, k] * slow * slow
        p0 += x + pairs[layout.JOIN, k] * y
        s0 += pairs[layout.TILT, k] * y - pairs[layout.SLOW, k] * x
        p1 += x2 + pairs[layout.JOIN, k] * y2
        s1 += pairs[layout.TILT, k] * y2 - pairs[layout.SLOW, k] * x2
    for k in range(count, pairs.shape[1]):
        x, y, bound = pairs[layout.X, k], pairs[layout.Y, k], pairs[layout.E, k]
        x2 = table[layout.WALK, level, k] * x + table[layout.WALK + 1, level, k] * y
        y2 = table[layout.WALK + 2, level, k] * x + table[layout.WALK + 3, level, k] * y
        pairs[layout.X2, k], pairs[layout.Y2, k] = x2, y2
        if pairs[layout.SLOW, k] > 0.0:
            slow = pairs[layout.SLOW, k]
            if slow * levels[layout.STEP, level] <= RESOLVED:
                fourth += abs(x) * slow * slow * slow * slow
                p0, s0, p1, s1 = p0 + x, s0 - slow * x, p1 + x2, s1 - slow * x2
                x, x2 = 0.0, 0.0
            else:
                slack0, slack1, slack2 = slack0 + abs(x), slack1 + slow * abs(x), slack2 + slow * slow * abs(x)
            x, y = x + y, pairs[layout.TILT, k] * y - slow * x
            x2, y2 = x2 + y2, pairs[layout.TILT, k] * y2 - slow * x2
        slack0 += bound
        slack1 += bound * pairs[layout.KAPPA, k]
        slack2 += bound * pairs[layout.KAPPA, k] * pairs[layout.KAPPA, k]
        begin += x
        begin_slope += y
        end += x2
        end_slope += y2
    if signal[layout.ATTACHED] > 0.0:
        h = levels[layout.STEP, level]
        fourth += att.bound(attached, signal, time, 4, h)
        att.carry(attached, signal, time, h)
        for j in range(int(signal[layout.ATTACHED])):
            p0 += attached[layout.AWEIGHT, j] * attached[layout.NODE_X, j]
            s0 += attached[layout.AWEIGHT, j] * attached[layout.NODE_Y, j]
            p1 += attached[layout.AWEIGHT, j] * attached[layout.TRIAL_X, j]
            s1 += attached[layout.AWEIGHT, j] * attached[layout.TRIAL_Y, j]
    rest = PanelEnds(begin, begin_slope, end, end_slope)
    return PanelEnds(p0, s0, p1, s1), Bounds(fourth, slack0, slack1, slack2), rest


@joined
def ordinary(g: EventSignal, node: Node, level: int, tolerance: float) -> int:
    """Verdict on the panel that starts at the node; terms[P0 … S1] receive the whole signal at its ends."""
    part, bounds, rest = measure(g, node, level)
    signal, end, end_slope = g.terms, part.p1 + rest.p1, part.s1 + rest.s1
    found = verdict(part, g.levels[layout.STEP, level], bounds, end, end_slope, tolerance)
    if found != CLEAR:
        signal[layout.P0], signal[layout.S0], signal[layout.P1] = part.p0 + rest.p0, part.s0 + rest.s0, end
        signal[layout.S1] = end_slope
    return found


@joined
def launching(g: EventSignal, start: Start, level: int) -> int:
    """Verdict on the first panel of a flight that starts on the stop with g^{(m)}(0) = ``start.rise`` > 0, exactly.

    On p = g/t^m: p(0) = g^{(m)}(0)/m!, p'(0) = g^{(m+1)}(0)/(m + 1)!, |p⁗| ≤ 24/(m + 4)! M_{m+4}, and the slack
    likewise from bounds of order m, m + 1, m + 2. terms[P0 … S1] receive the whole quotient at the panel's ends.
    """
    pairs, _, levels, signal, attached = g
    order, rise = start
    h, count = levels[layout.STEP, level], int(levels[layout.COUNT, level])
    derivatives(g, count, layout.LOW, order + 1)
    m4 = signal[layout.HARMONIC] * power(signal[layout.DRIVE], order + 4)
    for k in range(count):
        m4 += pairs[layout.E, k] * power(pairs[layout.KAPPA, k], order + 4) + pairs[layout.CREEP, k] * power(
            pairs[layout.SLOW, k], order + 4
        )
    slack, hidden = 0.0, 0.0
    slack1, slack2 = 0.0, 0.0
    for k in range(count, pairs.shape[1]):
        part = pairs[layout.E, k] * power(pairs[layout.KAPPA, k], order)
        slack += part
        slack1 += part * pairs[layout.KAPPA, k]
        slack2 += part * pairs[layout.KAPPA, k] * pairs[layout.KAPPA, k]
        if pairs[layout.SLOW, k] == 0.0:
            hidden += initial_derivative(pairs, k, order)
            continue
        hidden += pairs[layout.Y, k] * power(pairs[layout.TILT, k], order)
        slow = pairs[layout.CREEP, k] * power(pairs[layout.SLOW, k], order)
        if pairs[layout.SLOW, k] * h <= RESOLVED:
            m4 += slow * power(pairs[layout.SLOW, k], 4)
            for j in range(order + 2):
                signal[layout.LOW + j] += pairs[layout.X, k] * power(-pairs[layout.SLOW, k], j)
        else:
            hidden += pairs[layout.X, k] * power(-pairs[layout.SLOW, k], order)
            slack += slow
            slack1 += slow * pairs[layout.SLOW, k]
            slack2 += slow * pairs[layout.SLOW, k] * pairs[layout.SLOW, k]
    if signal[layout.ATTACHED] > 0.0:
        m4 += att.bound(attached, signal, 0.0, order + 4, h)
    gamma, delta, rest_gamma, rest_delta = growths(g, count, level)
    low = rise - hidden
    p1, s1 = quotient(Start(order, low), signal[layout.LOW + 2], gamma, delta, h)
    end, end_slope = quotient(start, signal[layout.WHOLE + 2], gamma + rest_gamma, delta + rest_delta, h)
    signal[layout.P0] = rise / FACTORIAL[order]
    signal[layout.S0] = signal[layout.WHOLE + order + 1] / FACTORIAL[order + 1]
    signal[layout.P1], signal[layout.S1] = end, end_slope
    part = PanelEnds(low / FACTORIAL[order], signal[layout.LOW + order + 1] / FACTORIAL[order + 1], p1, s1)
    first, second = slack1 / FACTORIAL[order + 1], 2.0 * slack2 / FACTORIAL[order + 2]
    bounds = Bounds(m4 * 24.0 / FACTORIAL[order + 4], slack / FACTORIAL[order], first, second)
    return verdict(part, h, bounds, end, end_slope, 0.0)


@summing
def growths(g: EventSignal, count: int, level: int) -> tuple[float, float, float, float]:
    """γ and δ over one panel from the start: of the interpolated part, and of the rest.

    γ = (g(h) − g(0) − hg'(0))/h², δ = (g'(h) − g'(0))/h; of a pair D0 x + D1 x' and V0 x + V1 x' (``pair.increments``).
    """
    pairs, table, levels, signal, attached = g
    gamma = signal[layout.ZR] * levels[layout.SECOND_IM, level] + signal[layout.ZI] * levels[layout.SECOND_RE, level]
    delta = signal[layout.DRIVE] * (
        signal[layout.ZR] * levels[layout.FIRST_RE, level] - signal[layout.ZI] * levels[layout.FIRST_IM, level]
    )
    if signal[layout.ATTACHED] > 0.0:
        more = att.growth(attached, signal, levels[layout.STEP, level])
        gamma += more[0]
        delta += more[1]
    rest_gamma, rest_delta = 0.0, 0.0
    for k in range(pairs.shape[1]):
        x, y = pairs[layout.X0, k], pairs[layout.Y0, k]
        if k < count:
            gamma += table[4, level, k] * x + table[5, level, k] * y
            delta += table[6, level, k] * x + table[7, level, k] * y
        else:
            rest_gamma += table[4, level, k] * x + table[5, level, k] * y
            rest_delta += table[6, level, k] * x + table[7, level, k] * y
            h, slow = levels[layout.STEP, level], pairs[layout.SLOW, k]
            if slow > 0.0 and slow * h <= RESOLVED:
                s, _ = decays(pairs, k, x, y)
                one, two = decay_growths(slow, h)
                gamma, rest_gamma = gamma + one * s, rest_gamma - one * s
                delta, rest_delta = delta + two * s, rest_delta - two * s
    return gamma, delta, rest_gamma, rest_delta


@kernel
def initial_derivative(pairs: Array, k: int, order: int) -> float:
    """x_k^{(j)}(0), j = ``order`` ≥ 1, by x'' = −2σx' − ω²x."""
    before, now, sigma, own = pairs[layout.X0, k], pairs[layout.Y0, k], pairs[layout.SIGMA, k], pairs[layout.OMEGA, k]
    for _ in range(order - 1):
        before, now = now, -2.0 * sigma * now - own * own * before
    return float(now)
