"""The same system once more, laid out for ``lanes``: blocks of modes, each row of a block one register wide.

``cells`` holds what belongs to a mode, ``rungs`` what belongs to a mode and a panel length; both are flat, so that the
place of every row is known when the kernels are compiled. Lanes that are left over hold modes that never move.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import joined
from vibeam.flight.kernels.lanes.elementary import REDUCED
from vibeam.flight.kernels.lanes.simd import Lanes, width
from vibeam.flight.kernels.layout import (
    CONTACT,
    COUNT,
    DECAY,
    DISC,
    IM,
    INVERSE,
    KAPPA,
    LEVELS,
    MOBILITY,
    OFFSET,
    OMEGA,
    RE,
    SIGMA,
    STEP,
    X0,
    Y0,
    YIELD,
    Engine,
    Phase,
    W,
)
from vibeam.flight.kernels.modal_flow import SILENT
from vibeam.flight.kernels.roots.signal import FORGOTTEN

Array = NDArray[np.float64]


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


class Panel(NamedTuple):
    """A panel of the walk: the blocks that still ring, of how many; the level of its length; the side of its node."""

    blocks: int
    whole: int
    level: int
    side: int


def lay_out(pairs: Array, table: Array, levels: Array, modes: Array, drive: Array, lanes: int) -> tuple[Array, Array]:
    """``cells`` and ``rungs`` of a packed system; empty where a mode does not take part in the contact."""
    n = pairs.shape[1]
    if np.min(np.abs(modes[CONTACT])) < SILENT:
        return np.zeros(0), np.zeros(0)
    blocks = -(-n // lanes)
    cells, rungs = np.zeros((CELL_ROWS, blocks * lanes)), np.zeros((LEVELS, RUNG_ROWS, blocks * lanes))
    turn = np.sqrt(np.maximum(-pairs[DISC], 0.0))
    contact, kappa = modes[CONTACT], pairs[KAPPA]
    cells[RATE, :n], cells[TURN, :n] = pairs[SIGMA], turn
    cells[TURN_INVERSE, :n] = 1.0 / np.where(turn > 0, turn, np.inf)
    cells[DAMP, :n], cells[SPRING, :n], cells[NORM, :n] = 2 * pairs[SIGMA], pairs[OMEGA] ** 2, pairs[INVERSE]
    cells[KICK, :n], cells[PUT, :n] = contact**2 / drive[MOBILITY], contact * modes[YIELD]
    for row, power in ((K1, 1), (K2, 2), (K4, 4), (K5, 5)):
        cells[row, :n] = kappa**power
    decay = np.full(blocks * lanes, np.inf)
    decay[:n] = pairs[DECAY]
    mixed = np.zeros(blocks * lanes)
    mixed[:n] = pairs[DISC] >= 0
    cells[SLOWEST] = np.repeat(decay.reshape(blocks, lanes).min(axis=1), lanes)
    cells[MIXED] = np.repeat(mixed.reshape(blocks, lanes).max(axis=1), lanes)
    rungs[:, :8, :n] = np.moveaxis(table, 0, 1)
    low = (np.arange(n)[None, :] < levels[COUNT][:, None]).astype(float)
    h4 = levels[STEP][:, None] ** 4
    rungs[:, LOW, :n] = low
    rungs[:, MISSED, :n] = low * kappa**4 * h4 / 384 + (1 - low)
    rungs[:, MISSED_FIRST, :n] = low * kappa**5 * h4 / (384 * 5) + (1 - low) * kappa
    return (
        np.ascontiguousarray(np.moveaxis(cells.reshape(CELL_ROWS, blocks, lanes), 1, 0)).ravel(),
        np.ascontiguousarray(np.moveaxis(rungs.reshape(LEVELS, RUNG_ROWS, blocks, lanes), 2, 1)).ravel(),
    )


def longest_flight(pairs: Array) -> float:
    """How long a flight's closed form keeps its digits: by the fastest mode that does not decay before."""
    turn = np.sqrt(np.maximum(-pairs[DISC], 0.0))
    ringing = turn[pairs[DECAY] * REDUCED < FORGOTTEN * turn]
    return float(REDUCED / np.max(ringing, initial=1e-300))


@joined
def cell(block: int, row: int, like: Lanes) -> int:
    """Where a row of a block begins."""
    lanes: int = width(like)
    return (block * CELL_ROWS + row) * lanes


@joined
def rung(level: int, blocks: int, block: int, row: int, like: Lanes) -> int:
    """Where a row of a block at one panel length begins."""
    lanes: int = width(like)
    return ((level * blocks + block) * RUNG_ROWS + row) * lanes


@joined
def at_mode(k: int, row: int, like: Lanes) -> int:
    """Where a row has its number of mode k."""
    lanes: int = width(like)
    return ((k // lanes) * CELL_ROWS + row) * lanes + k % lanes


@joined
def gather(pairs: Array, cells: Array, like: Lanes) -> None:
    """START_X, START_Y receive the pairs x, x' at the start of a flight, from ``begin_flight``."""
    for k in range(pairs.shape[1]):
        cells[at_mode(k, START_X, like)], cells[at_mode(k, START_Y, like)] = pairs[X0, k], pairs[Y0, k]


@joined
def scatter(desk: Engine, pose: Array, row: int, phase: Phase, like: Lanes) -> None:
    """Set ``pose`` to the pairs in ``row`` and the next, at that phase φ.

    η_k = −x_k/w_k + Im(H_k e^{iφ}) + s_k/ω_k², η_k' = −x_k'/w_k + Ω Re(H_k e^{iφ}).
    """
    cells, modes, w = desk.cells, desk.modes, desk.drive[W]
    cosine, sine = phase
    for k in range(pose.shape[1]):
        c = modes[CONTACT, k]
        pose[0, k] = -cells[at_mode(k, row, like)] / c + modes[OFFSET, k] + modes[RE, k] * sine + modes[IM, k] * cosine
        pose[1, k] = -cells[at_mode(k, row + 1, like)] / c + w * (modes[RE, k] * cosine - modes[IM, k] * sine)
