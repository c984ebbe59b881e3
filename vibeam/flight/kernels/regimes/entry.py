"""Entry points: what Python calls."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.block_flow import advance_blocks, to_block_coordinates
from vibeam.flight.kernels.compiler import entry
from vibeam.flight.kernels.layout import Schedule, Watch
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.kernels.regimes.contact_integration import integrated_at
from vibeam.flight.kernels.regimes.drive import set_drive
from vibeam.flight.kernels.regimes.events import advance, at_side, piece_of
from vibeam.flight.kernels.regimes.layout import RegimeEngine
from vibeam.flight.kernels.regimes.readout import read_segment
from vibeam.flight.kernels.segments import copy_pose
from vibeam.flight.kernels.steady_point import steady_kernel

Array = NDArray[np.float64]

steady_point = steady_kernel(advance, read_segment)

WATCHING = 1000  # panels that reading a segment off is as much work as, about


@entry
def move(
    engine: RegimeEngine, omega: float, amplitude: float, pose: Array, status: Array, span: float, settle: int,
    hold: int, limit: int, watch: Watch, counts: NDArray[np.int64], longest: int,
) -> tuple[int, float]:  # fmt: skip
    """Carry ``pose`` on under one drive: as the flight kernels' ``move``."""
    set_drive(engine, omega, amplitude)
    if span > 0.0:
        return advance(engine, pose, status, span, limit, watch.trace, watch.poses, counts)
    schedule = Schedule(settle, hold, limit, longest, piece_of(engine, pose), WATCHING)
    return steady_point(engine, engine.omega, pose, status, schedule, watch, counts)


@entry
def poses_at(
    engine: RegimeEngine, omega: float, amplitude: float, trace: Array, poses: Array, which: NDArray[np.int64],
    after: Array, pose: Array, out: Array,
) -> None:  # fmt: skip
    """Set out[i] (2, n) to the pose a time after[i] into segment which[i]."""
    set_drive(engine, omega, amplitude)
    for i in range(len(which)):
        segment = which[i]
        copy_pose(poses[segment], pose)
        clock, what, side = (
            trace[segment, layout.AT_CLOCK],
            trace[segment, layout.WHAT],
            int(trace[segment, regime_layout.AT_SIDE]),
        )
        if (
            after[i] > 0.0
            and what == regime_layout.CONTACT
            and engine.law[regime_layout.FAMILY] == regime_layout.CURVED
        ):
            integrated_at(engine, pose, side, clock, after[i])
        elif after[i] > 0.0:
            regime = engine.free
            if what != layout.FREE:
                regime = at_side(engine, side)
            to_block_coordinates(regime, engine.drive, pose, clock)
            advance_blocks(regime, engine.drive, pose, clock, after[i])
        copy_pose(pose, out[i])
