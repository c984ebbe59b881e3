"""An output row·η as a signal, in flight and at rest."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.solvers.kernels.desk import Desk
from vibeam.solvers.kernels.drive import phase
from vibeam.solvers.kernels.jit import kernel
from vibeam.solvers.kernels.layout import (
    A11,
    A12,
    A21,
    A22,
    AMODE,
    ATTACHED,
    AWEIGHT,
    AX,
    AY,
    CONST,
    COSINE,
    DRIVE,
    IM,
    IM1,
    IM2,
    OFFSET,
    OFFSET1,
    OFFSET2,
    RE,
    RE1,
    RE2,
    SINE,
    X0,
    Y0,
    Z1,
    Z2,
    ZI,
    ZR,
    W,
)
from vibeam.solvers.kernels.rest import into_blocks

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
    blocks, signal = desk.blocks, desk.rest_signal
    into_blocks(desk, pose, clock)
    cosine, sine = phase(desk.drive, clock)
    const, re, im = 0.0, 0.0, 0.0
    for k in range(pose.shape[1]):
        const += row[k] * desk.held[k]
    for k in range(blocks.shape[1]):
        r0, r1 = rest_row[0, k], rest_row[1, k]
        const += r0 * blocks[OFFSET1, k] + r1 * blocks[OFFSET2, k]
        re += r0 * blocks[RE1, k] + r1 * blocks[RE2, k]
        im += r0 * blocks[IM1, k] + r1 * blocks[IM2, k]
        z1, z2 = blocks[Z1, k], blocks[Z2, k]
        desk.rest_pairs[X0, k] = r0 * z1 + r1 * z2
        desk.rest_pairs[Y0, k] = (r0 * blocks[A11, k] + r1 * blocks[A21, k]) * z1
        desk.rest_pairs[Y0, k] += (r0 * blocks[A12, k] + r1 * blocks[A22, k]) * z2
    signal[CONST], signal[DRIVE], signal[COSINE], signal[SINE] = const, desk.drive[W], cosine, sine
    signal[ZR], signal[ZI] = re * cosine - im * sine, re * sine + im * cosine
