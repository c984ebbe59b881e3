"""Propagators and phasors tabulated over dyadic panel lengths.

Panels are 2^top, 2^(top−1), … seconds long: powers of two are never an integer fraction of a drive period, so roots of
periodic motions do not sit on panel ends, and one table serves every drive.
"""

from __future__ import annotations

from math import sin

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import entry, kernel
from vibeam.flight.kernels.layout import (
    COUNT,
    DECAY,
    DISC,
    FIRST_IM,
    FIRST_RE,
    INVERSE,
    KAPPA,
    LEVEL_ROWS,
    LEVELS,
    OMEGA,
    PAIR_ROWS,
    SECOND_IM,
    SECOND_RE,
    SIGMA,
    STEP,
    TURN_IM,
    TURN_RE,
)
from vibeam.flight.kernels.roots.pair import increments, sine_rest

Array = NDArray[np.float64]

SMALLEST = 1e-300  # rad/s: slower is as good as free

RESOLVED = 1.2  # κh up to which a pair takes part in the interpolant; above it enters by bounds


def regime(omega: Array, sigma: Array, disc: Array, top: int) -> tuple[Array, Array, Array]:
    """``pairs``, ``table`` (8, levels, n) and ``levels`` of pairs sorted by ``rates``; longest panel 2^top s."""
    pairs = np.zeros((PAIR_ROWS, len(omega)))
    over = sigma + np.sqrt(np.maximum(disc, 0.0))
    pairs[OMEGA], pairs[SIGMA], pairs[DISC], pairs[KAPPA] = omega, sigma, disc, rates(omega, sigma)
    pairs[INVERSE] = _inverse(omega, over, disc)
    pairs[DECAY] = np.where(disc < 0, sigma, omega**2 / np.where(over > 0, over, 1.0))
    levels = np.zeros((LEVEL_ROWS, LEVELS))
    levels[STEP] = np.ldexp(1.0, top - np.arange(LEVELS))
    levels[COUNT] = np.sum(pairs[KAPPA][None, :] * levels[STEP][:, None] <= RESOLVED, axis=1)
    table = np.zeros((8, LEVELS, len(omega)))
    tabulate(pairs, levels, table)
    return pairs, table, levels


def _inverse(omega: Array, over: Array, disc: Array) -> Array:
    """What x' is multiplied by so that the norm of (x, x') bounds |x| for all later times.

    1/ω by the energy. With decays a ≤ b, P00 lies in [0, 1] and P01 in [0, 1/b], so |x| + |x'|/b bounds it too, which
    the octagon's norm does where x' counts 1 + √2 times; and |P01^(j)| ≤ (b^j − a^j)/(b − a) ≤ κ^j/b, so that the bound
    holds for derivatives as the energy's does. Far beyond critical damping it is smaller by 2ζ.
    """
    energy = np.where(omega > SMALLEST, 1.0 / np.where(omega > SMALLEST, omega, 1.0), 0.0)
    decay = np.where(disc > 0, (1 + np.sqrt(2)) / np.where(over > 0, over, 1.0), np.inf)
    return np.asarray(np.minimum(energy, decay))


def rates(omega: Array, sigma: Array) -> Array:
    """κ = σ + √(σ² + ω²): every time derivative grows at most by it, in the energy norm (ωx, x')."""
    return np.asarray(sigma + np.sqrt(sigma**2 + omega**2))


@entry
def tabulate(pairs: Array, levels: Array, table: Array) -> None:
    """Fill ``table`` with P00 P01 P10 P11 D0 D1 V0 V1 of every panel length and pair."""
    for level in range(LEVELS):
        h = levels[STEP, level]
        for k in range(pairs.shape[1]):
            d0, d1, v0, v1 = increments(pairs[SIGMA, k], pairs[OMEGA, k], pairs[DISC, k], h)
            table[0, level, k] = 1.0 + h * h * d0
            table[1, level, k] = h + h * h * d1
            table[2, level, k] = h * v0
            table[3, level, k] = 1.0 + h * v1
            table[4, level, k] = d0
            table[5, level, k] = d1
            table[6, level, k] = v0
            table[7, level, k] = v1


@kernel
def tabulate_drive(omega: float, levels: Array) -> None:
    """Fill the phasor rows of ``levels`` for one drive.

    Panels halve from level to level, so that each takes one sine: e^{iz} − 1 = −2 sin² ½z + i sin z.
    """
    sine = sin(omega * levels[STEP, 0])
    for level in range(LEVELS):
        h = levels[STEP, level]
        inverse = 1.0 / h
        half = sin(0.5 * omega * h)
        versine = -2.0 * half * half
        levels[TURN_RE, level], levels[TURN_IM, level] = 1.0 + versine, sine
        levels[FIRST_RE, level], levels[FIRST_IM, level] = versine * inverse, sine * inverse
        levels[SECOND_RE, level] = versine * inverse * inverse
        levels[SECOND_IM, level] = sine_rest(omega * h, sine) * inverse * inverse
        sine = half


@kernel
def same_drive(levels: Array, others: Array) -> None:
    """Fill the phasor rows of ``others``, which have the same panel lengths."""
    for place in range(TURN_RE, LEVEL_ROWS):
        for level in range(LEVELS):
            others[place, level] = levels[place, level]


@kernel
def level_of(levels: Array, h: float) -> int:
    """The level of the longest panel 2^{top − level} that is no longer than h."""
    level = 0
    while level < LEVELS - 1 and levels[STEP, level] > h:
        level += 1
    return level
