"""Propagators and phasors tabulated over dyadic panel lengths, see ``linear.panel_tables``."""

from __future__ import annotations

from math import exp, sin

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import entry, kernel
from vibeam.flight.kernels.roots.pair import increments, sine_rest

Array = NDArray[np.float64]


@entry
def tabulate(pairs: Array, levels: Array, table: Array) -> None:
    """Fill ``table``, see ``layout``, of every panel length and pair."""
    for level in range(layout.LEVELS):
        h = levels[layout.STEP, level]
        for k in range(pairs.shape[1]):
            d0, d1, v0, v1 = increments(pairs[layout.SIGMA, k], pairs[layout.OMEGA, k], pairs[layout.DISC, k], h)
            table[0, level, k] = 1.0 + h * h * d0
            table[1, level, k] = h + h * h * d1
            table[2, level, k] = h * v0
            table[3, level, k] = 1.0 + h * v1
            table[4, level, k] = d0
            table[5, level, k] = d1
            table[6, level, k] = v0
            table[7, level, k] = v1
            for i in range(4):
                table[layout.WALK + i, level, k] = table[i, level, k]
            if pairs[layout.SLOW, k] > 0.0:
                table[layout.WALK, level, k], table[layout.WALK + 3, level, k] = (
                    exp(-pairs[layout.SLOW, k] * h),
                    exp(pairs[layout.TILT, k] * h),
                )
                table[layout.WALK + 1, level, k], table[layout.WALK + 2, level, k] = 0.0, 0.0


@kernel
def tabulate_drive(omega: float, levels: Array) -> None:
    """Fill the phasor rows of ``levels`` for one drive.

    Panels halve from level to level, so that each takes one sine: e^{iz} − 1 = −2 sin² ½z + i sin z.
    """
    sine = sin(omega * levels[layout.STEP, 0])
    for level in range(layout.LEVELS):
        h = levels[layout.STEP, level]
        inverse = 1.0 / h
        half = sin(0.5 * omega * h)
        versine = -2.0 * half * half
        levels[layout.TURN_RE, level], levels[layout.TURN_IM, level] = 1.0 + versine, sine
        levels[layout.FIRST_RE, level], levels[layout.FIRST_IM, level] = versine * inverse, sine * inverse
        levels[layout.SECOND_RE, level] = versine * inverse * inverse
        levels[layout.SECOND_IM, level] = sine_rest(omega * h, sine) * inverse * inverse
        sine = half


@kernel
def same_drive(levels: Array, others: Array) -> None:
    """Fill the phasor rows of ``others``, which have the same panel lengths."""
    for place in range(layout.TURN_RE, layout.LEVEL_ROWS):
        for level in range(layout.LEVELS):
            others[place, level] = levels[place, level]


@kernel
def level_of(levels: Array, h: float) -> int:
    """The level of the longest panel 2^{top − level} that is no longer than h."""
    level = 0
    while level < layout.LEVELS - 1 and levels[layout.STEP, level] > h:
        level += 1
    return level
