"""The free system as blocks of modes for the kernels' lanes."""

from __future__ import annotations

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.lanes import layout as block_layout
from vibeam.flight.kernels.thresholds import ELASTIC, FORGOTTEN, LINGERING, REDUCED, SILENT
from vibeam_models.arrays import Array


def lay_out(pairs: Array, table: Array, levels: Array, modes: Array, drive: Array, lanes: int) -> tuple[Array, Array]:
    """``cells`` and ``rungs`` of a packed system; empty where a mode takes no part in the contact.

    Or where one far beyond critical damping lingers, which the lanes bound by its fast decay; or where damped impacts
    may go on without end: the lanes know the end of a flight to round-off of the displacement, not of the flight.
    """
    n = pairs.shape[1]
    lingering = (pairs[layout.SLOW] > 0) & (pairs[layout.SLOW] * levels[layout.STEP, 0] < LINGERING)
    unending = 1.0 - drive[layout.RESTITUTION] < ELASTIC and np.any(pairs[layout.SIGMA] > 0)
    if np.min(np.abs(modes[layout.CONTACT])) < SILENT or np.any(lingering) or unending:
        return np.zeros(0), np.zeros(0)
    blocks = -(-n // lanes)
    cells, rungs = (
        np.zeros((block_layout.CELL_ROWS, blocks * lanes)),
        np.zeros((layout.LEVELS, block_layout.RUNG_ROWS, blocks * lanes)),
    )
    turn = np.sqrt(np.maximum(-pairs[layout.DISC], 0.0))
    contact, kappa = modes[layout.CONTACT], pairs[layout.KAPPA]
    cells[block_layout.RATE, :n], cells[block_layout.TURN, :n] = pairs[layout.SIGMA], turn
    cells[block_layout.TURN_INVERSE, :n] = 1.0 / np.where(turn > 0, turn, np.inf)
    cells[block_layout.DAMP, :n], cells[block_layout.SPRING, :n], cells[block_layout.NORM, :n] = (
        2 * pairs[layout.SIGMA],
        pairs[layout.OMEGA] ** 2,
        pairs[layout.INVERSE],
    )
    cells[block_layout.KICK, :n], cells[block_layout.PUT, :n] = (
        contact**2 / drive[layout.MOBILITY],
        contact * modes[layout.YIELD],
    )
    for row, power in ((block_layout.K1, 1), (block_layout.K2, 2), (block_layout.K4, 4), (block_layout.K5, 5)):
        cells[row, :n] = kappa**power
    decay = np.full(blocks * lanes, np.inf)
    decay[:n] = pairs[layout.DECAY]
    mixed = np.zeros(blocks * lanes)
    mixed[:n] = pairs[layout.DISC] >= 0
    cells[block_layout.SLOWEST] = np.repeat(decay.reshape(blocks, lanes).min(axis=1), lanes)
    cells[block_layout.MIXED] = np.repeat(mixed.reshape(blocks, lanes).max(axis=1), lanes)
    rungs[:, :8, :n] = np.moveaxis(table[:8], 0, 1)
    low = (np.arange(n)[None, :] < levels[layout.COUNT][:, None]).astype(float)
    h4 = levels[layout.STEP][:, None] ** 4
    rungs[:, block_layout.LOW, :n] = low
    rungs[:, block_layout.MISSED, :n] = low * kappa**4 * h4 / 384 + (1 - low)
    rungs[:, block_layout.MISSED_FIRST, :n] = low * kappa**5 * h4 / (384 * 5) + (1 - low) * kappa
    return (
        np.ascontiguousarray(np.moveaxis(cells.reshape(block_layout.CELL_ROWS, blocks, lanes), 1, 0)).ravel(),
        np.ascontiguousarray(
            np.moveaxis(rungs.reshape(layout.LEVELS, block_layout.RUNG_ROWS, blocks, lanes), 2, 1)
        ).ravel(),
    )


def longest_flight(pairs: Array) -> float:
    """How long a flight's closed form keeps its digits: by the fastest mode that does not decay before."""
    turn = np.sqrt(np.maximum(-pairs[layout.DISC], 0.0))
    ringing = turn[pairs[layout.DECAY] * REDUCED < FORGOTTEN * turn]
    return float(REDUCED / np.max(ringing, initial=1e-300))
