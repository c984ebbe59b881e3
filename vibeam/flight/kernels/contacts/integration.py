"""Contact with stops that are not linear, integrated by DOP853: all contacts that push together, the others watched.

The steps, their error and its norm are those of ``regimes.contact_integration``; contacts that are held take their
reactions out of every stage. A step at whose end a signal is not positive is shortened by Newton's method, each time a
full step of order 8, until it ends at the first root to round-off.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.contacts import layout as row
from vibeam.flight.kernels.contacts.algebra import along, factor, invert, multiplier, without_rows
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.contacts.reactions import clearance, depth, each, hold, is_curved, pull, push_of, push_rate
from vibeam.flight.kernels.contacts.signals import BACK, FORCE, GAP, OUT, list_signals
from vibeam.flight.kernels.contacts.strikes import put, some_of, stop
from vibeam.flight.kernels.regimes import layout as regime_row
from vibeam.flight.kernels.regimes.contact_integration import (
    BATCH,
    BEGIN,
    END,
    STAGE,
    TOLERANCE,
    dips,
    next_step,
    peak_kernel,
    root_kernel,
)
from vibeam.flight.kernels.segments import copy_pose
from vibeam_models.arrays import Array

DOUBT = 16.0  # times the largest gap that is none: by how much a signal that stays at zero may be below it


@kernel
def is_integrated(engine: ContactEngine, pushed: float) -> bool:
    """True where one of the contacts pushed is no linear stop."""
    found = False
    for j in range(engine.rows.shape[0]):
        found = found or ((int(pushed) >> j) & 1 > 0 and is_curved(engine, j))
    return found


@kernel
def begin(engine: ContactEngine, pose: Array, status: Array) -> None:
    """state[BEGIN] from ``pose``; the contacts held listed, their Gram matrix factored."""
    copy_pose(pose, engine.state[BEGIN])
    count = some_of(engine, int(status[row.HELD]), engine.picks[row.STILL])
    factor(engine.gram, engine.picks[row.STILL], count, engine.lower)
    invert(engine, count)
    status[row.KEPT_NUMBER] = count


@kernel
def rate_of(engine: ContactEngine, y: Array, status: Array, time: float, out: Array) -> None:
    """dy/dt of y = (η, η') into ``out`` (2, n)."""
    clock, status[layout.CLOCK] = status[layout.CLOCK], time
    pull(engine, y, status)
    status[layout.CLOCK] = clock
    count = int(status[row.KEPT_NUMBER])
    without_rows(engine, engine.picks[row.STILL], count, engine.vectors[row.PULL], out[1])
    for k in range(y.shape[1]):
        out[0, k] = y[1, k]


@kernel
def step(engine: ContactEngine, status: Array, time: float, h: float) -> float:
    """One step from state[BEGIN] to state[END]; its error over what is allowed."""
    state, stages, nodes = engine.state, engine.stages, engine.nodes
    for s in range(12):
        for half in range(2):
            for k in range(state.shape[2]):
                total = 0.0
                for j in range(s):
                    total += nodes[s, j] * stages[j, half, k]
                state[STAGE, half, k] = state[BEGIN, half, k] + h * total
        rate_of(engine, state[STAGE], status, time + nodes[13, s] * h, stages[s])
    for half in range(2):
        for k in range(state.shape[2]):
            total = 0.0
            for j in range(12):
                total += nodes[12, j] * stages[j, half, k]
            state[END, half, k] = state[BEGIN, half, k] + h * total
    rate_of(engine, state[END], status, time + h, stages[12])
    return error(engine, status, h)


@kernel
def error(engine: ContactEngine, status: Array, h: float) -> float:
    """|h| e₅² / √(e₅² + e₃²/100) in the norm of the energy, the stops' included, over the tolerance."""
    state, third, fifth, size = engine.state, 0.0, 0.0, 0.0
    for j in range(engine.rows.shape[0]):
        if status[each(engine, row.CONDITION, j)] == row.PUSHING:
            deep = max(depth(engine, state[BEGIN], j), depth(engine, state[END], j), 0.0)
            power = engine.laws[j, regime_row.EXPONENT] + 1.0 if is_curved(engine, j) else 2.0
            size += 2.0 * engine.laws[j, regime_row.STIFFNESS] * deep**power / power
    for k in range(state.shape[2]):
        for half in range(2):
            weight = 1.0 if half == 1 else engine.spring[k] + 1.0 / (h * h)
            e3, e5 = 0.0, 0.0
            for s in range(13):
                e3 += engine.weights[0, s] * engine.stages[s, half, k]
                e5 += engine.weights[1, s] * engine.stages[s, half, k]
            third += weight * e3 * e3
            fifth += weight * e5 * e5
            most = max(state[BEGIN, half, k] ** 2, state[END, half, k] ** 2)
            size += most if half == 1 else engine.spring[k] * most
    if not np.isfinite(fifth + third + size):
        return np.inf
    if fifth == 0.0 or size == 0.0:
        return 0.0
    return float(h * fifth / sqrt((fifth + 0.01 * third) * size) / TOLERANCE)


@kernel
def first_step(engine: ContactEngine, status: Array) -> float:
    """A hundredth of about how long the shortest contact lasts: m d'' = −k d^p from d' = v, m = 1/S."""
    shortest, y = np.inf, engine.state[BEGIN]
    for j in range(engine.rows.shape[0]):
        if status[each(engine, row.CONDITION, j)] == row.PUSHING and is_curved(engine, j):
            rate, power = along(engine.rows, j, y[1]), engine.laws[j, regime_row.EXPONENT] + 1.0
            own = engine.laws[j, regime_row.STIFFNESS] * engine.gram[j, j]
            energy = rate * rate / 2.0 + own * max(depth(engine, y, j), 0.0) ** power / power
            long = 0.1 / sqrt(own)
            if energy > 0.0:
                long = (power * energy / own) ** (1.0 / power) / sqrt(2.0 * energy)
            shortest = min(shortest, 1e-2 * long)
    return float(shortest)


@kernel
def signal_at(engine: ContactEngine, status: Array, which: int, place: int, time: float) -> tuple[float, float]:
    """A signal and its rate at state[place], BEGIN or END of the step just made; of a curved stop how deep it is."""
    k, y, acceleration = engine.rows.shape[0], engine.state[place], engine.stages[0 if place == BEGIN else 12, 1]
    j, kind = which % k, which // k
    if kind in (GAP, OUT) or is_curved(engine, j):
        sign = -1.0 if kind == GAP else 1.0
        return sign * depth(engine, y, j), sign * along(engine.rows, j, y[1])
    if status[each(engine, row.CONDITION, j)] != row.KEPT:
        sign = -1.0 if kind == BACK else 1.0
        return sign * push_of(engine, y, j), sign * push_rate(engine, y, j, along(engine.rows, j, acceleration))
    clock, status[layout.CLOCK] = status[layout.CLOCK], time
    picks, count, at = engine.picks[row.STILL], int(status[row.KEPT_NUMBER]), 0
    pull(engine, y, status)
    hold(engine, y, status, picks, count)
    status[layout.CLOCK] = clock
    while at < count - 1 and picks[at] != j:
        at += 1
    value = multiplier(engine, picks, count, at, engine.vectors[row.PULL])
    return value, multiplier(engine, picks, count, at, engine.vectors[row.RATE])


@kernel
def is_crossed(engine: ContactEngine, status: Array, which: int, value: float, rate: float) -> bool:
    """True where a signal is not positive any more."""
    j = which % engine.rows.shape[0]
    if status[each(engine, row.ORDER, j)] == regime_row.TOUCHING:
        _, least = clearance(engine, engine.state[END], j)
        if which // engine.rows.shape[0] == FORCE and not is_curved(engine, j):
            least *= engine.laws[j, regime_row.STIFFNESS]
        return value < -DOUBT * least and rate < 0.0
    return value < 0.0 or (value == 0.0 and rate < 0.0)


@kernel
def store(engine: ContactEngine, pose: Array, status: Array) -> None:
    """``pose`` from state[BEGIN], what is held exactly at its stops."""
    copy_pose(engine.state[BEGIN], pose)
    put(engine, pose, int(status[row.HELD]))
    stop(engine, pose, int(status[row.HELD]))


@kernel
def growth(engine: ContactEngine, j: int, place: int, stage: int) -> tuple[float, float]:
    """F and dF/dt at state[place], whose rate is stages[stage]."""
    y = engine.state[place]
    pressed = push_of(engine, y, j)
    if pressed == 0.0:
        return 0.0, 0.0
    return pressed, push_rate(engine, y, j, along(engine.rows, j, engine.stages[stage, 1]))


peak_of, root_of = peak_kernel(step, growth), root_kernel(step, signal_at)


@kernel
def note_peaks(engine: ContactEngine, status: Array, time: float, h: float) -> None:
    """status[PEAKED] over the step just made, by the force of every contact that pushes."""
    for j in range(engine.rows.shape[0]):
        if status[each(engine, row.CONDITION, j)] == row.PUSHING:
            status[regime_row.PEAKED] = max(status[regime_row.PEAKED], peak_of(engine, status, j, time, h))


@kernel
def take(engine: ContactEngine) -> None:
    """state[BEGIN] becomes state[END]."""
    copy_pose(engine.state[END], engine.state[BEGIN])


@kernel
def integrate(engine: ContactEngine, pose: Array, status: Array, span: float) -> tuple[int, float, int]:
    """On from ``pose`` until a signal vanishes, for ``span`` or for ``BATCH`` steps: whose it is, time, steps.

    status[STEPPED] holds the step to try, 0 where there is none yet, status[PEAKED] receives the largest force;
    infinite time where the step underflows.
    """
    begin(engine, pose, status)
    number, clock = list_signals(engine, status), status[layout.CLOCK]
    h = status[regime_row.STEPPED] if status[regime_row.STEPPED] > 0.0 else first_step(engine, status)
    done, steps, met, status[regime_row.PEAKED] = 0.0, 0, row.NONE, 0.0
    while steps < BATCH and done < span and met == row.NONE:
        h = min(h, span - done)
        if not h > 0.0 or (clock + done + h * 1e-3 == clock + done and h < 1e-300):
            return row.NONE, np.inf, steps
        wrong = step(engine, status, clock + done, h)
        steps += 1
        if wrong > 1.0:
            h = next_step(h, wrong)
            continue
        met, whole, halved = row.NONE, h, False
        for place in range(number):
            which = engine.watched[place]
            first, rise = signal_at(engine, status, which, BEGIN, clock + done)
            last, fall = signal_at(engine, status, which, END, clock + done + h)
            if is_crossed(engine, status, which, last, fall):
                if first <= 0.0 and rise < 0.0 and done == 0.0:
                    store(engine, pose, status)
                    return which, 0.0, steps
                met, h = which, root_of(engine, status, which, clock + done, h)
            elif dips(first, rise, last, fall, h) and first > 0.0:
                halved = True
        if halved and met == row.NONE:
            h *= 0.5
            continue
        if h < whole:
            step(engine, status, clock + done, h)
        note_peaks(engine, status, clock + done, h)
        done += h
        take(engine)
        if done < span:
            h = next_step(h, wrong)
    status[regime_row.STEPPED] = 0.0 if met != row.NONE else h
    store(engine, pose, status)
    return met, done, steps
