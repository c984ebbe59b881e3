"""Readout of a steady point's segments in regimes: extremes, energies, time in contact; poses in integrated contact."""

from __future__ import annotations

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.block_energy import energy_by_mode, energy_in_blocks, is_modal
from vibeam.flight.kernels.block_flow import set_signal, to_block_coordinates
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.layout import Regime, Watch
from vibeam.flight.kernels.readout import ACCURACY, LIGHTLY, extremes_to, hull, widen_output
from vibeam.flight.kernels.regimes import layout as row
from vibeam.flight.kernels.regimes.contact_integration import (
    BEGIN,
    END,
    EPSILON,
    MOST_STEPS,
    ROUNDS,
    first_step,
    load,
    next_step,
    step,
    store,
    take,
)
from vibeam.flight.kernels.regimes.events import regime_of
from vibeam.flight.kernels.regimes.layout import RegimeEngine
from vibeam.flight.kernels.roots.bounds import PanelEnds
from vibeam.flight.kernels.roots.signal import signal_of
from vibeam_models.arrays import Array

FINEST = 1e-6  # share of a segment of integrated contact below which a step is taken as it is


@kernel
def read_segment(engine: RegimeEngine, watch: Watch, i: int) -> None:
    """Read off the i-th segment just traced, from its first pose in ``watch.frame``."""
    segment = watch.trace[i]
    clock, duration, what = segment[layout.AT_CLOCK], segment[layout.DURATION], segment[layout.WHAT]
    side = int(segment[row.AT_SIDE])
    if what == row.CONTACT and engine.law[row.FAMILY] == row.CURVED:
        read_integrated(engine, watch, watch.frame, clock, duration, side)
    else:
        read_regime(engine, regime_of(engine, what, side), watch, watch.frame, clock, duration)


@kernel
def read_regime(engine: RegimeEngine, regime: Regime, watch: Watch, pose: Array, clock: float, duration: float) -> None:
    """One segment in closed form."""
    result, coarsest, gap = watch.result, int(engine.drive[layout.COARSEST]), engine.gaps[0]
    share = ACCURACY if watch.reading >= layout.EVERYTHING else LIGHTLY
    to_block_coordinates(regime, engine.drive, pose, clock)
    if watch.reading >= layout.REACH_TOO:
        set_signal(regime, engine.drive, layout.GAP_SIGNAL, 1.0, clock)
        reached = gap - result[layout.CONTACT_LEAST]
        _, widest = extremes_to(signal_of(regime), duration, coarsest, reached, reached, share)
        result[layout.CONTACT_LEAST] = gap - widest
    set_signal(regime, engine.drive, layout.OUTPUT_SIGNAL, 1.0, clock)
    widen_output(signal_of(regime), duration, coarsest, result, share)
    if watch.reading >= layout.EVERYTHING and is_modal(regime):
        energy_by_mode(regime, engine.drive, clock, duration, watch.energy)
    elif watch.reading >= layout.EVERYTHING:
        energy_in_blocks(regime, engine.drive, engine.omega, clock, duration, watch)


@kernel
def read_integrated(engine: RegimeEngine, watch: Watch, pose: Array, clock: float, duration: float, side: int) -> None:
    """One segment of integrated contact, integrated anew: extremes to round-off, energies by the steps' quadrature."""
    load(engine, pose)
    result, contact, h, done, steps = watch.result, engine.contact[0], first_step(engine, side), 0.0, 0
    while done < duration and steps < MOST_STEPS:
        h, steps = min(h, duration - done), steps + 1
        wrong = step(engine, side, clock + done, h)
        if wrong > 1.0:
            h = next_step(h, wrong)
            continue
        if h > FINEST * duration and not (
            plain(engine, watch.row, h, result[layout.LEAST], result[layout.HIGH])
            and (watch.reading < layout.REACH_TOO or plain(engine, contact, h, result[layout.CONTACT_LEAST], np.inf))
        ):
            h *= 0.5
            continue
        if watch.reading >= layout.EVERYTHING:
            add_energy_of_step(engine, h, watch.energy)
        result[layout.LEAST], result[layout.HIGH] = watch_step(
            engine, watch.row, side, clock + done, h, result[layout.LEAST], result[layout.HIGH]
        )
        if watch.reading >= layout.REACH_TOO:
            result[layout.CONTACT_LEAST], _ = watch_step(
                engine, contact, side, clock + done, h, result[layout.CONTACT_LEAST], np.inf
            )
        take(engine)
        done = done + h if h < duration - done else duration
        h = next_step(h, wrong)
    if done < duration:
        result[layout.HIGH] = np.inf


@kernel
def watch_step(
    engine: RegimeEngine, row: Array, side: int, time: float, h: float, least: float, most: float
) -> tuple[float, float]:
    """(least, most) widened to row·η over the step just made, which must be ``plain`` for that row.

    Where its rate changes sign the step is shortened by Newton's method until the rate vanishes at its end; then it is
    made anew as it was.
    """
    begin, rate, _ = read(engine, row, BEGIN, 0)
    end, last, _ = read(engine, row, END, 12)
    least, most = min(least, min(begin, end)), max(most, max(begin, end))
    if rate * last >= 0.0:
        return least, most
    low, high, t = 0.0, h, h * rate / (rate - last)
    for _ in range(ROUNDS):
        step(engine, side, time, t)
        value, slope, bend = read(engine, row, END, 12)
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
    step(engine, side, time, h)
    return least, most


@kernel
def read(engine: RegimeEngine, row: Array, place: int, stage: int) -> tuple[float, float, float]:
    """row·η, its rate and curvature at state[place], whose rate is stages[stage]."""
    n, value, rate, bend = row.shape[0], 0.0, 0.0, 0.0
    for k in range(n):
        value += row[k] * engine.state[place, k]
        rate += row[k] * engine.state[place, n + k]
        bend += row[k] * engine.stages[stage, n + k]
    return value, rate, bend


@kernel
def plain(engine: RegimeEngine, row: Array, h: float, least: float, most: float) -> bool:
    """True where the rate of row·η changes sign at most once over the step just made, or that matters nothing.

    By the signs of the Bernstein coefficients of its cubic Hermite interpolant (Descartes); it matters nothing where
    the hull of row·η itself lies well within (least, most).
    """
    p0, s0, c0 = read(engine, row, BEGIN, 0)
    p1, s1, c1 = read(engine, row, END, 12)
    low, high = hull(PanelEnds(p0, s0, p1, s1), h)
    watch = 0.25 * (high - low)
    if low - watch >= least and high + watch <= most:
        return True
    b1, b2 = s0 + h * c0 / 3.0, s1 - h * c1 / 3.0
    changes = (1 if s0 * b1 < 0.0 else 0) + (1 if b1 * b2 < 0.0 else 0) + (1 if b2 * s1 < 0.0 else 0)
    return changes <= 1


@kernel
def add_energy_of_step(engine: RegimeEngine, h: float, energy: Array) -> None:
    """Add ∫ ½(η'² + ω²η²) dt of every mode over the step just made, by its own quadrature of order 8."""
    n = energy.shape[0]
    for k in range(n):
        total = 0.0
        for s in range(12):
            x, y = engine.state[BEGIN, k], engine.stages[s, k]
            for j in range(s):
                x += h * engine.nodes[s, j] * engine.stages[j, k]
            total += engine.nodes[12, s] * (y * y + engine.spring[k] * x * x)
        energy[k] += 0.5 * h * total


@kernel
def integrated_at(engine: RegimeEngine, pose: Array, side: int, clock: float, duration: float) -> None:
    """Set ``pose`` to ``duration`` later in contact, wherever that ends."""
    load(engine, pose)
    h, done, steps = first_step(engine, side), 0.0, 0
    while done < duration and steps < MOST_STEPS:
        h = min(h, duration - done)
        steps += 1
        wrong = step(engine, side, clock + done, h)
        if wrong > 1.0:
            h = next_step(h, wrong)
            if h < 1e-300:
                break
            continue
        take(engine)
        done = done + h if h < duration - done else duration
        h = next_step(h, wrong)
    store(engine, pose)
