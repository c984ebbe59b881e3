"""Segments of contacts that are integrated, integrated anew: poses in them, extremes, energies."""

from __future__ import annotations

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.contacts import layout as row
from vibeam.flight.kernels.contacts.integration import BEGIN, END, begin, first_step, step
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.contacts.reactions import each
from vibeam.flight.kernels.layout import Watch
from vibeam.flight.kernels.readout import hull
from vibeam.flight.kernels.regimes.contact_integration import EPSILON, MOST_STEPS, ROUNDS, next_step
from vibeam.flight.kernels.regimes.readout import FINEST
from vibeam.flight.kernels.roots.bounds import PanelEnds
from vibeam.flight.kernels.segments import copy_pose
from vibeam_models.arrays import Array


@kernel
def enter_segment(engine: ContactEngine, pose: Array, segment: Array) -> None:
    """Set ``engine.trial`` as the status at the start of a traced segment; state[BEGIN] is its first pose."""
    status = engine.trial
    status[layout.CLOCK], status[row.HELD] = segment[layout.AT_CLOCK], segment[row.HELD_AT]
    status[row.PIECE] = segment[row.PIECE_AT]
    for j in range(engine.rows.shape[0]):
        pushed = (int(segment[row.PUSHED_AT]) >> j) & 1 > 0
        status[each(engine, row.CONDITION, j)] = row.PUSHING if pushed else row.AWAY
    begin(engine, pose, status)


@kernel
def integrated_at(engine: ContactEngine, pose: Array, segment: Array, duration: float) -> None:
    """Set ``pose`` to ``duration`` later in a segment."""
    enter_segment(engine, pose, segment)
    status = engine.trial
    clock, h, done, steps = segment[layout.AT_CLOCK], first_step(engine, status), 0.0, 0
    while done < duration and steps < MOST_STEPS:
        h = min(h, duration - done)
        steps += 1
        wrong = step(engine, status, clock + done, h)
        if wrong > 1.0:
            h = next_step(h, wrong)
            if h < 1e-300:
                break
            continue
        copy_pose(engine.state[END], engine.state[BEGIN])
        done = done + h if h < duration - done else duration
        h = next_step(h, wrong)
    copy_pose(engine.state[BEGIN], pose)


@kernel
def read_integrated(engine: ContactEngine, watch: Watch, segment: Array) -> None:
    """Extremes to round-off, energies by the steps' quadrature, of a segment from its first pose in ``watch.frame``."""
    enter_segment(engine, watch.frame, segment)
    status, result, contact = engine.trial, watch.result, engine.rows[0]
    clock, duration, reach = segment[layout.AT_CLOCK], segment[layout.DURATION], watch.reading >= layout.REACH_TOO
    h, done, steps = first_step(engine, status), 0.0, 0
    while done < duration and steps < MOST_STEPS:
        h, steps = min(h, duration - done), steps + 1
        wrong = step(engine, status, clock + done, h)
        if wrong > 1.0:
            h = next_step(h, wrong)
            continue
        if h > FINEST * duration and not (
            plain(engine, watch.row, h, result[layout.LEAST], result[layout.HIGH])
            and (not reach or plain(engine, contact, h, result[layout.CONTACT_LEAST], np.inf))
        ):
            h *= 0.5
            continue
        if watch.reading >= layout.EVERYTHING:
            add_energy_of_step(engine, h, watch.energy)
        least, most = watch_step(engine, status, watch.row, clock + done, h)
        result[layout.LEAST], result[layout.HIGH] = min(result[layout.LEAST], least), max(result[layout.HIGH], most)
        if reach:
            least, _ = watch_step(engine, status, contact, clock + done, h)
            result[layout.CONTACT_LEAST] = min(result[layout.CONTACT_LEAST], least)
        copy_pose(engine.state[END], engine.state[BEGIN])
        done = done + h if h < duration - done else duration
        h = next_step(h, wrong)
    if done < duration:
        result[layout.HIGH] = np.inf


@kernel
def read(engine: ContactEngine, wanted: Array, place: int, stage: int) -> tuple[float, float, float]:
    """row·η, its rate and curvature at state[place], whose rate is stages[stage]."""
    value, rate, bend = 0.0, 0.0, 0.0
    for k in range(wanted.shape[0]):
        value += wanted[k] * engine.state[place, 0, k]
        rate += wanted[k] * engine.state[place, 1, k]
        bend += wanted[k] * engine.stages[stage, 1, k]
    return value, rate, bend


@kernel
def watch_step(engine: ContactEngine, status: Array, wanted: Array, time: float, h: float) -> tuple[float, float]:
    """(least, most) of row·η over the step just made, which must be ``plain`` for that row.

    Where its rate changes sign the step is shortened by Newton's method until the rate vanishes at its end; then it is
    made anew as it was.
    """
    first, rate, _ = read(engine, wanted, BEGIN, 0)
    end, last, _ = read(engine, wanted, END, 12)
    least, most = min(first, end), max(first, end)
    if rate * last >= 0.0:
        return least, most
    low, high, t = 0.0, h, h * rate / (rate - last)
    for _ in range(ROUNDS):
        step(engine, status, time, t)
        value, slope, bend = read(engine, wanted, END, 12)
        least, most = min(least, value), max(most, value)
        if slope * slope <= EPSILON * abs(bend * value) or high - low <= EPSILON * h:
            break
        if (slope > 0.0) == (rate > 0.0):
            low = t
        else:
            high = t
        t = t - slope / bend if bend != 0.0 else 0.5 * (low + high)
        if not low < t < high:
            t = 0.5 * (low + high)
    step(engine, status, time, h)
    return least, most


@kernel
def plain(engine: ContactEngine, wanted: Array, h: float, least: float, most: float) -> bool:
    """True where the rate of row·η changes sign at most once over the step just made, or that matters nothing.

    As ``regimes.readout.plain``: by the signs of the Bernstein coefficients of its cubic Hermite interpolant.
    """
    p0, s0, c0 = read(engine, wanted, BEGIN, 0)
    p1, s1, c1 = read(engine, wanted, END, 12)
    low, high = hull(PanelEnds(p0, s0, p1, s1), h)
    margin = 0.25 * (high - low)
    if low - margin >= least and high + margin <= most:
        return True
    b1, b2 = s0 + h * c0 / 3.0, s1 - h * c1 / 3.0
    changes = (1 if s0 * b1 < 0.0 else 0) + (1 if b1 * b2 < 0.0 else 0) + (1 if b2 * s1 < 0.0 else 0)
    return changes <= 1


@kernel
def add_energy_of_step(engine: ContactEngine, h: float, energy: Array) -> None:
    """Add ∫ ½(η'² + ω²η²) dt of every mode over the step just made, by its own quadrature of order 8."""
    for k in range(energy.shape[0]):
        total = 0.0
        for s in range(12):
            x, y = engine.state[BEGIN, 0, k], engine.stages[s, 0, k]
            for j in range(s):
                x += h * engine.nodes[s, j] * engine.stages[j, 0, k]
            total += engine.nodes[12, s] * (y * y + engine.spring[k] * x * x)
        energy[k] += 0.5 * h * total
