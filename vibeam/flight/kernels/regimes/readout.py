"""Readout of a steady point's segments in regimes: extremes, energies, time in contact; poses in integrated contact."""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.block_energy import energy_by_mode, energy_in_blocks, is_modal
from vibeam.flight.kernels.block_flow import set_signal, to_block_coordinates
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.layout import Regime, Watch
from vibeam.flight.kernels.readout import ACCURACY, LIGHTLY, extremes_to, widen_output
from vibeam.flight.kernels.regimes import layout as row
from vibeam.flight.kernels.regimes.contact_integration import BEGIN, first_step, load, step, store, take
from vibeam.flight.kernels.regimes.events import regime_of
from vibeam.flight.kernels.regimes.integrated import carrying_kernel, span_kernel
from vibeam.flight.kernels.regimes.layout import RegimeEngine
from vibeam.flight.kernels.roots.signal import signal_of
from vibeam_models.arrays import Array


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
def read(engine: RegimeEngine, row: Array, place: int, stage: int) -> tuple[float, float, float]:
    """row·η, its rate and curvature at state[place], whose rate is stages[stage]."""
    n, value, rate, bend = row.shape[0], 0.0, 0.0, 0.0
    for k in range(n):
        value += row[k] * engine.state[place, k]
        rate += row[k] * engine.state[place, n + k]
        bend += row[k] * engine.stages[stage, n + k]
    return value, rate, bend


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


carry_on = carrying_kernel(first_step, step, take)
read_span = span_kernel(first_step, step, take, read, add_energy_of_step)


@kernel
def integrated_at(engine: RegimeEngine, pose: Array, side: int, clock: float, duration: float) -> None:
    """Set ``pose`` to ``duration`` later in contact, wherever that ends."""
    load(engine, pose)
    carry_on(engine, side, clock, duration)
    store(engine, pose)


@kernel
def read_segment(engine: RegimeEngine, watch: Watch, i: int) -> None:
    """Read off the i-th segment just traced, from its first pose in ``watch.frame``."""
    segment = watch.trace[i]
    clock, duration, what = segment[layout.AT_CLOCK], segment[layout.DURATION], segment[layout.WHAT]
    side = int(segment[row.AT_SIDE])
    if what == row.CONTACT and engine.law[row.FAMILY] == row.CURVED:
        load(engine, watch.frame)
        read_span(engine, side, watch, engine.contact[0], clock, duration)
    else:
        read_regime(engine, regime_of(engine, what, side), watch, watch.frame, clock, duration)
