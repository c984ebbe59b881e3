"""Flights of one point, a flight a lane, set out to be read off: each mode's free motion at their starts."""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.energy import SPLIT
from vibeam.flight.kernels.lanes.simd import Lanes, eight, load, store
from vibeam.flight.kernels.layout import Engine
from vibeam.flight.kernels.thresholds import REDUCED
from vibeam.flight.points.kernels import layout as row

Array = NDArray[np.float64]


@joined
def flight(k: int, which: int) -> int:
    """Where a row of mode k begins."""
    return (row.FLIGHT_COMMON + k * row.FLIGHT_ROWS + which) * row.WIDTH


@kernel
def is_readable(engine: Engine) -> bool:
    """Whether flights may be read off side by side: every mode clearly underdamped, in a phase that can be reduced."""
    found = engine.signal[layout.ATTACHED] == 0.0
    for k in range(engine.pairs.shape[1]):
        disc, own = engine.pairs[layout.DISC, k], engine.pairs[layout.OMEGA, k]
        found = found and disc <= -SPLIT * SPLIT * own * own and disc < 0.0
        found = found and sqrt(max(-disc, 0.0)) * engine.drive[layout.PERIOD] < REDUCED
    return bool(found)


@joined
def set_flight(rows: Array, slot: int, clock: float, span: float, pose: Array) -> None:
    """A flight in its lane."""
    rows[row.FLIGHT_CLOCK * row.WIDTH + slot], rows[row.FLIGHT_SPAN * row.WIDTH + slot] = clock, span
    for k in range(pose.shape[1]):
        rows[flight(k, row.FLIGHT_U) + slot], rows[flight(k, row.FLIGHT_V) + slot] = pose[0, k], pose[1, k]


@joined
def set_no_flight(rows: Array, slot: int, n: int) -> None:
    """No flight in that lane."""
    rows[row.FLIGHT_CLOCK * row.WIDTH + slot], rows[row.FLIGHT_SPAN * row.WIDTH + slot] = 0.0, 0.0
    for k in range(n):
        rows[flight(k, row.FLIGHT_U) + slot], rows[flight(k, row.FLIGHT_V) + slot] = 0.0, 0.0


@joined
def take_steady_out(modes: Array, drive: Array, rows: Array, cosine: Lanes, sine: Lanes) -> None:
    """FLIGHT_U, FLIGHT_V, the modes' displacements and velocities so far, less the steady response."""
    like, w = eight(), drive[layout.W]
    for k in range(modes.shape[1]):
        re, im = modes[layout.RE, k], modes[layout.IM, k]
        x, y = load(rows, flight(k, row.FLIGHT_U), like), load(rows, flight(k, row.FLIGHT_V), like)
        store(rows, flight(k, row.FLIGHT_U), (x - modes[layout.OFFSET, k]) - (re * sine + im * cosine))
        store(rows, flight(k, row.FLIGHT_V), y - w * (re * cosine - im * sine))
