"""What is read off the segments of a steady point in regimes: extremes, energies, time in contact."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.block_energy import energy_by_mode, energy_in_blocks, is_modal
from vibeam.flight.kernels.block_flow import set_signal, to_block_coordinates
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.extremes import ACCURACY, LIGHTLY, extremes_to
from vibeam.flight.kernels.layout import (
    AT_CLOCK,
    COARSEST,
    CONTACT_LEAST,
    DURATION,
    EVERYTHING,
    FREE,
    GAP_SIGNAL,
    HIGH,
    LEAST,
    OUTPUT_SIGNAL,
    REACH_TOO,
    WHAT,
    Regime,
    Watch,
)
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
from vibeam.flight.kernels.regimes.layout import (
    AT_SIDE,
    CONTACT,
    CURVED,
    FAMILY,
    RegimeEngine,
)
from vibeam.flight.kernels.roots.signal import signal_of

Array = NDArray[np.float64]

FINEST = 1e-6  # share of a segment of integrated contact below which a step is taken as it is


@kernel
def read_segment(plan: RegimeEngine, room: Watch, i: int) -> None:
    """Read off the i-th segment just traced, from its first pose in ``room.frame``."""
    clock, duration, what, side = (
        room.trace[i, AT_CLOCK], room.trace[i, DURATION], room.trace[i, WHAT], int(room.trace[i, AT_SIDE])
    )  # fmt: skip
    if what == CONTACT and plan.law[FAMILY] == CURVED:
        read_integrated(plan, room, room.frame, clock, duration, side)
    elif what == FREE:
        read_regime(plan, plan.free, room, room.frame, clock, duration)
    else:
        read_regime(plan, at_side(plan, side), room, room.frame, clock, duration)


@kernel
def read_regime(plan: RegimeEngine, regime: Regime, room: Watch, pose: Array, clock: float, duration: float) -> None:
    """One segment in closed form."""
    result, coarsest, gap = room.result, int(plan.drive[COARSEST]), plan.gaps[0]
    share = ACCURACY if room.reading >= EVERYTHING else LIGHTLY
    to_block_coordinates(regime, plan.drive, pose, clock)
    if room.reading >= REACH_TOO:
        set_signal(regime, plan.drive, GAP_SIGNAL, 1.0, clock)
        _, widest = extremes_to(
            signal_of(regime), duration, coarsest, gap - result[CONTACT_LEAST], gap - result[CONTACT_LEAST], share
        )
        result[CONTACT_LEAST] = gap - widest
    set_signal(regime, plan.drive, OUTPUT_SIGNAL, 1.0, clock)
    result[LEAST], result[HIGH] = extremes_to(signal_of(regime), duration, coarsest, result[LEAST], result[HIGH], share)
    if room.reading >= EVERYTHING and is_modal(regime):
        energy_by_mode(regime, plan.drive, clock, duration, room.energy)
    elif room.reading >= EVERYTHING:
        energy_in_blocks(regime, plan.drive, plan.omega, clock, duration, room)


@kernel
def read_integrated(plan: RegimeEngine, room: Watch, pose: Array, clock: float, duration: float, side: int) -> None:
    """One segment of integrated contact, integrated anew: extremes to round-off, energies by the steps' quadrature."""
    load(plan, pose)
    result, contact, h, done, steps = room.result, plan.contact[0], first_step(plan, side), 0.0, 0
    while done < duration and steps < MOST_STEPS:
        h, steps = min(h, duration - done), steps + 1
        wrong = step(plan, side, clock + done, h)
        if wrong > 1.0:
            h *= max(0.2, 0.9 * wrong**-0.125) if np.isfinite(wrong) else 0.1
            continue
        if h > FINEST * duration and not (
            plain(plan, room.row, h, result[LEAST], result[HIGH])
            and (room.reading < REACH_TOO or plain(plan, contact, h, result[CONTACT_LEAST], np.inf))
        ):
            h *= 0.5
            continue
        if room.reading >= EVERYTHING:
            add_energy_of_step(plan, h, room.energy)
        result[LEAST], result[HIGH] = watch_step(plan, room.row, side, clock + done, h, result[LEAST], result[HIGH])
        if room.reading >= REACH_TOO:
            result[CONTACT_LEAST], _ = watch_step(plan, contact, side, clock + done, h, result[CONTACT_LEAST], np.inf)
        take(plan)
        done = done + h if h < duration - done else duration
        h *= min(5.0, 0.9 * wrong**-0.125) if wrong > 0.0 else 5.0
    if done < duration:
        result[HIGH] = np.inf
