"""The free system once more, laid out for ``lanes``: blocks of modes, each row of a block one register wide.

``cells`` holds what belongs to a mode, ``rungs`` what belongs to a mode and a panel length; both are flat, so that the
place of every row is known when the kernels are compiled. Lanes that are left over hold modes that never move.
"""

from __future__ import annotations

from typing import NamedTuple

# cells: constants; pairs at the start; node and trial end (two sides, three rows each); pairs at the root's guess and
# their derivatives; per block: whether a lane is not underdamped, and the slowest decay
RATE, TURN, TURN_INVERSE, DAMP, SPRING, NORM, KICK, PUT, K1, K2, K4, K5 = range(12)
START_X, START_Y = 12, 13
SIDE_X, SIDE_Y, SIDE_E = 14, 15, 16  # + 3 for the other side
ROOT_X, ROOT_Y, ROOT_2, ROOT_3, ROOT_4, MIXED, SLOWEST = range(20, 27)
CELL_ROWS = 27


# rungs: P00 … P11 over the panel, D0 … V1 (``pair.increments``), 1 where the panel resolves the mode, and what E is
# multiplied by to bound what the panel's interpolant misses: of the signal, of the quotient of a flight's first panel
P00, P01, P10, P11, D0, D1, V0, V1, LOW, MISSED, MISSED_FIRST = range(11)
RUNG_ROWS = 11


class BlockPanel(NamedTuple):
    """A panel of the walk: the blocks that still ring, of how many; the level of its length; the side of its node."""

    blocks: int
    whole: int
    level: int
    side: int


class Forced(NamedTuple):
    """Forced part of the gap, const + Im(z e^{iΩt}), z = re + i im: and a bound ``size`` ≥ |z|."""

    const: float
    re: float
    im: float
    omega: float
    size: float
