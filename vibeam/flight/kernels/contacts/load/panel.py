"""One signal on a panel under a load: its values at the ends, the bound on its fourth derivative, verdict and root.

From the fourth derivative on the load, a cubic, is gone: y⁗ is a free motion, y⁗(τ) = e^{Aτ} y⁗(0), so that a block's
share r·y⁗ is bounded for the whole panel by its value and rate at the node, as a free pair's is. A signal that starts
with a root of order m is worked on as p = g/τ^m,

    p = g^{(m)}/m! + τ r·[φ_{m+1} y^{(m+1)} + Σ τ^i φ_{m+1+i} l u^{(m+i)}],   p' = r·[(φ_m − m φ_{m+1}) y^{(m+1)} + …],

in which nothing cancels near τ = 0; m = 0 is g itself, by what it grows from the node on.
"""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel, summing
from vibeam.flight.kernels.contacts import course as row
from vibeam.flight.kernels.contacts.course import Course
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.contacts.load.phi import functions
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.kernels.roots.bounds import Bounds, PanelEnds, verdict
from vibeam.flight.kernels.roots.newton import EPSILON
from vibeam.flight.kernels.roots.pair import norm
from vibeam_models.arrays import Array

ROUNDS = 100
CLOSE = 1e-12  # share of a panel within which a minimum is found


@joined
def sign_of(engine: ContactEngine, which: int) -> float:
    """−1 for the negative of a signal."""
    return -1.0 if which >= 2 * engine.rows.shape[0] else 1.0


@joined
def row_of(engine: ContactEngine, which: int) -> int:
    """Row of ``regime.signals`` of a signal, less its sign."""
    return which - 2 * engine.rows.shape[0] if which >= 2 * engine.rows.shape[0] else which


@summing
def read(weights: Array, flow: Array, at: int) -> float:
    """weights · y of the rows from ``at`` on."""
    total = 0.0
    for k in range(flow.shape[1]):
        total += weights[2 * k] * flow[at, k] + weights[2 * k + 1] * flow[at + 1, k]
    return total


@kernel
def parts(weights: Array, flow: Array, at: int) -> float:
    """The sizes of the parts of weights · y of the rows from ``at`` on, added up."""
    total = 0.0
    for k in range(flow.shape[1]):
        total += abs(weights[2 * k] * flow[at, k]) + abs(weights[2 * k + 1] * flow[at + 1, k])
    return total


@kernel
def show_value(engine: ContactEngine, regime: Regime, course: Course, place: int, which: int) -> None:
    """watch[AT], [SLOPE] and [PARTS] of a signal at the node."""
    weights, sign, watch, n = (
        regime.signals[row_of(engine, which)],
        sign_of(engine, which),
        course.watch,
        engine.omega.shape[0],
    )
    share, u = weights[2 * n + 1], course.numbers[row.U]
    value = read(weights, course.flow, row.Y) + weights[2 * n] + share * u
    watch[row.AT, place] = sign * value + watch[row.ADDED, place]
    watch[row.SLOPE, place] = sign * (read(weights, course.flow, row.RATE) + share * course.numbers[row.U1])
    watch[row.PARTS, place] = parts(weights, course.flow, row.Y) + abs(weights[2 * n]) + abs(share * u)


@kernel
def derivative_at(engine: ContactEngine, regime: Regime, course: Course, which: int, order: int) -> float:
    """The ``order``-th derivative, 1 … 4, of a signal at the node."""
    weights, n = regime.signals[row_of(engine, which)], engine.omega.shape[0]
    value = read(weights, course.flow, row.Y + 2 * order)
    if order < 4:
        value += weights[2 * n + 1] * course.numbers[row.U + order]
    return sign_of(engine, which) * value


@kernel
def bound_of(regime: Regime, weights: Array, flow: Array, order: int, h: float) -> float:
    """Bound over h of the derivative of a signal of order 4 + ``order``, which is a sum of free pairs."""
    total = 0.0
    for k in range(flow.shape[1]):
        x = weights[2 * k] * flow[row.FOURTH, k] + weights[2 * k + 1] * flow[row.FOURTH + 1, k]
        y = weights[2 * k] * flow[row.FIFTH, k] + weights[2 * k + 1] * flow[row.FIFTH + 1, k]
        damp, square = (
            2.0 * regime.pairs[layout.SIGMA, k],
            regime.pairs[layout.OMEGA, k] * regime.pairs[layout.OMEGA, k],
        )
        for _ in range(order):
            x, y = y, -damp * y - square * x
        most = abs(x) + h * abs(y)
        if regime.pairs[layout.INVERSE, k] > 0.0:
            most = min(most, norm(x, y * regime.pairs[layout.INVERSE, k]))
        total += most
    return total


@kernel
def judge(engine: ContactEngine, regime: Regime, course: Course, place: int, which: int, h: float) -> int:
    """Verdict on a panel of length h from the node on for one signal; its flow is grown to the end."""
    weights, sign, watch, n = (
        regime.signals[row_of(engine, which)],
        sign_of(engine, which),
        course.watch,
        engine.omega.shape[0],
    )
    share, numbers, order = weights[2 * n + 1], course.numbers, int(watch[row.START_ORDER, place])
    if order > 0:
        return judge_start(engine, regime, course, place, which, h)
    fourth = bound_of(regime, weights, course.flow, order, h)
    growth = read(weights, course.flow, row.GROWTH) + share * (numbers[row.U_LAST] - numbers[row.U])
    last = watch[row.AT, place] + sign * growth
    slope = sign * (read(weights, course.flow, row.TRIAL_RATE) + share * numbers[row.U1_LAST])
    watch[row.LAST, place], watch[row.LAST_SLOPE, place] = last, slope
    ends = PanelEnds(watch[row.AT, place], watch[row.SLOPE, place], last, slope)
    return verdict(ends, h, Bounds(fourth, 0.0, 0.0, 0.0), last, slope, 8.0 * EPSILON * watch[row.PARTS, place])


@kernel
def judge_start(engine: ContactEngine, regime: Regime, course: Course, place: int, which: int, h: float) -> int:
    """The same for a signal that starts with a root: watch[AT … LAST_SLOPE] are those of p = g/τ^m."""
    watch, weights, order = (
        course.watch,
        regime.signals[row_of(engine, which)],
        int(course.watch[row.START_ORDER, place]),
    )
    factor, more = factorial(order), factorial(order + 1)
    fourth = bound_of(regime, weights, course.flow, order, h) * 24.0 / factorial(order + 4)
    watch[row.AT, place] = watch[row.START_RISE, place] / factor
    watch[row.SLOPE, place] = derivative_at(engine, regime, course, which, order + 1) / more
    set_functions(regime, course, h)
    last, slope = evaluate(engine, regime, course, place, which, h)
    watch[row.LAST, place], watch[row.LAST_SLOPE, place] = last, slope
    ends = PanelEnds(watch[row.AT, place], watch[row.SLOPE, place], last, slope)
    return verdict(ends, h, Bounds(fourth, 0.0, 0.0, 0.0), last, slope, 0.0)


@joined
def factorial(n: int) -> float:
    """n! for small n."""
    total = 1.0
    for i in range(2, n + 1):
        total *= i
    return total


@kernel
def set_functions(regime: Regime, course: Course, tau: float) -> None:
    """The φ-functions of all blocks over τ."""
    for k in range(course.flow.shape[1]):
        functions(regime.pairs, k, tau, course.phi)


@kernel
def evaluate(
    engine: ContactEngine, regime: Regime, course: Course, place: int, which: int, tau: float
) -> tuple[float, float]:
    """p and p' of a signal at τ from the node on, ``set_functions`` there."""
    order, sign = int(course.watch[row.START_ORDER, place]), sign_of(engine, which)
    value, slope = growth_of(regime, course, regime.signals[row_of(engine, which)], order, tau)
    return course.watch[row.AT, place] + sign * tau * value, sign * slope


@kernel
def growth_of(regime: Regime, course: Course, weights: Array, m: int, tau: float) -> tuple[float, float]:
    """(p(τ) − p(0))/τ and p'(τ) of a signal with these weights that starts with a root of order m, or none."""
    flow, phi, b, numbers = course.flow, course.phi, regime.blocks, course.numbers
    value, slope, at, n = 0.0, 0.0, row.Y + 2 * (m + 1), course.flow.shape[1]
    for k in range(n):
        r0, r1 = weights[2 * k], weights[2 * k + 1]
        a0, a1 = r0 * b[layout.A11, k] + r1 * b[layout.A21, k], r0 * b[layout.A12, k] + r1 * b[layout.A22, k]
        x, y = r0 * flow[at, k] + r1 * flow[at + 1, k], a0 * flow[at, k] + a1 * flow[at + 1, k]
        p, q = phi[2 * m + 2, k], phi[2 * m + 3, k]
        value += p * x + q * y
        slope += (phi[2 * m, k] - m * p) * x + (phi[2 * m + 1, k] - m * q) * y
        x, y = r0 * b[layout.LOAD1, k] + r1 * b[layout.LOAD2, k], a0 * b[layout.LOAD1, k] + a1 * b[layout.LOAD2, k]
        power = 1.0
        for i in range(1, 4 - m):
            power *= tau
            u = power * numbers[row.U + m + i]
            p, q = phi[2 * (m + i) + 2, k], phi[2 * (m + i) + 3, k]
            value += u * (p * x + q * y)
            slope += u * ((phi[2 * (m + i), k] - m * p) * x + (phi[2 * (m + i) + 1, k] - m * q) * y)
    share, power = weights[2 * n + 1], 1.0
    for i in range(1, 4 - m):
        value += share * numbers[row.U + m + i] * power / factorial(m + i)
        slope += share * numbers[row.U + m + i] * power * i / factorial(m + i)
        power *= tau
    return value, slope


@kernel
def find_root(engine: ContactEngine, regime: Regime, course: Course, place: int, which: int, bracket: float) -> float:
    """The one root of a signal's p in (0, bracket]: Newton's method in a bracket, from the cubic through the ends."""
    low, high, watch = 0.0, bracket, course.watch
    t = bracket
    if watch[row.LAST, place] < 0.0 < watch[row.AT, place]:
        t = bracket * watch[row.AT, place] / (watch[row.AT, place] - watch[row.LAST, place])
    for _ in range(ROUNDS):
        set_functions(regime, course, t)
        value, slope = evaluate(engine, regime, course, place, which, t)
        if value == 0.0:
            break
        if value > 0.0:
            low = t
        else:
            high = t
        step = -value / slope if slope < 0.0 else 2.0 * bracket
        if not low < t + step < high:
            step = 0.5 * (low + high) - t
        if abs(step) <= EPSILON * t or high - low <= EPSILON * high:
            break
        t += step
    return t


@kernel
def find_turn(
    engine: ContactEngine, regime: Regime, course: Course, place: int, which: int, h: float
) -> tuple[float, float]:
    """(where, p) of the one minimum of a convex panel, or of the first point found where p ≤ 0."""
    low, high, where, value = 0.0, h, h, 1.0
    down, up = course.watch[row.SLOPE, place], course.watch[row.LAST_SLOPE, place]
    if down >= 0.0:
        return h, 1.0
    for i in range(ROUNDS):
        where = low + (high - low) * (0.5 if i % 3 == 2 else min(max(down / (down - up), 1e-3), 0.999))
        set_functions(regime, course, where)
        value, slope = evaluate(engine, regime, course, place, which, where)
        if value <= 0.0 or slope == 0.0 or high - low <= CLOSE * h:
            break
        if slope < 0.0:
            low, down = where, slope
        else:
            high, up = where, slope
    return where, value
