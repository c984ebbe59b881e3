"""The pairs of a linear system, and propagators and phasors tabulated over dyadic panel lengths.

Panels are 2^top, 2^(top−1), … seconds long: powers of two are hardly ever an integer fraction of a drive period (at
8 Hz they are), so roots of periodic motions do not sit on panel ends, and one table serves every drive.
"""

from __future__ import annotations

import numpy as np

from vibeam.flight.engine.entries import tabulate
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.thresholds import APART, RESOLVED
from vibeam_models.arrays import Array

SMALLEST = 1e-300  # rad/s: slower is as good as free


def regime(omega: Array, sigma: Array, disc: Array, top: int) -> tuple[Array, Array, Array]:
    """``pairs``, ``table`` (TABLE_ROWS, levels, n) and ``levels`` of pairs sorted by ``rates``; panels of 2^top s."""
    pairs = np.zeros((layout.PAIR_ROWS, len(omega)))
    over = sigma + np.sqrt(np.maximum(disc, 0.0))
    pairs[layout.OMEGA], pairs[layout.SIGMA], pairs[layout.DISC], pairs[layout.KAPPA] = (
        omega,
        sigma,
        disc,
        rates(omega, sigma),
    )
    pairs[layout.INVERSE] = _inverse(omega, over, disc)
    pairs[layout.DECAY] = np.where(disc < 0, sigma, omega**2 / np.where(over > 0, over, 1.0))
    slow = omega * (omega / np.where(over > 0, over, 1.0))
    apart = (disc > APART * sigma**2) & (slow > 0)
    pairs[layout.SLOW], pairs[layout.JOIN], pairs[layout.TILT] = (
        np.where(apart, slow, 0.0),
        apart,
        np.where(apart, -over, 1.0),
    )
    levels = np.zeros((layout.LEVEL_ROWS, layout.LEVELS))
    levels[layout.STEP] = np.ldexp(1.0, top - np.arange(layout.LEVELS))
    levels[layout.COUNT] = np.sum(pairs[layout.KAPPA][None, :] * levels[layout.STEP][:, None] <= RESOLVED, axis=1)
    table = np.zeros((layout.TABLE_ROWS, layout.LEVELS, len(omega)))
    tabulate(pairs, levels, table)
    return pairs, table, levels


def _inverse(omega: Array, over: Array, disc: Array) -> Array:
    """What x' is multiplied by so that the norm of (x, x') bounds |x| for all later times.

    1/ω by the energy. With decays a ≤ b, P00 lies in [0, 1] and P01 in [0, 1/b], so |x| + |x'|/b bounds it too, which
    the octagon's norm does where x' counts 1 + √2 times; and |P01^(j)| ≤ (b^j − a^j)/(b − a) ≤ κ^j/b, so that the bound
    holds for derivatives as the energy's does. Far beyond critical damping it is smaller by 2ζ.
    """
    energy = np.where(omega > SMALLEST, 1.0 / np.where(omega > SMALLEST, omega, 1.0), 0.0)
    with np.errstate(over="ignore"):  # hardly any decay bounds nothing
        decay = np.where(disc > 0, (1 + np.sqrt(2)) / np.where(over > 0, over, 1.0), np.inf)
    return np.asarray(np.minimum(energy, decay))


def rates(omega: Array, sigma: Array) -> Array:
    """κ = σ + √(σ² + ω²): every time derivative grows at most by it, in the energy norm (ωx, x')."""
    with np.errstate(over="ignore"):  # an infinite rate is refused
        return np.asarray(sigma + np.sqrt(sigma**2 + omega**2))
