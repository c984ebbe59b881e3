"""The intervals that cover a segment in any regime: as ``vibeam.flight.kernels.cover``, of block flow.

Flight, rest on a hard stop, push of a linear one and retreat from it are all regimes of the same kind.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.block_flow import to_block_coordinates
from vibeam.flight.kernels.compiler import entry
from vibeam.flight.kernels.cover import show, walk
from vibeam.flight.kernels.pieces import SEGMENT
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.kernels.regimes.drive import set_drive
from vibeam.flight.kernels.regimes.layout import RegimeEngine
from vibeam.flight.kernels.roots.signal import signal_of

Array = NDArray[np.float64]


@entry
def cover(
    engine: RegimeEngine, omega: float, amplitude: float, trace: Array, poses: Array, tasks: Array, first: int,
    pieces: Array,
) -> tuple[int, int]:  # fmt: skip
    """Fill ``pieces`` from task ``first`` on: pieces written, the first task that found no room."""
    set_drive(engine, omega, amplitude)
    count, entered, coarsest = 0, -1, int(engine.drive[layout.COARSEST])
    for i in range(first, tasks.shape[0]):
        segment = int(tasks[i, SEGMENT])
        clock, regime = trace[segment, layout.AT_CLOCK], engine.free
        if trace[segment, layout.WHAT] != layout.FREE:
            regime = engine.upper if trace[segment, regime_layout.AT_SIDE] == 0.0 else engine.lower
        if segment != entered:
            to_block_coordinates(regime, engine.drive, poses[segment], clock)
            entered = segment
        show(regime, engine.drive, clock, tasks[i])
        written = walk(signal_of(regime), coarsest, trace[segment, layout.DURATION], tasks[i], pieces, count)
        if written < 0:
            return count, i
        count += written
    return count, tasks.shape[0]
