"""Rest on the stop: the constrained linear system in closed form, and its contact force as a signal."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.drive import phase
from vibeam.flight.kernels.layout import (
    A11,
    A12,
    A21,
    A22,
    ACOSINE,
    AMODE,
    AOMEGA,
    ASIGMA,
    ASINE,
    ASTATIC,
    ATTACHED,
    AWEIGHT,
    AX,
    AY,
    CARRIED,
    CONST,
    CONSTANT1,
    CONSTANT2,
    CONTACT,
    COSINE,
    DISC,
    DRIVE,
    IM1,
    IM2,
    KAPPA,
    LOAD,
    LOAD1,
    LOAD2,
    MOBILITY,
    OFFSET1,
    OFFSET2,
    OMEGA,
    RE1,
    RE2,
    REST_FORCE,
    REST_LOAD,
    ROW1,
    ROW2,
    SERIES,
    SIGMA,
    SINE,
    STATIC,
    STRENGTH,
    WEIGHT1,
    WEIGHT2,
    X0,
    Y0,
    Z1,
    Z2,
    ZI,
    ZR,
    Engine,
    W,
)
from vibeam.flight.kernels.roots.pair import propagator

Array = NDArray[np.float64]

MOST_PIECES = 1e6  # of a Taylor series in time, then a block has no value


@kernel
def into_blocks(desk: Engine, pose: Array, clock: float) -> None:
    """Set blocks[Z1], blocks[Z2]: block coordinates of ``pose`` less their steady response."""
    blocks, n = desk.blocks, pose.shape[1]
    cosine, sine = phase(desk.drive, clock)
    for k in range(n - 1):
        first = -blocks[OFFSET1, k] - blocks[RE1, k] * sine - blocks[IM1, k] * cosine
        second = -blocks[OFFSET2, k] - blocks[RE2, k] * sine - blocks[IM2, k] * cosine
        for i in range(n):
            first += desk.to_blocks[2 * k, i] * (pose[0, i] - desk.held[i]) + desk.to_blocks[2 * k, n + i] * pose[1, i]
            second += desk.to_blocks[2 * k + 1, i] * (pose[0, i] - desk.held[i])
            second += desk.to_blocks[2 * k + 1, n + i] * pose[1, i]
        blocks[Z1, k], blocks[Z2, k] = first, second


@kernel
def begin_rest(desk: Engine, pose: Array, clock: float) -> tuple[float, float, float]:
    """The contact force (positive: it presses) as the rest signal: its value and rate now, the size of its parts."""
    blocks, drive = desk.blocks, desk.drive
    into_blocks(desk, pose, clock)
    for k in range(blocks.shape[1]):
        blocks[WEIGHT1, k], blocks[WEIGHT2, k] = blocks[ROW1, k], blocks[ROW2, k]
    force, rate, size = set_rest_signal(desk, drive[REST_FORCE], drive[REST_LOAD] * drive[STRENGTH], clock)
    parts = 0.0  # of the force, mode by mode, before they cancel
    for k in range(pose.shape[1]):
        own, damp = desk.pairs[OMEGA, k], 2.0 * desk.pairs[SIGMA, k]
        push = abs(desk.modes[STATIC, k]) + abs(desk.modes[LOAD, k] * drive[STRENGTH])
        parts += abs(desk.modes[CONTACT, k]) * (own * own * abs(pose[0, k]) + damp * abs(pose[1, k]) + push)
    return force, rate, max(size, parts / drive[MOBILITY])


@kernel
def set_rest_signal(desk: Engine, const: float, re: float, clock: float) -> tuple[float, float, float]:
    """const + re sin φ + Σ weight·y as the rest signal, y in blocks[Z1], blocks[Z2]: value, rate, size of its parts."""
    blocks, signal, w = desk.blocks, desk.rest_signal, desk.drive[W]
    cosine, sine = phase(desk.drive, clock)
    im, value, rate, size = 0.0, 0.0, 0.0, 0.0
    signal[ATTACHED] = 0.0
    for k in range(blocks.shape[1]):
        r0, r1, z1, z2 = blocks[WEIGHT1, k], blocks[WEIGHT2, k], blocks[Z1, k], blocks[Z2, k]
        const += r0 * blocks[OFFSET1, k] + r1 * blocks[OFFSET2, k]
        re += r0 * blocks[RE1, k] + r1 * blocks[RE2, k]
        im += r0 * blocks[IM1, k] + r1 * blocks[IM2, k]
        x = r0 * z1 + r1 * z2
        y = (r0 * blocks[A11, k] + r1 * blocks[A21, k]) * z1 + (r0 * blocks[A12, k] + r1 * blocks[A22, k]) * z2
        desk.rest_pairs[X0, k], desk.rest_pairs[Y0, k] = x, y
        if blocks[CARRIED, k] > 0.0:
            y = attach(desk, k, x, y, sine)
        value += x
        rate += y
        size += abs(x)
    signal[CONST], signal[DRIVE], signal[COSINE], signal[SINE] = const, w, cosine, sine
    signal[ZR], signal[ZI] = re * cosine - im * sine, re * sine + im * cosine
    size += abs(const) + abs(signal[ZR]) + abs(signal[ZI])
    return value + const + signal[ZI], rate + w * signal[ZR], size


@kernel
def attach(desk: Engine, k: int, x: float, y: float, sine: float) -> float:
    """Block k as an attached pair of the rest signal; returns its rate.

    For x = r·y, y' = A y + u with A² = −2σA − ω²: x'' + 2σx' + ω²x = 2σ r·u + r·A u + r·u', with
    u = constant + load Ω²B sin φ.
    """
    blocks, attached, pairs = desk.blocks, desk.rest_attached, desk.rest_pairs
    j, sigma, strength = int(desk.rest_signal[ATTACHED]), pairs[SIGMA, k], desk.drive[STRENGTH]
    r0, r1 = blocks[WEIGHT1, k], blocks[WEIGHT2, k]
    s0 = 2.0 * sigma * r0 + r0 * blocks[A11, k] + r1 * blocks[A21, k]
    s1 = 2.0 * sigma * r1 + r0 * blocks[A12, k] + r1 * blocks[A22, k]
    load = strength * (r0 * blocks[LOAD1, k] + r1 * blocks[LOAD2, k])
    attached[ASIGMA, j], attached[AOMEGA, j], attached[AWEIGHT, j] = sigma, pairs[OMEGA, k], 1.0
    attached[ASTATIC, j] = s0 * blocks[CONSTANT1, k] + s1 * blocks[CONSTANT2, k]
    attached[ASINE, j] = strength * (s0 * blocks[LOAD1, k] + s1 * blocks[LOAD2, k])
    attached[ACOSINE, j] = desk.drive[W] * load
    slope = y + r0 * blocks[CONSTANT1, k] + r1 * blocks[CONSTANT2, k] + load * sine
    attached[AX, j], attached[AY, j], attached[AMODE, j] = x, slope, k
    pairs[X0, k], pairs[Y0, k] = 0.0, 0.0
    desk.rest_signal[ATTACHED] += 1.0
    return float(slope)


@kernel
def carry_block(desk: Engine, k: int, clock: float, duration: float) -> None:
    """Carry blocks[Z1], blocks[Z2] of a block without steady response on, by Taylor series of y' = A y + u."""
    blocks, w, strength = desk.blocks, desk.drive[W], desk.drive[STRENGTH]
    rate = max(w, desk.rest_pairs[KAPPA, k] + abs(blocks[A12, k]) + abs(blocks[A21, k]))
    if not rate * duration < MOST_PIECES:
        blocks[Z1, k], blocks[Z2, k] = np.nan, np.nan
        return
    pieces = max(1, int(np.ceil(rate * duration)))
    h = duration / pieces
    for piece in range(pieces):
        draw, pull = phase(desk.drive, clock + piece * h)
        first, second = blocks[Z1, k], blocks[Z2, k]
        for i in range(SERIES):
            u1 = strength * blocks[LOAD1, k] * pull + (blocks[CONSTANT1, k] if i == 0 else 0.0)
            u2 = strength * blocks[LOAD2, k] * pull + (blocks[CONSTANT2, k] if i == 0 else 0.0)
            first, second = (
                h * (blocks[A11, k] * first + blocks[A12, k] * second + u1) / (i + 1),
                h * (blocks[A21, k] * first + blocks[A22, k] * second + u2) / (i + 1),
            )
            blocks[Z1, k] += first
            blocks[Z2, k] += second
            pull, draw = h * w * draw / (i + 1), -h * w * pull / (i + 1)


@kernel
def advance_at_rest(desk: Engine, pose: Array, clock: float, duration: float) -> None:
    """Carry ``pose`` on by ``duration`` of rest."""
    blocks, pairs, n = desk.blocks, desk.rest_pairs, pose.shape[1]
    into_blocks(desk, pose, clock)
    cosine, sine = phase(desk.drive, clock + duration)
    for i in range(n):
        pose[0, i], pose[1, i] = desk.held[i], 0.0
    for k in range(n - 1):
        sigma, z1, z2 = pairs[SIGMA, k], blocks[Z1, k], blocks[Z2, k]
        even, odd = even_odd(sigma, pairs[OMEGA, k], pairs[DISC, k], duration)
        if blocks[CARRIED, k] > 0.0:
            carry_block(desk, k, clock, duration)
            even, odd, z1, z2 = 1.0, 0.0, blocks[Z1, k], blocks[Z2, k]
        y1 = even * z1 + odd * ((blocks[A11, k] + sigma) * z1 + blocks[A12, k] * z2)
        y2 = even * z2 + odd * (blocks[A21, k] * z1 + (blocks[A22, k] + sigma) * z2)
        y1 += blocks[OFFSET1, k] + blocks[RE1, k] * sine + blocks[IM1, k] * cosine
        y2 += blocks[OFFSET2, k] + blocks[RE2, k] * sine + blocks[IM2, k] * cosine
        for i in range(n):
            pose[0, i] += desk.from_blocks[i, 2 * k] * y1 + desk.from_blocks[i, 2 * k + 1] * y2
            pose[1, i] += desk.from_blocks[n + i, 2 * k] * y1 + desk.from_blocks[n + i, 2 * k + 1] * y2


@kernel
def even_odd(sigma: float, omega: float, disc: float, t: float) -> tuple[float, float]:
    """e^{−σt} C and e^{−σt} S of a block: exp(A t) = e^{−σt} (C + S (A + σ))."""
    _, odd, _, rest = propagator(sigma, omega, disc, t)
    return rest + sigma * odd, odd
