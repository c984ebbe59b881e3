"""Time integral of each mode's energy ½(η'² + ω²η²) over a segment, by Simpson's rule, step by the mode's rate."""

from __future__ import annotations

from math import ceil, cos, sin

import numpy as np
from numpy.typing import NDArray

from vibeam.solvers.kernels import attached as att
from vibeam.solvers.kernels.desk import Desk
from vibeam.solvers.kernels.drive import phase
from vibeam.solvers.kernels.jit import kernel
from vibeam.solvers.kernels.layout import (
    AMODE,
    AOMEGA,
    ATTACHED,
    DISC,
    IM,
    KAPPA,
    NODE_X,
    NODE_Y,
    OFFSET,
    OMEGA,
    RE,
    SIGMA,
    W,
)
from vibeam.solvers.kernels.pair import propagator
from vibeam.solvers.kernels.rest import stay

Array = NDArray[np.float64]
RESOLUTION = 0.2  # rate times step
MOST, MOST_AT_REST = 128, 1024  # steps a segment: a faster mode rings so that its energy is smooth between samples


@kernel
def steps(rate: float, duration: float, most: int) -> int:
    """An even number of Simpson steps."""
    return 2 * max(1, int(min(most / 2, ceil(rate * duration / (2.0 * RESOLUTION)))))


@kernel
def simpson(i: int, count: int) -> float:
    """Weight of sample i of count + 1, times 3."""
    if i in (0, count):
        return 1.0
    return 4.0 if i % 2 == 1 else 2.0


@kernel
def energy_in_flight(desk: Desk, pose: Array, clock: float, duration: float, energy: Array) -> None:
    """Add ∫ E_k dt over a flight from ``pose`` to ``energy`` (n,). The desk's signal must be that of this flight."""
    pairs, modes, w = desk.pairs, desk.modes, desk.drive[W]
    cosine, sine = phase(desk.drive, clock)
    for k in range(pairs.shape[1]):
        count = steps(max(w, pairs[KAPPA, k]), duration, MOST)
        h, own = duration / count, pairs[OMEGA, k] * pairs[OMEGA, k]
        p00, p01, p10, p11 = propagator(pairs[SIGMA, k], pairs[OMEGA, k], pairs[DISC, k], h)
        turn_re, turn_im = cos(w * h), sin(w * h)
        c, s = cosine, sine
        re, im, offset = modes[RE, k], modes[IM, k], modes[OFFSET, k]
        x = pose[0, k] - offset - re * s - im * c
        y = pose[1, k] - w * (re * c - im * s)
        total = 0.0
        for i in range(count + 1):
            value = x + offset + re * s + im * c
            slope = y + w * (re * c - im * s)
            total += simpson(i, count) * (slope * slope + own * value * value)
            x, y = p00 * x + p01 * y, p10 * x + p11 * y
            c, s = c * turn_re - s * turn_im, s * turn_re + c * turn_im
        energy[k] += total * h / 6.0 if not carried(desk.attached, desk.signal, k) else 0.0
    if desk.signal[ATTACHED] > 0.0:
        energy_attached(desk.attached, desk.signal, duration, energy)


@kernel
def carried(attached: Array, signal: Array, k: int) -> bool:
    """Whether mode k is attached."""
    found = False
    for j in range(int(signal[ATTACHED])):
        found = found or int(attached[AMODE, j]) == k
    return found


@kernel
def energy_attached(attached: Array, signal: Array, duration: float, energy: Array) -> None:
    """Add the attached modes' part."""
    count = steps(att.fastest(attached, signal), duration, MOST)
    h = duration / count
    att.restart(attached, signal)
    for i in range(count + 1):
        for j in range(int(signal[ATTACHED])):
            x, y = attached[NODE_X, j], attached[NODE_Y, j]
            share = simpson(i, count) * (y * y + (attached[AOMEGA, j] * x) ** 2) * h / 6.0
            energy[int(attached[AMODE, j])] += share
        att.carry(attached, signal, i * h, h)
        att.accept(attached, signal)


@kernel
def energy_at_rest(desk: Desk, pose: Array, clock: float, duration: float, scratch: Array, energy: Array) -> None:
    """Add ∫ E_k dt over a rest from ``pose`` to ``energy`` (n,)."""
    n = pose.shape[1]
    count = steps(max(desk.drive[W], desk.pairs[KAPPA, n - 1]), duration, MOST_AT_REST)
    for i in range(count + 1):
        for k in range(n):
            scratch[0, k], scratch[1, k] = pose[0, k], pose[1, k]
        stay(desk, scratch, clock, i * duration / count)
        for k in range(n):
            own = desk.pairs[OMEGA, k]
            density = scratch[1, k] ** 2 + (own * scratch[0, k]) ** 2
            energy[k] += simpson(i, count) * density * duration / count / 6.0
