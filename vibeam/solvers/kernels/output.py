"""An output row·η as a signal, in flight and at rest."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.solvers.kernels.desk import Desk
from vibeam.solvers.kernels.drive import phase
from vibeam.solvers.kernels.jit import kernel
from vibeam.solvers.kernels.layout import (
    AMODE,
    ATTACHED,
    AWEIGHT,
    AX,
    AY,
    CONST,
    COSINE,
    DRIVE,
    IM,
    OFFSET,
    RE,
    SINE,
    WEIGHT1,
    WEIGHT2,
    X0,
    Y0,
    ZI,
    ZR,
    W,
)
from vibeam.solvers.kernels.rest import into_blocks, weigh

Array = NDArray[np.float64]


@kernel
def begin_output(desk: Desk, row: Array, pose: Array, clock: float) -> None:
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
def begin_output_at_rest(desk: Desk, rest_row: Array, row: Array, pose: Array, clock: float) -> None:
    """row·η at rest as the rest signal; ``rest_row`` (2, n − 1) = row · from_blocks by block."""
    into_blocks(desk, pose, clock)
    const = 0.0
    for k in range(pose.shape[1]):
        const += row[k] * desk.held[k]
    for k in range(desk.blocks.shape[1]):
        desk.blocks[WEIGHT1, k], desk.blocks[WEIGHT2, k] = rest_row[0, k], rest_row[1, k]
    weigh(desk, const, 0.0, clock)
