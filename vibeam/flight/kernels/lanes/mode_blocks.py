"""Places in ``cells`` and ``rungs`` (see ``lanes.layout``), and the way there and back."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined
from vibeam.flight.kernels.lanes import layout as block_layout
from vibeam.flight.kernels.lanes.simd import Lanes, width
from vibeam.flight.kernels.layout import Engine, Phase

Array = NDArray[np.float64]


@joined
def cell(block: int, row: int, like: Lanes) -> int:
    """Where a row of a block begins."""
    lanes: int = width(like)
    return (block * block_layout.CELL_ROWS + row) * lanes


@joined
def rung(level: int, blocks: int, block: int, row: int, like: Lanes) -> int:
    """Where a row of a block at one panel length begins."""
    lanes: int = width(like)
    return ((level * blocks + block) * block_layout.RUNG_ROWS + row) * lanes


@joined
def at_mode(k: int, row: int, like: Lanes) -> int:
    """Where a row has its number of mode k."""
    lanes: int = width(like)
    return ((k // lanes) * block_layout.CELL_ROWS + row) * lanes + k % lanes


@joined
def gather(pairs: Array, cells: Array, like: Lanes) -> None:
    """START_X, START_Y receive the pairs x, x' at the start of a flight, from ``begin_flight``."""
    for k in range(pairs.shape[1]):
        cells[at_mode(k, block_layout.START_X, like)], cells[at_mode(k, block_layout.START_Y, like)] = (
            pairs[layout.X0, k],
            pairs[layout.Y0, k],
        )


@joined
def scatter(engine: Engine, pose: Array, row: int, phase: Phase, like: Lanes) -> None:
    """Set ``pose`` to the pairs in ``row`` and the next, at that phase φ.

    η_k = −x_k/w_k + Im(H_k e^{iφ}) + s_k/ω_k², η_k' = −x_k'/w_k + Ω Re(H_k e^{iφ}).
    """
    cells, modes, w = engine.cells, engine.modes, engine.drive[layout.W]
    cosine, sine = phase
    for k in range(pose.shape[1]):
        c = modes[layout.CONTACT, k]
        pose[0, k] = (
            -cells[at_mode(k, row, like)] / c
            + modes[layout.OFFSET, k]
            + modes[layout.RE, k] * sine
            + modes[layout.IM, k] * cosine
        )
        pose[1, k] = -cells[at_mode(k, row + 1, like)] / c + w * (
            modes[layout.RE, k] * cosine - modes[layout.IM, k] * sine
        )
