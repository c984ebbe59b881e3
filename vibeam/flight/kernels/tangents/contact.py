"""Disturbances through a contact that is integrated: the variational equations as an integral equation.

With y the coordinates of free flight, y' = A y + (load Ω²B sin φ + static − c F), the depth of the contact is

    d(t) = r·e^{A t} y − gap + ∫ r·e^{A (t − s)} (load Ω²B sin φ + static − c F(s)) ds,     F = f(d, d'),

and that of a disturbance δF = ∂F/∂d δd + ∂F/∂d' δd', with δd(t) = r·e^{A t} δy − ∫ r·e^{A (t − s)} c δF(s) ds. Both are
Volterra equations of the second kind for one function of time, however many modes there are, and both are solved by
collocation at Gauss' N points of a panel (Brunner 2004, ch. 2), the first by Newton's method, whose matrix is that of
the second. At a panel's end the error is of order 2N, by the force and by the modes' own responses.

Time runs as T u²(3 − 2u) over the contact: at both ends d ~ u², so that F ~ d^{3/2} and ∂F/∂d ~ d^{1/2} are analytic
in u. Panels are halved until the last two coefficients of F, ∂F/∂d and ∂F/∂d' in Legendre's polynomials are small, and
no longer than the fastest mode allows.
"""

from __future__ import annotations

from math import exp, sin

import numpy as np

from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.tangents import layout as row
from vibeam.flight.kernels.tangents.collocation import press, respond, substitute_columns
from vibeam.flight.kernels.tangents.flow import from_blocks, power, to_blocks, turn
from vibeam.flight.kernels.tangents.layout import TangentPlan
from vibeam_models.arrays import Array

TOLERANCE = 1e-7  # share that the last coefficients may be: what is at a panel's end has twice that order, about 1e-14
NOISE = 1e-14  # share of what d is the sum of that is round-off
NARROWEST, WIDEST = 1e-6, 0.25  # panels in u; the narrowest is taken as it is
MOST_TURNS = 4.0  # κ times a panel's length, κ the fastest rate
MOST_PANELS = 10_000  # a segment of contact has 64 steps, of some turns of the fastest mode at most
EASY = 1024.0  # times less than the tolerance: then the next panel may be twice as wide


@kernel
def begin_contact(plan: TangentPlan, pose: Array, side: int) -> None:
    """Set ``work.state`` to a pose (2, n), ``work.weights`` and ``work.gains`` to what the flow does to the contact."""
    blocks, work, n = plan.free.blocks, plan.work, plan.contact.shape[1]
    weights = work.weights
    for i in range(2 * n):
        weights[row.ROW, i], weights[row.ROW_RATE, i], weights[row.PUSH, i] = 0.0, 0.0, 0.0
        weights[row.LOAD, i], weights[row.STATIC, i], work.state[0, i] = 0.0, 0.0, 0.0
        for k in range(n):
            into, fast, out, rate = entries(plan, i, k)
            work.state[0, i] += into * pose[0, k] + fast * pose[1, k]
            weights[row.ROW, i] += plan.contact[side, k] * out
            weights[row.ROW_RATE, i] += plan.contact[side, k] * rate
            weights[row.PUSH, i] += fast * plan.contact[side, k]
            weights[row.LOAD, i] += fast * plan.load[k]
            weights[row.STATIC, i] += fast * plan.static[k]
    for k in range(n):
        first, second = 2 * k, 2 * k + 1
        for at in range(2):
            left, right = weights[row.ROW + at, first], weights[row.ROW + at, second]
            next_left = left * (blocks[row.A11, k] + blocks[row.SIGMA, k]) + right * blocks[row.A21, k]
            next_right = left * blocks[row.A12, k] + right * (blocks[row.A22, k] + blocks[row.SIGMA, k])
            weights[row.ROW_NEXT + at, first], weights[row.ROW_NEXT + at, second] = next_left, next_right
            for of in range(3):
                push, fast = weights[row.PUSH + of, first], weights[row.PUSH + of, second]
                work.gains[4 * of + 2 * at, k] = left * push + right * fast
                work.gains[4 * of + 2 * at + 1, k] = next_left * push + next_right * fast
    for i in range(row.PEAK_ROWS):
        work.peaks[i] = 0.0


@kernel
def entries(plan: TangentPlan, i: int, k: int) -> tuple[float, float, float, float]:
    """Of y_i by η_k and by η_k', and of η_k and η_k' by y_i."""
    flow, n = plan.free, plan.contact.shape[1]
    if flow.into.shape[0] == 0:
        own, speed = 1.0 if i == 2 * k else 0.0, 1.0 if i == 2 * k + 1 else 0.0
        return own, speed, own, speed
    return flow.into[i, k], flow.into[i, n + k], flow.outof[k, i], flow.outof[n + k, i]


@kernel
def pass_contact(plan: TangentPlan, side: int, clock: float, duration: float, frame: Array) -> int:
    """Columns of ``frame``, and ``work.state``, through a contact that lasts ``duration``; panels that it took.

    Where it would take more than ``MOST_PANELS`` the columns are NaN.
    """
    work, fastest, panels = plan.work, plan.law[row.W], 0
    for k in range(plan.free.blocks.shape[1]):
        fastest = max(fastest, plan.free.blocks[row.OMEGA, k] + plan.free.blocks[row.SIGMA, k])
    widest = min(WIDEST, MOST_TURNS / (1.5 * fastest * duration)) if fastest * duration > 0.0 else WIDEST
    to_blocks(plan.free, frame, work.frame)
    u, width = 0.0, widest
    while u < 1.0 and duration > 0.0:
        width = min(width, 1.0 - u)
        panels += 1
        if panels > MOST_PANELS:
            work.frame[:] = np.nan
            break
        length = enter_panel(plan, side, clock, duration, u, width)
        tail = press(plan)
        allowed = max(TOLERANCE, NOISE * work.peaks[row.SIZE] / max(work.peaks[row.DEEPEST], 1e-300))
        if tail > allowed and width > NARROWEST:
            width *= 0.5
            continue
        take_panel(plan, length, frame.shape[1])
        u, clock = u + width, clock + length
        if tail * EASY < allowed:
            width = min(2.0 * width, widest)
        if 1.0 - u < 1e-3 * NARROWEST:
            break
    from_blocks(plan.free, work.frame, frame)
    return panels


@kernel
def gone(u: float, by: float) -> float:
    """(u + by)²(3 − 2u − 2 by) − u²(3 − 2u) without cancellation."""
    return by * (6.0 * u * (1.0 - u) + by * (3.0 - 6.0 * u - 2.0 * by))


@kernel
def enter_panel(plan: TangentPlan, side: int, clock: float, duration: float, u: float, width: float) -> float:
    """Length of the panel; the powers of all blocks at its nodes, d and d' without the force, responses to it."""
    work, rule, blocks = plan.work, plan.rule, plan.free.blocks
    count, m, vectors = len(rule.nodes), blocks.shape[1], work.vectors
    work.peaks[row.SIZE] = abs(plan.gaps[side])
    for j in range(2 * m):
        work.peaks[row.SIZE] += abs(work.weights[row.ROW, j] * work.state[0, j])
    for i in range(count):
        at = u + width * rule.nodes[i]
        t = duration * gone(u, width * rule.nodes[i])
        vectors[row.TIME, i], vectors[row.WEIGHT, i] = t, duration * 6.0 * at * (1.0 - at) * width
        vectors[row.BASE, i] = plan.law[row.STRENGTH] * sin(plan.law[row.W] * (clock + t))
        vectors[row.DEEP, i], vectors[row.RATE, i] = -plan.gaps[side], 0.0
        for k in range(m):
            even, odd = power(plan.free, k, t)
            back = exp(2.0 * blocks[row.SIGMA, k] * t)
            work.powers[row.COSINE, i, k], work.powers[row.SINE, i, k] = even, odd
            work.powers[row.COSINE_BACK, i, k], work.powers[row.SINE_BACK, i, k] = even * back, -odd * back
            for at in range(2):
                for j in range(2 * k, 2 * k + 2):
                    weight = even * work.weights[row.ROW + at, j] + odd * work.weights[row.ROW_NEXT + at, j]
                    vectors[row.DEEP + at, i] += weight * work.state[0, j]
    length = duration * gone(u, width)
    for k in range(m):
        work.whole[0, k], work.whole[1, k] = power(plan.free, k, length)
    for i in range(count):
        for j in range(count):
            respond(plan, i, j)
    return length


@kernel
def take_panel(plan: TangentPlan, length: float, columns: int) -> None:
    """``work.frame`` and ``work.state`` to the end of the panel."""
    disturb(plan, columns)
    work, blocks = plan.work, plan.free.blocks
    state, weights = work.state, work.weights
    for k in range(blocks.shape[1]):
        first, second = 2 * k, 2 * k + 1
        even, odd = work.whole[0, k], work.whole[1, k]
        turn(plan.free, k, even, odd, work.frame, columns)
        a, b = state[0, first], state[0, second]
        ahead = applied(blocks, k, even, odd, a, b)
        state[0, first], state[0, second] = ahead[0], ahead[1]
        for i in range(work.vectors.shape[1]):
            share = plan.rule.weights[i] * work.vectors[row.WEIGHT, i]
            cosine, sine = work.powers[row.COSINE_BACK, i, k], work.powers[row.SINE_BACK, i, k]
            c, s = even * cosine + odd * sine * blocks[row.DISC, k], odd * cosine + even * sine
            base, pressed = work.vectors[row.BASE, i], work.vectors[row.FORCE, i]
            load = weights[row.LOAD, first] * base + weights[row.STATIC, first] - weights[row.PUSH, first] * pressed
            fast = weights[row.LOAD, second] * base + weights[row.STATIC, second] - weights[row.PUSH, second] * pressed
            pushed = applied(blocks, k, c, s, load, fast)
            state[0, first] += share * pushed[0]
            state[0, second] += share * pushed[1]
            pushed = applied(blocks, k, c, s, weights[row.PUSH, first], weights[row.PUSH, second])
            for j in range(columns):
                work.frame[first, j] -= share * pushed[0] * work.wide[1, i, j]
                work.frame[second, j] -= share * pushed[1] * work.wide[1, i, j]


@kernel
def applied(blocks: Array, k: int, even: float, odd: float, a: float, b: float) -> tuple[float, float]:
    """(C + S (A + σ)) (a, b) of block k."""
    sigma = blocks[row.SIGMA, k]
    return (
        even * a + odd * ((blocks[row.A11, k] + sigma) * a + blocks[row.A12, k] * b),
        even * b + odd * (blocks[row.A21, k] * a + (blocks[row.A22, k] + sigma) * b),
    )


@kernel
def disturb(plan: TangentPlan, columns: int) -> None:
    """``work.wide[1]`` (N, c): the disturbance of the force at the nodes, by those of ``work.frame``."""
    work, m = plan.work, plan.free.blocks.shape[1]
    rows, found = work.wide[0], work.wide[1]
    for i in range(work.vectors.shape[1]):
        by_deep, by_rate = work.vectors[row.BY_DEEP, i], work.vectors[row.BY_RATE, i]
        for k in range(m):
            even, odd = work.powers[row.COSINE, i, k], work.powers[row.SINE, i, k]
            for j in range(2 * k, 2 * k + 2):
                deep = even * work.weights[row.ROW, j] + odd * work.weights[row.ROW_NEXT, j]
                rate = even * work.weights[row.ROW_RATE, j] + odd * work.weights[row.ROW_RATE_NEXT, j]
                rows[i, j] = by_deep * deep + by_rate * rate
    for i in range(work.vectors.shape[1]):
        for j in range(columns):
            found[i, j] = 0.0
        for k in range(2 * m):
            for j in range(columns):
                found[i, j] += rows[i, k] * work.frame[k, j]
    substitute_columns(work.squares[2], found, columns)
