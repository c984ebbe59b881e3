"""What is read off the segments of a steady point in regimes: extremes, energies, time in contact."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.block_energy import energy_by_mode, energy_in_blocks, is_modal
from vibeam.flight.kernels.block_flow import set_signal, to_block_coordinates
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.extremes import ACCURACY, LIGHTLY, extremes_to
from vibeam.flight.kernels.layout import Regime, Watch
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.kernels.regimes.contact_integration import (
    MOST_STEPS,
    add_energy_of_step,
    first_step,
    load,
    plain,
    step,
    take,
    watch_step,
)
from vibeam.flight.kernels.regimes.events import at_side
from vibeam.flight.kernels.regimes.layout import RegimeEngine
from vibeam.flight.kernels.roots.signal import signal_of

Array = NDArray[np.float64]

FINEST = 1e-6  # share of a segment of integrated contact below which a step is taken as it is


@kernel
def read_segment(engine: RegimeEngine, watch: Watch, i: int) -> None:
    """Read off the i-th segment just traced, from its first pose in ``watch.frame``."""
    segment = watch.trace[i]
    clock, duration, what = segment[layout.AT_CLOCK], segment[layout.DURATION], segment[layout.WHAT]
    side = int(segment[regime_layout.AT_SIDE])
    if what == regime_layout.CONTACT and engine.law[regime_layout.FAMILY] == regime_layout.CURVED:
        read_integrated(engine, watch, watch.frame, clock, duration, side)
    elif what == layout.FREE:
        read_regime(engine, engine.free, watch, watch.frame, clock, duration)
    else:
        read_regime(engine, at_side(engine, side), watch, watch.frame, clock, duration)


@kernel
def read_regime(engine: RegimeEngine, regime: Regime, watch: Watch, pose: Array, clock: float, duration: float) -> None:
    """One segment in closed form."""
    result, coarsest, gap = watch.result, int(engine.drive[layout.COARSEST]), engine.gaps[0]
    share = ACCURACY if watch.reading >= layout.EVERYTHING else LIGHTLY
    to_block_coordinates(regime, engine.drive, pose, clock)
    if watch.reading >= layout.REACH_TOO:
        set_signal(regime, engine.drive, layout.GAP_SIGNAL, 1.0, clock)
        _, widest = extremes_to(
            signal_of(regime),
            duration,
            coarsest,
            gap - result[layout.CONTACT_LEAST],
            gap - result[layout.CONTACT_LEAST],
            share,
        )
        result[layout.CONTACT_LEAST] = gap - widest
    set_signal(regime, engine.drive, layout.OUTPUT_SIGNAL, 1.0, clock)
    result[layout.LEAST], result[layout.HIGH] = extremes_to(
        signal_of(regime), duration, coarsest, result[layout.LEAST], result[layout.HIGH], share
    )
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
            h *= max(0.2, 0.9 * wrong**-0.125) if np.isfinite(wrong) else 0.1
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
        h *= min(5.0, 0.9 * wrong**-0.125) if wrong > 0.0 else 5.0
    if done < duration:
        result[layout.HIGH] = np.inf
