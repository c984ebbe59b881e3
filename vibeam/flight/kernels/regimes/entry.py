"""Entry points, which Python calls, as ``kernels.entry`` has them: of any regime.

Flight, rest on a hard stop, push of a linear one and retreat from it are all regimes of the same kind. Here is the
drive, too: the phasor tables of the regimes and the steady response of their blocks.
"""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.block_flow import advance_blocks, to_block_coordinates
from vibeam.flight.kernels.compiler import entry, kernel
from vibeam.flight.kernels.drive import carried_rate, coarsest_level, exact_period, steady_response
from vibeam.flight.kernels.entry import show, walk
from vibeam.flight.kernels.layout import PointSchedule, Watch
from vibeam.flight.kernels.regimes import layout as row
from vibeam.flight.kernels.regimes.events import advance, piece_of, regime_of
from vibeam.flight.kernels.regimes.layout import RegimeEngine
from vibeam.flight.kernels.regimes.readout import integrated_at, read_segment
from vibeam.flight.kernels.roots.pair import tabulate_drive
from vibeam.flight.kernels.roots.signal import signal_of
from vibeam.flight.kernels.segments import copy_pose
from vibeam.flight.kernels.steady_point import steady_kernel
from vibeam_models.arrays import Array, Index


@kernel
def set_drive(engine: RegimeEngine, omega: float, amplitude: float) -> None:
    """Put the engine under b = amplitude · sin(omega t)."""
    drive = engine.drive
    drive[layout.W], drive[layout.STRENGTH], drive[layout.AMPLITUDE] = omega, omega * omega * amplitude, amplitude
    drive[layout.PERIOD], drive[layout.PERIOD_REST] = exact_period(omega)
    rate = omega
    for regime in (engine.free, engine.upper, engine.lower):
        tabulate_drive(omega, regime.levels)
        steady_response(regime, drive)
        rate = max(rate, carried_rate(regime.pairs, regime.blocks))
    drive[layout.COARSEST] = coarsest_level(engine.free.pairs, engine.free.levels, rate)


steady_point = steady_kernel(advance, read_segment)
WATCHING = 1000  # panels that reading a segment off is as much work as, about


@entry
def move(
    engine: RegimeEngine, omega: float, amplitude: float, pose: Array, status: Array, span: float, settle: int,
    hold: int, limit: int, watch: Watch, counts: Index, longest: int,
) -> tuple[int, float]:  # fmt: skip
    """Carry ``pose`` on under one drive: as the flight kernels' ``move``."""
    set_drive(engine, omega, amplitude)
    if span > 0.0:
        return advance(engine, pose, status, span, limit, watch.trace, watch.poses, counts)
    schedule = PointSchedule(settle, hold, limit, longest, piece_of(engine, pose), WATCHING)
    return steady_point(engine, engine.omega, pose, status, schedule, watch, counts)


@entry
def poses_at(
    engine: RegimeEngine, omega: float, amplitude: float, trace: Array, poses: Array, which: Index,
    after: Array, pose: Array, out: Array,
) -> None:  # fmt: skip
    """Set out[i] (2, n) to the pose a time after[i] into segment which[i]."""
    set_drive(engine, omega, amplitude)
    for i in range(len(which)):
        segment = which[i]
        copy_pose(poses[segment], pose)
        clock, what = trace[segment, layout.AT_CLOCK], trace[segment, layout.WHAT]
        side = int(trace[segment, row.AT_SIDE])
        if after[i] > 0.0 and what == row.CONTACT and engine.law[row.FAMILY] == row.CURVED:
            integrated_at(engine, pose, side, clock, after[i])
        elif after[i] > 0.0:
            regime = regime_of(engine, what, side)
            to_block_coordinates(regime, engine.drive, pose, clock)
            advance_blocks(regime, engine.drive, pose, clock, after[i])
        copy_pose(pose, out[i])


@entry
def cover(
    engine: RegimeEngine, omega: float, amplitude: float, trace: Array, poses: Array, tasks: Array, first: int,
    pieces: Array,
) -> tuple[int, int]:  # fmt: skip
    """Fill ``pieces`` from task ``first`` on: pieces written, the first task that found no room."""
    set_drive(engine, omega, amplitude)
    count, entered, coarsest = 0, -1, int(engine.drive[layout.COARSEST])
    for i in range(first, tasks.shape[0]):
        segment = int(tasks[i, layout.TASK_SEGMENT])
        clock, side = trace[segment, layout.AT_CLOCK], int(trace[segment, row.AT_SIDE])
        regime = regime_of(engine, trace[segment, layout.WHAT], side)
        if segment != entered:
            to_block_coordinates(regime, engine.drive, poses[segment], clock)
            entered = segment
        show(regime, engine.drive, clock, tasks[i])
        written = walk(signal_of(regime), coarsest, trace[segment, layout.DURATION], tasks[i], pieces, count)
        if written < 0:
            return count, i
        count += written
    return count, tasks.shape[0]
