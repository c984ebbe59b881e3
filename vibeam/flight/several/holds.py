"""From when to when contacts were held, read off a trace."""

from __future__ import annotations

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.several.motion import HELD
from vibeam_models.arrays import Array


def holds_of(trace: Array, end: float, contact: int | None) -> Array:
    """(m, 2): begin and end, s, of the stretches of a motion until ``end`` in which a contact, or any, was held.

    A hold begins where the accumulation of impacts before it is over.
    """
    bits = trace[:, HELD].astype(np.int64)
    held = (bits if contact is None else bits >> contact & 1) > 0
    change = np.diff(np.concatenate([[False], held, [False]]).astype(int))
    times, first = np.append(trace[:, layout.START], end), np.flatnonzero(change == 1)
    before = trace[np.maximum(first - 1, 0)]
    accumulated = (first > 0) & (before[:, layout.END] == layout.CHATTER)
    accumulated &= (contact is None) | (before[:, regime_layout.AT_SIDE] == contact)
    return np.stack([times[first] + np.where(accumulated, before[:, layout.LEFT], 0.0), times[change == -1]], axis=1)


def held_in(row: Array, count: int) -> tuple[int, ...]:
    """The contacts held in a segment, of its trace row."""
    bits = int(row[HELD])
    return tuple(j for j in range(count) if bits >> j & 1)
