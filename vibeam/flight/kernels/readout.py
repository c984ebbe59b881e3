"""What is read off the flights and rests of a steady point: extremes and energies."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.block_energy import energy_in_blocks
from vibeam.flight.kernels.block_flow import set_signal, to_block_coordinates
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.drive import phase
from vibeam.flight.kernels.energy import energy_in_flight
from vibeam.flight.kernels.extremes import ACCURACY, LIGHTLY, extremes_to
from vibeam.flight.kernels.layout import (
    AMODE,
    AT_CLOCK,
    ATTACHED,
    AWEIGHT,
    AX,
    AY,
    COARSEST,
    COARSEST_AT_REST,
    CONST,
    CONTACT_LEAST,
    COSINE,
    DRIVE,
    DURATION,
    EVERYTHING,
    GAP,
    HIGH,
    IM,
    LEAST,
    OFFSET,
    OMEGA,
    OUTPUT_SIGNAL,
    RE,
    REACH_TOO,
    RESTING,
    SINE,
    WHAT,
    X0,
    Y0,
    ZI,
    ZR,
    Engine,
    W,
    Watch,
)
from vibeam.flight.kernels.modal_flow import begin_flight
from vibeam.flight.kernels.roots.signal import signal_of

Array = NDArray[np.float64]


@kernel
def begin_output(desk: Engine, row: Array, pose: Array, clock: float) -> None:
    """row·η in flight as the free signal; the attached pairs must be those of this flight (``begin_flight``)."""
    pairs, modes, signal, attached = desk.pairs, desk.modes, desk.signal, desk.attached
    cosine, sine = phase(desk.drive, clock)
    w = desk.drive[W]
    const, re, im = 0.0, 0.0, 0.0
    for k in range(pairs.shape[1]):
        const += row[k] * modes[OFFSET, k]
        re += row[k] * modes[RE, k]
        im += row[k] * modes[IM, k]
        own = modes[OFFSET, k] + modes[RE, k] * sine + modes[IM, k] * cosine
        pairs[X0, k] = row[k] * (pose[0, k] - own)
        pairs[Y0, k] = row[k] * (pose[1, k] - w * (modes[RE, k] * cosine - modes[IM, k] * sine))
    for j in range(int(signal[ATTACHED])):
        k = int(attached[AMODE, j])
        attached[AX, j], attached[AY, j], attached[AWEIGHT, j] = pose[0, k], pose[1, k], row[k]
        pairs[X0, k], pairs[Y0, k] = 0.0, 0.0
    signal[CONST], signal[DRIVE], signal[COSINE], signal[SINE] = const, w, cosine, sine
    signal[ZR], signal[ZI] = re * cosine - im * sine, re * sine + im * cosine


@kernel
def read_segment(desk: Engine, room: Watch, i: int) -> None:
    """Read off the i-th segment just traced, from its first pose in ``room.frame``."""
    clock, duration = room.trace[i, AT_CLOCK], room.trace[i, DURATION]
    share = ACCURACY if room.reading >= EVERYTHING else LIGHTLY
    if room.trace[i, WHAT] == RESTING:
        room.result[CONTACT_LEAST] = min(room.result[CONTACT_LEAST], desk.drive[GAP])
        read_rest(desk, room, room.frame, clock, duration, int(desk.drive[COARSEST_AT_REST]), share)
    else:
        read_flight(desk, room, room.frame, clock, duration, int(desk.drive[COARSEST]), share)


@kernel
def read_rest(
    desk: Engine, room: Watch, pose: Array, clock: float, duration: float, coarsest: int, share: float
) -> None:
    """Extremes of the output and, as far as is asked, the modes' energies, over one rest."""
    rest, result = desk.rest, room.result
    to_block_coordinates(rest, desk.drive, pose, clock)
    set_signal(rest, desk.drive, OUTPUT_SIGNAL, 1.0, clock)
    result[LEAST], result[HIGH] = extremes_to(signal_of(rest), duration, coarsest, result[LEAST], result[HIGH], share)
    if room.reading >= EVERYTHING:
        energy_in_blocks(rest, desk.drive, desk.pairs[OMEGA], clock, duration, room)


@kernel
def read_flight(
    desk: Engine, room: Watch, pose: Array, clock: float, duration: float, coarsest: int, share: float
) -> None:
    """Extremes of the output and, as far as is asked, of the gap, and the modes' energies, over one flight."""
    result = room.result
    cosine, sine = phase(desk.drive, clock)
    begin_flight(desk, pose, cosine, sine)
    if room.reading >= EVERYTHING:
        energy_in_flight(desk, pose, clock, duration, room.energy)
    if room.reading >= REACH_TOO:
        _, widest = extremes_to(
            signal_of(desk), duration, coarsest, 0.0, desk.drive[GAP] - result[CONTACT_LEAST], share
        )
        result[CONTACT_LEAST] = desk.drive[GAP] - widest
    begin_output(desk, room.row, pose, clock)
    result[LEAST], result[HIGH] = extremes_to(signal_of(desk), duration, coarsest, result[LEAST], result[HIGH], share)
