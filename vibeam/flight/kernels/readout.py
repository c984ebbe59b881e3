"""What is read off the flights and rests of a steady point: extremes and energies."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.block_energy import energy_in_blocks
from vibeam.flight.kernels.block_flow import set_signal, to_block_coordinates
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.drive import phase
from vibeam.flight.kernels.energy import energy_in_flight
from vibeam.flight.kernels.extremes import ACCURACY, LIGHTLY, extremes_to
from vibeam.flight.kernels.layout import Engine, Watch
from vibeam.flight.kernels.modal_flow import begin_flight
from vibeam.flight.kernels.roots.signal import signal_of

Array = NDArray[np.float64]


@kernel
def begin_output(engine: Engine, row: Array, pose: Array, clock: float) -> None:
    """row·η in flight as the free signal; the attached pairs must be those of this flight (``begin_flight``)."""
    pairs, modes, signal, attached = engine.pairs, engine.modes, engine.signal, engine.attached
    cosine, sine = phase(engine.drive, clock)
    w = engine.drive[layout.W]
    const, re, im = 0.0, 0.0, 0.0
    for k in range(pairs.shape[1]):
        const += row[k] * modes[layout.OFFSET, k]
        re += row[k] * modes[layout.RE, k]
        im += row[k] * modes[layout.IM, k]
        own = modes[layout.OFFSET, k] + modes[layout.RE, k] * sine + modes[layout.IM, k] * cosine
        pairs[layout.X0, k] = row[k] * (pose[0, k] - own)
        pairs[layout.Y0, k] = row[k] * (pose[1, k] - w * (modes[layout.RE, k] * cosine - modes[layout.IM, k] * sine))
    for j in range(int(signal[layout.ATTACHED])):
        k = int(attached[layout.AMODE, j])
        attached[layout.AX, j], attached[layout.AY, j], attached[layout.AWEIGHT, j] = pose[0, k], pose[1, k], row[k]
        pairs[layout.X0, k], pairs[layout.Y0, k] = 0.0, 0.0
    signal[layout.CONST], signal[layout.DRIVE], signal[layout.COSINE], signal[layout.SINE] = const, w, cosine, sine
    signal[layout.ZR], signal[layout.ZI] = re * cosine - im * sine, re * sine + im * cosine


@kernel
def read_segment(engine: Engine, watch: Watch, i: int) -> None:
    """Read off the i-th segment just traced, from its first pose in ``watch.frame``."""
    clock, duration = watch.trace[i, layout.AT_CLOCK], watch.trace[i, layout.DURATION]
    share = ACCURACY if watch.reading >= layout.EVERYTHING else LIGHTLY
    if watch.trace[i, layout.WHAT] == layout.RESTING:
        watch.result[layout.CONTACT_LEAST] = min(watch.result[layout.CONTACT_LEAST], engine.drive[layout.GAP])
        read_rest(engine, watch, watch.frame, clock, duration, int(engine.drive[layout.COARSEST_AT_REST]), share)
    else:
        read_flight(engine, watch, watch.frame, clock, duration, int(engine.drive[layout.COARSEST]), share)


@kernel
def read_rest(
    engine: Engine, watch: Watch, pose: Array, clock: float, duration: float, coarsest: int, share: float
) -> None:
    """Extremes of the output and, as far as is asked, the modes' energies, over one rest."""
    rest, result = engine.rest, watch.result
    to_block_coordinates(rest, engine.drive, pose, clock)
    set_signal(rest, engine.drive, layout.OUTPUT_SIGNAL, 1.0, clock)
    result[layout.LEAST], result[layout.HIGH] = extremes_to(
        signal_of(rest), duration, coarsest, result[layout.LEAST], result[layout.HIGH], share
    )
    if watch.reading >= layout.EVERYTHING:
        energy_in_blocks(rest, engine.drive, engine.pairs[layout.OMEGA], clock, duration, watch)


@kernel
def read_flight(
    engine: Engine, watch: Watch, pose: Array, clock: float, duration: float, coarsest: int, share: float
) -> None:
    """Extremes of the output and, as far as is asked, of the gap, and the modes' energies, over one flight."""
    result = watch.result
    cosine, sine = phase(engine.drive, clock)
    begin_flight(engine, pose, cosine, sine)
    if watch.reading >= layout.EVERYTHING:
        energy_in_flight(engine, pose, clock, duration, watch.energy)
    if watch.reading >= layout.REACH_TOO:
        _, widest = extremes_to(
            signal_of(engine), duration, coarsest, 0.0, engine.drive[layout.GAP] - result[layout.CONTACT_LEAST], share
        )
        result[layout.CONTACT_LEAST] = engine.drive[layout.GAP] - widest
    begin_output(engine, watch.row, pose, clock)
    result[layout.LEAST], result[layout.HIGH] = extremes_to(
        signal_of(engine), duration, coarsest, result[layout.LEAST], result[layout.HIGH], share
    )
