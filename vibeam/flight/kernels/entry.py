"""Entry points: what Python calls. Each is one compiled function with one signature."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.block_flow import advance_blocks, to_block_coordinates
from vibeam.flight.kernels.compiler import entry
from vibeam.flight.kernels.drive import phase, set_drive
from vibeam.flight.kernels.events import advance, piece_of
from vibeam.flight.kernels.layout import Engine, Schedule, Watch
from vibeam.flight.kernels.modal_flow import begin_flight, end_flight
from vibeam.flight.kernels.readout import read_segment
from vibeam.flight.kernels.segments import copy_pose
from vibeam.flight.kernels.steady_point import steady_kernel

Array = NDArray[np.float64]

steady_point = steady_kernel(advance, read_segment)

WATCHING = 64  # panels that reading a segment off is as much work as, about


@entry
def move(
    engine: Engine, omega: float, amplitude: float, pose: Array, status: Array, span: float, settle: int, hold: int,
    limit: int, watch: Watch, counts: NDArray[np.int64], longest: int,
) -> tuple[int, float]:  # fmt: skip
    """Carry ``pose`` on under one drive; one function for both uses, so that the engine is compiled once.

    span > 0: every segment of that time goes to ``watch.trace``: outcome, time done; at most ``limit`` impacts in
    counts[IMPACTS]. Otherwise a point of a sweep, ``settle`` and ``hold`` periods watched: outcome, period (0 where the
    motion does not repeat). PAUSED: called again with the same arguments it goes on as if it had not been.
    """
    set_drive(engine, omega, amplitude)
    if span > 0.0:
        return advance(engine, pose, status, span, limit, watch.trace, watch.poses, counts)
    schedule = Schedule(settle, hold, limit, longest, piece_of(pose), WATCHING)
    return steady_point(engine, engine.pairs[layout.OMEGA], pose, status, schedule, watch, counts)


@entry
def poses_at(
    engine: Engine, omega: float, amplitude: float, trace: Array, poses: Array, which: NDArray[np.int64], after: Array,
    pose: Array, status: Array, out: Array,
) -> None:  # fmt: skip
    """Set out[i] (2, n) to the pose a time after[i] into segment which[i]."""
    set_drive(engine, omega, amplitude)
    for i in range(len(which)):
        segment = which[i]
        copy_pose(poses[segment], pose)
        clock = trace[segment, layout.AT_CLOCK]
        if after[i] == 0.0:
            pass
        elif trace[segment, layout.WHAT] == layout.RESTING:
            to_block_coordinates(engine.rest, engine.drive, pose, clock)
            advance_blocks(engine.rest, engine.drive, pose, clock, after[i])
        else:
            status[layout.CLOCK] = clock
            cosine, sine = phase(engine.drive, clock)
            begin_flight(engine, pose, cosine, sine)
            end_flight(engine, pose, status, after[i], False)
        copy_pose(pose, out[i])
