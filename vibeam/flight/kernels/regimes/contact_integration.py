"""Contact with a stop that is not linear, F = max(0, k d^p (1 + a d′)) for d > 0: integrated by DOP853.

The only motion here that is not a closed form, and only while the stop is touched. Its end is where d returns to 0; the
last step is shortened by Newton's method, each time a full step of order 8, until it ends there to round-off. Where an
output (``readout``) or the force is largest within a step is found in the same way.
"""

from __future__ import annotations

from collections.abc import Callable
from math import sin, sqrt
from typing import Any

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.regimes import layout as row
from vibeam.flight.kernels.regimes.laws import force, force_rate
from vibeam.flight.kernels.regimes.layout import RegimeEngine
from vibeam_models.arrays import Array

TOLERANCE = 1e-12  # of a step's error, as a share of the motion's size in the energy norm
EPSILON = 2.220446049250313e-16
BATCH = 64  # steps that make a segment
MOST_STEPS = 100_000  # for one segment, whatever its steps come to
ROUNDS = 24
NEWTON = 60  # steps of Newton's method or bisection to a root
BEGIN, END, STAGE = range(3)  # rows of engine.state
Kernel = Callable[..., Any]


@kernel
def depth(engine: RegimeEngine, y: Array, side: int) -> tuple[float, float]:
    """d and d'."""
    n = engine.contact.shape[1]
    value, rate = -engine.gaps[side], 0.0
    for k in range(n):
        value += engine.contact[side, k] * y[k]
        rate += engine.contact[side, k] * y[n + k]
    return value, rate


@kernel
def rate_of(engine: RegimeEngine, y: Array, side: int, time: float, out: Array) -> None:
    """dy/dt of y = (η, η') into ``out``."""
    n = engine.contact.shape[1]
    value, rate = depth(engine, y, side)
    pressed, base = force(engine.law, value, rate), engine.drive[layout.STRENGTH] * sin(engine.drive[layout.W] * time)
    for k in range(n):
        pull = engine.load[k] * base + engine.static[k] - engine.spring[k] * y[k] - engine.contact[side, k] * pressed
        if engine.law[row.COUPLED] > 0.0:
            for j in range(n):
                pull -= engine.damper[k, j] * y[n + j]
        else:
            pull -= engine.damping[k] * y[n + k]
        out[k], out[n + k] = y[n + k], pull


@kernel
def step(engine: RegimeEngine, side: int, time: float, h: float) -> float:
    """One step from state[BEGIN] to state[END]; its error over what is allowed."""
    state, stages, nodes, width = engine.state, engine.stages, engine.nodes, engine.state.shape[1]
    for s in range(12):
        for i in range(width):
            total = 0.0
            for j in range(s):
                total += nodes[s, j] * stages[j, i]
            state[STAGE, i] = state[BEGIN, i] + h * total
        rate_of(engine, state[STAGE], side, time + nodes[13, s] * h, stages[s])
    for i in range(width):
        total = 0.0
        for j in range(12):
            total += nodes[12, j] * stages[j, i]
        state[END, i] = state[BEGIN, i] + h * total
    rate_of(engine, state[END], side, time + h, stages[12])
    return error(engine, side, h)


@kernel
def error(engine: RegimeEngine, side: int, h: float) -> float:
    """|h| e₅² / √(e₅² + e₃²/100) in the norm of the energy, the stop's included, over the tolerance."""
    n, state = engine.contact.shape[1], engine.state
    third, fifth = 0.0, 0.0
    begin, _ = depth(engine, state[BEGIN], side)
    end, _ = depth(engine, state[END], side)
    power = engine.law[row.EXPONENT] + 1.0
    size = 2.0 * engine.law[row.STIFFNESS] * max(begin, end, 0.0) ** power / power
    for k in range(n):
        for half in range(2):
            i = half * n + k
            weight = 1.0 if half == 1 else engine.spring[k] + 1.0 / (h * h)
            e3, e5 = 0.0, 0.0
            for s in range(13):
                e3 += engine.weights[0, s] * engine.stages[s, i]
                e5 += engine.weights[1, s] * engine.stages[s, i]
            third += weight * e3 * e3
            fifth += weight * e5 * e5
            if half == 1:
                size += max(state[BEGIN, i] ** 2, state[END, i] ** 2)
            else:
                size += engine.spring[k] * max(state[BEGIN, i] ** 2, state[END, i] ** 2)
    if not np.isfinite(fifth + third + size):
        return np.inf
    if fifth == 0.0 or size == 0.0:
        return 0.0
    return float(h * fifth / sqrt((fifth + 0.01 * third) * size) / TOLERANCE)


@kernel
def load(engine: RegimeEngine, pose: Array) -> None:
    """state[BEGIN] from ``pose``."""
    n = pose.shape[1]
    for k in range(n):
        engine.state[BEGIN, k], engine.state[BEGIN, n + k] = pose[0, k], pose[1, k]


@kernel
def store(engine: RegimeEngine, pose: Array) -> None:
    """``pose`` from state[BEGIN]."""
    n = pose.shape[1]
    for k in range(n):
        pose[0, k], pose[1, k] = engine.state[BEGIN, k], engine.state[BEGIN, n + k]


@kernel
def take(engine: RegimeEngine) -> None:
    """state[BEGIN] becomes state[END]."""
    for i in range(engine.state.shape[1]):
        engine.state[BEGIN, i] = engine.state[END, i]


@kernel
def first_step(engine: RegimeEngine, side: int) -> float:
    """A hundredth of about how long the contact lasts: m d'' = −k d^p from d' = v, m = 1/S."""
    value, rate = depth(engine, engine.state[BEGIN], side)
    power = engine.law[row.EXPONENT] + 1.0
    own = engine.law[row.STIFFNESS] * engine.law[row.MOBILITY]
    energy = rate * rate / 2.0 + own * max(value, 0.0) ** power / power
    if energy == 0.0:
        return 1e-3 / sqrt(own)
    return float(1e-2 * (power * energy / own) ** (1.0 / power) / sqrt(2.0 * energy))


@kernel
def next_step(h: float, wrong: float) -> float:
    """The step to try after one of h whose error was ``wrong`` times what is allowed."""
    if wrong > 1.0:
        return h * (max(0.2, 0.9 * wrong**-0.125) if np.isfinite(wrong) else 0.1)
    return h * (min(5.0, 0.9 * wrong**-0.125) if wrong > 0.0 else 5.0)


@kernel
def growth(engine: RegimeEngine, side: int, place: int, stage: int) -> tuple[float, float]:
    """F and dF/dt at state[place], whose rate is stages[stage]."""
    value, rate = depth(engine, engine.state[place], side)
    pressed, second, n = force(engine.law, value, rate), 0.0, engine.contact.shape[1]
    if pressed == 0.0:
        return 0.0, 0.0
    for k in range(n):
        second += engine.contact[side, k] * engine.stages[stage, n + k]
    return pressed, force_rate(engine.law, value, rate, second)


@kernel
def depth_at(engine: RegimeEngine, side: int, which: int, place: int, time: float) -> tuple[float, float]:
    """d and d' at state[place]."""
    return depth(engine, engine.state[place], side)


@kernel
def dips(first: float, rise: float, last: float, fall: float, h: float) -> bool:
    """True where the cubic through values and rates at the step's ends goes below 0 between them."""
    if not (rise < 0.0 < fall):
        return False
    a, b = 2.0 * (first - last) + h * (rise + fall), 3.0 * (last - first) - h * (2.0 * rise + fall)
    root = sqrt(max(b * b - 3.0 * a * h * rise, 0.0))
    u = -h * rise / (b + root) if b + root > 0.0 else 0.5
    return first + u * (h * rise + u * (b + u * a)) < 0.0


def peak_kernel(step: Kernel, growth: Kernel) -> Kernel:
    """The kernel of the largest force in a step, of an engine with these two."""

    @kernel
    def peak_of(engine: Any, at: Any, j: int, time: float, h: float) -> float:
        """The largest force of contact j over the step just made; where it turns inside, at its top."""
        first, rising = growth(engine, j, BEGIN, 0)
        last, falling = growth(engine, j, END, 12)
        most = max(first, last)
        if not (rising > 0.0 and (falling < 0.0 or last == 0.0)):
            return float(most)
        low, high = 0.0, h
        for i in range(ROUNDS):
            t = 0.5 * (low + high)
            if i % 3 > 0 and last > 0.0:
                t = low + (high - low) * min(max(rising / (rising - falling), 0.01), 0.99)
            step(engine, at, time, t)
            value, slope = growth(engine, j, END, 12)
            most = max(most, value)
            if abs(slope) * (high - low) <= EPSILON * value:
                break
            if slope > 0.0:
                low, rising = t, slope
            else:
                high, falling, last = t, slope, value
        step(engine, at, time, h)
        return float(most)

    return peak_of


def root_kernel(step: Kernel, signal_at: Kernel) -> Kernel:
    """The kernel of a signal's root in a step, of an engine with these two."""

    @kernel
    def root_of(engine: Any, at: Any, which: int, time: float, h: float) -> float:
        """The step, at most h, at whose end the signal is 0; the step just made is of that length then."""
        low, high, t = 0.0, h, h
        for _ in range(NEWTON):
            value, rate = signal_at(engine, at, which, END, time + t)
            if value > 0.0:
                low = t
            else:
                high = t
            nearer = t - value / rate if rate < 0.0 else 0.5 * (low + high)
            if not low < nearer < high:
                nearer = 0.5 * (low + high)
            change, t = abs(nearer - t), nearer
            step(engine, at, time, t)
            if change <= 4.0 * EPSILON * h or high - low <= 4.0 * EPSILON * h:
                break
        return t

    return root_of


peak_of, root_of = peak_kernel(step, growth), root_kernel(step, depth_at)


@kernel
def integrate_contact(
    engine: RegimeEngine, pose: Array, status: Array, side: int, clock: float, span: float, traced: bool
) -> tuple[bool, float, int]:
    """On from ``pose`` until d returns to 0, for ``span`` or for ``BATCH`` steps: (whether it did, time, steps).

    status[STEPPED] holds the step to try, 0 where there is none yet; infinite time where the step underflows. Where it
    is ``traced``, status[PEAKED] receives the largest force. A start at d = 0 without velocity is no end.
    """
    load(engine, pose)
    value, rate = depth(engine, engine.state[BEGIN], side)
    if value <= 0.0 and rate < 0.0:
        status[row.PEAKED] = 0.0
        return True, 0.0, 0
    h = status[row.STEPPED] if status[row.STEPPED] > 0.0 else first_step(engine, side)
    done, steps, status[row.PEAKED] = 0.0, 0, 0.0
    while steps < BATCH and done < span:
        h = min(h, span - done)
        if not h > 0.0 or (clock + done + h * 1e-3 == clock + done and h < 1e-300):
            return False, np.inf, steps
        wrong = step(engine, side, clock + done, h)
        steps += 1
        if wrong > 1.0:
            h = next_step(h, wrong)
            continue
        value, rate = depth(engine, engine.state[END], side)
        if traced:
            status[row.PEAKED] = max(status[row.PEAKED], peak_of(engine, side, side, clock + done, h))
        if value <= 0.0 and rate < 0.0:
            h = root_of(engine, side, 0, clock + done, h)
            take(engine)
            store(engine, pose)
            return True, done + h, steps
        first, rise = depth(engine, engine.state[BEGIN], side)
        if dips(first, rise, value, rate, h):
            h *= 0.5
            continue
        done += h
        take(engine)
        if done < span:
            h = next_step(h, wrong)
    status[row.STEPPED] = h
    store(engine, pose)
    return False, done, steps
