"""The free system as blocks of modes for the kernels' lanes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.lanes.layout import (
    CELL_ROWS,
    DAMP,
    K1,
    K2,
    K4,
    K5,
    KICK,
    LOW,
    MISSED,
    MISSED_FIRST,
    MIXED,
    NORM,
    PUT,
    RATE,
    RUNG_ROWS,
    SLOWEST,
    SPRING,
    TURN,
    TURN_INVERSE,
)
from vibeam.flight.kernels.layout import (
    CONTACT,
    COUNT,
    DECAY,
    DISC,
    INVERSE,
    KAPPA,
    LEVELS,
    MOBILITY,
    OMEGA,
    RESTITUTION,
    SIGMA,
    SLOW,
    STEP,
    YIELD,
)
from vibeam.flight.kernels.thresholds import ELASTIC, FORGOTTEN, LINGERING, REDUCED, SILENT

Array = NDArray[np.float64]


def lay_out(pairs: Array, table: Array, levels: Array, modes: Array, drive: Array, lanes: int) -> tuple[Array, Array]:
    """``cells`` and ``rungs`` of a packed system; empty where a mode takes no part in the contact.

    Or where one far beyond critical damping lingers, which the lanes bound by its fast decay; or where damped impacts
    may go on without end: the lanes know the end of a flight to round-off of the displacement, not of the flight.
    """
    n = pairs.shape[1]
    lingering = (pairs[SLOW] > 0) & (pairs[SLOW] * levels[STEP, 0] < LINGERING)
    unending = 1.0 - drive[RESTITUTION] < ELASTIC and np.any(pairs[SIGMA] > 0)
    if np.min(np.abs(modes[CONTACT])) < SILENT or np.any(lingering) or unending:
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
    rungs[:, :8, :n] = np.moveaxis(table[:8], 0, 1)
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
