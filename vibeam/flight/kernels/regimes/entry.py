"""Entry points: what Python calls."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.block_flow import advance_blocks, to_block_coordinates
from vibeam.flight.kernels.compiler import entry
from vibeam.flight.kernels.layout import AT_CLOCK, FREE, WHAT, Schedule, Watch
from vibeam.flight.kernels.regimes.contact_integration import integrated_at
from vibeam.flight.kernels.regimes.drive import set_drive
from vibeam.flight.kernels.regimes.events import advance, at_side, piece_of
from vibeam.flight.kernels.regimes.layout import AT_SIDE, CONTACT, CURVED, FAMILY, RegimeEngine
from vibeam.flight.kernels.regimes.readout import read_segment
from vibeam.flight.kernels.segments import copy_pose
from vibeam.flight.kernels.steady_point import steady_kernel

Array = NDArray[np.float64]

steady_point = steady_kernel(advance, read_segment)

WATCHING = 1000  # panels that reading a segment off is as much work as, about


@entry
def move(
    plan: RegimeEngine, omega: float, amplitude: float, pose: Array, status: Array, span: float, settle: int, hold: int,
    limit: int, room: Watch, counts: NDArray[np.int64], longest: int,
) -> tuple[int, float]:  # fmt: skip
    """Carry ``pose`` on under one drive: as the flight kernels' ``move``."""
    set_drive(plan, omega, amplitude)
    if span > 0.0:
        return advance(plan, pose, status, span, limit, room.trace, room.poses, counts)
    schedule = Schedule(settle, hold, limit, longest, piece_of(plan, pose), WATCHING)
    return steady_point(plan, plan.omega, pose, status, schedule, room, counts)


@entry
def poses_at(
    plan: RegimeEngine, omega: float, amplitude: float, trace: Array, poses: Array, which: NDArray[np.int64],
    after: Array, pose: Array, out: Array,
) -> None:  # fmt: skip
    """Set out[i] (2, n) to the pose a time after[i] into segment which[i]."""
    set_drive(plan, omega, amplitude)
    for i in range(len(which)):
        segment = which[i]
        copy_pose(poses[segment], pose)
        clock, what, side = trace[segment, AT_CLOCK], trace[segment, WHAT], int(trace[segment, AT_SIDE])
        if after[i] > 0.0 and what == CONTACT and plan.law[FAMILY] == CURVED:
            integrated_at(plan, pose, side, clock, after[i])
        elif after[i] > 0.0:
            regime = plan.free
            if what != FREE:
                regime = at_side(plan, side)
            to_block_coordinates(regime, plan.drive, pose, clock)
            advance_blocks(regime, plan.drive, pose, clock, after[i])
        copy_pose(pose, out[i])
