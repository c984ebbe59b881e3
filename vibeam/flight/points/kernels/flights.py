"""Flights of one point, a flight a lane, set out to be read off: each mode's free motion at their starts."""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.energy import SPLIT
from vibeam.flight.kernels.lanes.simd import Lanes, eight, load, store
from vibeam.flight.kernels.layout import (
    ATTACHED,
    DISC,
    IM,
    OFFSET,
    OMEGA,
    PERIOD,
    RE,
    Engine,
    W,
)
from vibeam.flight.kernels.thresholds import REDUCED
from vibeam.flight.points.kernels.layout import (
    FLIGHT_CLOCK,
    FLIGHT_COMMON,
    FLIGHT_ROWS,
    FLIGHT_SPAN,
    FLIGHT_U,
    FLIGHT_V,
    WIDTH,
)

Array = NDArray[np.float64]


@joined
def flight(k: int, which: int) -> int:
    """Where a row of mode k begins."""
    return (FLIGHT_COMMON + k * FLIGHT_ROWS + which) * WIDTH


@kernel
def is_readable(desk: Engine) -> bool:
    """Whether flights may be read off side by side: every mode clearly underdamped, in a phase that can be reduced."""
    found = desk.signal[ATTACHED] == 0.0
    for k in range(desk.pairs.shape[1]):
        disc, own = desk.pairs[DISC, k], desk.pairs[OMEGA, k]
        found = found and disc <= -SPLIT * SPLIT * own * own and disc < 0.0
        found = found and sqrt(max(-disc, 0.0)) * desk.drive[PERIOD] < REDUCED
    return bool(found)


@joined
def set_flight(rows: Array, slot: int, clock: float, span: float, pose: Array) -> None:
    """A flight in its lane."""
    rows[FLIGHT_CLOCK * WIDTH + slot], rows[FLIGHT_SPAN * WIDTH + slot] = clock, span
    for k in range(pose.shape[1]):
        rows[flight(k, FLIGHT_U) + slot], rows[flight(k, FLIGHT_V) + slot] = pose[0, k], pose[1, k]


@joined
def set_no_flight(rows: Array, slot: int, n: int) -> None:
    """No flight in that lane."""
    rows[FLIGHT_CLOCK * WIDTH + slot], rows[FLIGHT_SPAN * WIDTH + slot] = 0.0, 0.0
    for k in range(n):
        rows[flight(k, FLIGHT_U) + slot], rows[flight(k, FLIGHT_V) + slot] = 0.0, 0.0


@joined
def take_steady_out(modes: Array, drive: Array, rows: Array, cosine: Lanes, sine: Lanes) -> None:
    """FLIGHT_U, FLIGHT_V, the modes' displacements and velocities so far, less the steady response."""
    like, w = eight(), drive[W]
    for k in range(modes.shape[1]):
        re, im = modes[RE, k], modes[IM, k]
        x, y = load(rows, flight(k, FLIGHT_U), like), load(rows, flight(k, FLIGHT_V), like)
        store(rows, flight(k, FLIGHT_U), (x - modes[OFFSET, k]) - (re * sine + im * cosine))
        store(rows, flight(k, FLIGHT_V), y - w * (re * cosine - im * sine))
