"""Block flow: a linear regime in closed form, and any row over it as a signal.

Rest on the stop, the push of a linear stop and free flight with damping that couples modes are such regimes.
"""

from __future__ import annotations

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.drive import phase
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.kernels.roots.pair import propagator
from vibeam_models.arrays import Array

MOST_PIECES = 1e6  # of a Taylor series in time, then a block has no value


@kernel
def to_block_coordinates(regime: Regime, drive: Array, pose: Array, clock: float) -> None:
    """Set blocks[Z1], blocks[Z2]: what is left of ``pose`` in every block when its steady response is taken out."""
    blocks, n = regime.blocks, pose.shape[1]
    cosine, sine = phase(drive, clock)
    for k in range(blocks.shape[1]):
        first = -blocks[layout.OFFSET1, k] - blocks[layout.RE1, k] * sine - blocks[layout.IM1, k] * cosine
        second = -blocks[layout.OFFSET2, k] - blocks[layout.RE2, k] * sine - blocks[layout.IM2, k] * cosine
        for i in range(n):
            x, y = pose[0, i] - regime.held[i], pose[1, i]
            first += regime.into[2 * k, i] * x + regime.into[2 * k, n + i] * y
            second += regime.into[2 * k + 1, i] * x
            second += regime.into[2 * k + 1, n + i] * y
        blocks[layout.Z1, k], blocks[layout.Z2, k] = first, second


@kernel
def set_signal(regime: Regime, drive: Array, which: int, sign: float, clock: float) -> tuple[float, float, float]:
    """sign · signals[which] as the regime's signal, from where it was entered: value, rate, size of its parts."""
    blocks, signal, pairs, m = regime.blocks, regime.signal, regime.pairs, regime.blocks.shape[1]
    w, strength = drive[layout.W], drive[layout.STRENGTH]
    const, re = sign * regime.signals[which, 2 * m], sign * regime.signals[which, 2 * m + 1] * strength
    cosine, sine = phase(drive, clock)
    im, value, rate, size = 0.0, 0.0, 0.0, abs(const)
    signal[layout.ATTACHED] = 0.0
    for k in range(m):
        r0, r1 = sign * regime.signals[which, 2 * k], sign * regime.signals[which, 2 * k + 1]
        blocks[layout.WEIGHT1, k], blocks[layout.WEIGHT2, k] = r0, r1
        z1, z2 = blocks[layout.Z1, k], blocks[layout.Z2, k]
        const += r0 * blocks[layout.OFFSET1, k] + r1 * blocks[layout.OFFSET2, k]
        re += r0 * blocks[layout.RE1, k] + r1 * blocks[layout.RE2, k]
        im += r0 * blocks[layout.IM1, k] + r1 * blocks[layout.IM2, k]
        x = r0 * z1 + r1 * z2
        y = (r0 * blocks[layout.A11, k] + r1 * blocks[layout.A21, k]) * z1 + (
            r0 * blocks[layout.A12, k] + r1 * blocks[layout.A22, k]
        ) * z2
        size += abs(r0 * z1) + abs(r1 * z2)
        pairs[layout.X0, k], pairs[layout.Y0, k] = x, y
        if blocks[layout.CARRIED, k] > 0.0:
            y = attach(regime, drive, k, x, y, sine)
        value += x
        rate += y
    signal[layout.CONST], signal[layout.DRIVE], signal[layout.COSINE], signal[layout.SINE] = const, w, cosine, sine
    signal[layout.ZR], signal[layout.ZI] = re * cosine - im * sine, re * sine + im * cosine
    size += abs(const) + abs(signal[layout.ZR]) + abs(signal[layout.ZI])
    return value + const + signal[layout.ZI], rate + w * signal[layout.ZR], size


@kernel
def attach(regime: Regime, drive: Array, k: int, x: float, y: float, sine: float) -> float:
    """Block k as an attached pair of the signal; returns its rate.

    For x = r·y, y' = A y + u with A² = −2σA − ω²: x'' + 2σx' + ω²x = 2σ r·u + r·A u + r·u', with
    u = constant + load Ω²B sin φ.
    """
    blocks, attached, pairs = regime.blocks, regime.attached, regime.pairs
    j, sigma, strength = int(regime.signal[layout.ATTACHED]), pairs[layout.SIGMA, k], drive[layout.STRENGTH]
    r0, r1 = blocks[layout.WEIGHT1, k], blocks[layout.WEIGHT2, k]
    s0 = 2.0 * sigma * r0 + r0 * blocks[layout.A11, k] + r1 * blocks[layout.A21, k]
    s1 = 2.0 * sigma * r1 + r0 * blocks[layout.A12, k] + r1 * blocks[layout.A22, k]
    load = strength * (r0 * blocks[layout.LOAD1, k] + r1 * blocks[layout.LOAD2, k])
    attached[layout.ASIGMA, j], attached[layout.AOMEGA, j] = sigma, pairs[layout.OMEGA, k]
    attached[layout.AWEIGHT, j] = 1.0
    attached[layout.ASTATIC, j] = s0 * blocks[layout.CONSTANT1, k] + s1 * blocks[layout.CONSTANT2, k]
    attached[layout.ASINE, j] = strength * (s0 * blocks[layout.LOAD1, k] + s1 * blocks[layout.LOAD2, k])
    attached[layout.ACOSINE, j] = drive[layout.W] * load
    slope = y + r0 * blocks[layout.CONSTANT1, k] + r1 * blocks[layout.CONSTANT2, k] + load * sine
    attached[layout.AX, j], attached[layout.AY, j], attached[layout.AMODE, j] = x, slope, k
    pairs[layout.X0, k], pairs[layout.Y0, k] = 0.0, 0.0
    regime.signal[layout.ATTACHED] += 1.0
    return float(slope)


@kernel
def advance_blocks(regime: Regime, drive: Array, pose: Array, clock: float, duration: float) -> None:
    """Set ``pose`` to ``duration`` after the regime was entered at ``clock``."""
    blocks, n = regime.blocks, pose.shape[1]
    cosine, sine = phase(drive, clock + duration)
    for i in range(n):
        pose[0, i], pose[1, i] = regime.held[i], 0.0
    for k in range(blocks.shape[1]):
        y1, y2 = block_after(regime, drive, k, clock, duration)
        y1 += blocks[layout.OFFSET1, k] + blocks[layout.RE1, k] * sine + blocks[layout.IM1, k] * cosine
        y2 += blocks[layout.OFFSET2, k] + blocks[layout.RE2, k] * sine + blocks[layout.IM2, k] * cosine
        for i in range(n):
            pose[0, i] += regime.outof[i, 2 * k] * y1 + regime.outof[i, 2 * k + 1] * y2
            pose[1, i] += regime.outof[n + i, 2 * k] * y1 + regime.outof[n + i, 2 * k + 1] * y2


@kernel
def block_after(regime: Regime, drive: Array, k: int, clock: float, duration: float) -> tuple[float, float]:
    """Block coordinates beside the steady response, ``duration`` after the regime was entered at ``clock``."""
    if regime.blocks[layout.CARRIED, k] > 0.0:
        return carry_block(regime, drive, k, clock, duration)
    blocks, sigma, z1 = regime.blocks, regime.pairs[layout.SIGMA, k], regime.blocks[layout.Z1, k]
    z2 = regime.blocks[layout.Z2, k]
    _, odd, _, rest = propagator(sigma, regime.pairs[layout.OMEGA, k], regime.pairs[layout.DISC, k], duration)
    even = rest + sigma * odd  # exp(A t) = e^{−σt} (C + S (A + σ))
    y1 = even * z1 + odd * ((blocks[layout.A11, k] + sigma) * z1 + blocks[layout.A12, k] * z2)
    y2 = even * z2 + odd * (blocks[layout.A21, k] * z1 + (blocks[layout.A22, k] + sigma) * z2)
    return y1, y2


@kernel
def carry_block(regime: Regime, drive: Array, k: int, clock: float, duration: float) -> tuple[float, float]:
    """A block without steady response ``duration`` on, by Taylor series of y' = A y + u."""
    blocks, w, strength = regime.blocks, drive[layout.W], drive[layout.STRENGTH]
    z1, z2 = blocks[layout.Z1, k], blocks[layout.Z2, k]
    rate = max(w, regime.pairs[layout.KAPPA, k] + abs(blocks[layout.A12, k]) + abs(blocks[layout.A21, k]))
    if not rate * duration < MOST_PIECES:
        return np.nan, np.nan
    pieces = max(1, int(np.ceil(rate * duration)))
    h = duration / pieces
    for piece in range(pieces):
        draw, pull = phase(drive, clock + piece * h)
        first, second = z1, z2
        for i in range(layout.SERIES):
            u1 = strength * blocks[layout.LOAD1, k] * pull + (blocks[layout.CONSTANT1, k] if i == 0 else 0.0)
            u2 = strength * blocks[layout.LOAD2, k] * pull + (blocks[layout.CONSTANT2, k] if i == 0 else 0.0)
            first, second = (
                h * (blocks[layout.A11, k] * first + blocks[layout.A12, k] * second + u1) / (i + 1),
                h * (blocks[layout.A21, k] * first + blocks[layout.A22, k] * second + u2) / (i + 1),
            )
            z1 += first
            z2 += second
            pull, draw = h * w * draw / (i + 1), -h * w * pull / (i + 1)
    return z1, z2
