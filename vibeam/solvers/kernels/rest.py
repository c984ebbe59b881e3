"""Rest on the stop: the constrained linear system in closed form, and its contact force as a signal."""

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
    CONST,
    CONTACT,
    COSINE,
    DISC,
    DRIVE,
    GAP,
    IM1,
    IM2,
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
    SIGMA,
    SINE,
    STRENGTH,
    X0,
    Y0,
    Z1,
    Z2,
    ZI,
    ZR,
    W,
)
from vibeam.solvers.kernels.pair import propagator

Array = NDArray[np.float64]


@kernel
def settle_on_stop(modes: Array, drive: Array, pose: Array) -> None:
    """Take contact velocity, and penetration by round-off, out by the least impulse."""
    value, slope = -drive[GAP], 0.0
    for k in range(modes.shape[1]):
        value += modes[CONTACT, k] * pose[0, k]
        slope += modes[CONTACT, k] * pose[1, k]
    for k in range(modes.shape[1]):
        pose[0, k] -= modes[CONTACT, k] * value / drive[MOBILITY]
        pose[1, k] -= modes[CONTACT, k] * slope / drive[MOBILITY]


@kernel
def into_blocks(desk: Desk, pose: Array, clock: float) -> None:
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
def begin_rest(desk: Desk, pose: Array, clock: float) -> tuple[float, float, float]:
    """The contact force (positive: it presses) as the rest signal: its value and rate now, the size of its parts."""
    blocks, drive, signal = desk.blocks, desk.drive, desk.rest_signal
    into_blocks(desk, pose, clock)
    cosine, sine = phase(drive, clock)
    const, re, im = drive[REST_FORCE], drive[REST_LOAD] * drive[STRENGTH], 0.0
    value, rate, size = 0.0, 0.0, 0.0
    for k in range(blocks.shape[1]):
        r0, r1 = blocks[ROW1, k], blocks[ROW2, k]
        const += r0 * blocks[OFFSET1, k] + r1 * blocks[OFFSET2, k]
        re += r0 * blocks[RE1, k] + r1 * blocks[RE2, k]
        im += r0 * blocks[IM1, k] + r1 * blocks[IM2, k]
        x = r0 * blocks[Z1, k] + r1 * blocks[Z2, k]
        y = (r0 * blocks[A11, k] + r1 * blocks[A21, k]) * blocks[Z1, k]
        y += (r0 * blocks[A12, k] + r1 * blocks[A22, k]) * blocks[Z2, k]
        desk.rest_pairs[X0, k], desk.rest_pairs[Y0, k] = x, y
        value += x
        rate += y
        size += abs(x)
    signal[CONST], signal[DRIVE], signal[COSINE], signal[SINE] = const, drive[W], cosine, sine
    signal[ZR], signal[ZI] = re * cosine - im * sine, re * sine + im * cosine
    size += abs(const) + abs(signal[ZR]) + abs(signal[ZI])
    return value + const + signal[ZI], rate + drive[W] * signal[ZR], size


@kernel
def stay(desk: Desk, pose: Array, clock: float, duration: float) -> None:
    """Carry ``pose`` on by ``duration`` of rest."""
    blocks, pairs, n = desk.blocks, desk.rest_pairs, pose.shape[1]
    into_blocks(desk, pose, clock)
    cosine, sine = phase(desk.drive, clock + duration)
    for i in range(n):
        pose[0, i], pose[1, i] = desk.held[i], 0.0
    for k in range(n - 1):
        sigma, z1, z2 = pairs[SIGMA, k], blocks[Z1, k], blocks[Z2, k]
        even, odd = even_odd(sigma, pairs[OMEGA, k], pairs[DISC, k], duration)
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
