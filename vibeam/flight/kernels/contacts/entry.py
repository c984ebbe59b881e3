"""Entry points, which Python calls, as ``kernels.entry`` has them: of systems with several contacts."""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.block_energy import energy_by_mode, energy_in_blocks, is_modal
from vibeam.flight.kernels.block_flow import advance_blocks, set_signal, to_block_coordinates
from vibeam.flight.kernels.compiler import entry, kernel
from vibeam.flight.kernels.contacts import layout as row
from vibeam.flight.kernels.contacts.course import LOADED, WORK, OutputWatch
from vibeam.flight.kernels.contacts.events import advance, piece_of
from vibeam.flight.kernels.contacts.integrated import integrated_at, read_integrated
from vibeam.flight.kernels.contacts.integration import is_integrated
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.contacts.load.extremes import read_flow, read_steps
from vibeam.flight.kernels.contacts.load.poses import carry_loaded, enter_loaded, leave_loaded
from vibeam.flight.kernels.contacts.sets import key_of, regime_of, set_drive, slot_of
from vibeam.flight.kernels.contacts.signals import show
from vibeam.flight.kernels.entry import walk
from vibeam.flight.kernels.layout import PointSchedule, Watch
from vibeam.flight.kernels.readout import ACCURACY, LIGHTLY, extremes_to, widen_output
from vibeam.flight.kernels.regimes import layout as regime_row
from vibeam.flight.kernels.regimes.contact_motion import leading_order
from vibeam.flight.kernels.regimes.entry import WATCHING
from vibeam.flight.kernels.roots.signal import signal_of
from vibeam.flight.kernels.segments import copy_pose
from vibeam.flight.kernels.steady_point import steady_kernel
from vibeam_models.arrays import Array, Index


@kernel
def slot_at(engine: ContactEngine, segment: Array) -> int:
    """The set of a traced segment."""
    return slot_of(engine, key_of(engine, segment[row.HELD_AT], segment[row.PUSHED_AT]))


@kernel
def read_segment(engine: ContactEngine, watch: Watch, i: int) -> None:
    """Read off the i-th segment just traced, from its first pose in ``watch.frame``."""
    line, result = watch.trace[i], watch.result
    if is_integrated(engine, line[row.PUSHED_AT]):
        read_integrated(engine, watch, line)
        return
    clock, duration, slot = line[layout.AT_CLOCK], line[layout.DURATION], slot_at(engine, watch.trace[i])
    regime, coarsest, gap = regime_of(engine, slot), int(engine.coarsest[slot]), engine.gaps[0]
    share = ACCURACY if watch.reading >= layout.EVERYTHING else LIGHTLY
    to_block_coordinates(regime, engine.drive, watch.frame, clock)
    if watch.reading >= layout.REACH_TOO:
        set_signal(regime, engine.drive, layout.GAP_SIGNAL, 1.0, clock)
        reached = gap - result[layout.CONTACT_LEAST]
        _, widest = extremes_to(signal_of(regime), duration, coarsest, reached, reached, share)
        result[layout.CONTACT_LEAST] = gap - widest
    set_signal(regime, engine.drive, 2 * engine.rows.shape[0], 1.0, clock)
    widen_output(signal_of(regime), duration, coarsest, result, share)
    if watch.reading >= layout.EVERYTHING and is_modal(regime):
        energy_by_mode(regime, engine.drive, clock, duration, watch.energy)
    elif watch.reading >= layout.EVERYTHING:
        energy_in_blocks(regime, engine.drive, engine.omega, clock, duration, watch)


steady_point = steady_kernel(advance, read_segment)


@entry
def move(
    engine: ContactEngine, omega: float, amplitude: float, pose: Array, status: Array, span: float, settle: int,
    hold: int, limit: int, watch: Watch, counts: Index, longest: int,
) -> tuple[int, float]:  # fmt: skip
    """Carry ``pose`` on under one drive, as the flight kernels' ``move``; PAUSED where status[WANTED] is a set too."""
    set_drive(engine, omega, amplitude)
    if span > 0.0:
        return advance(engine, pose, status, span, limit, watch.trace, watch.poses, counts)
    schedule = PointSchedule(settle, hold, limit, longest, piece_of(engine, pose), WATCHING)
    return steady_point(engine, engine.omega, pose, status, schedule, watch, counts)


@entry
def poses_at(
    engine: ContactEngine, omega: float, amplitude: float, trace: Array, poses: Array, which: Index, after: Array,
    pose: Array, out: Array,
) -> None:  # fmt: skip
    """Set out[i] (2, n) to the pose a time after[i] into segment which[i], whose sets have been made."""
    set_drive(engine, omega, amplitude)
    entered, reached, slot, loaded = -1, 0.0, 0, engine.course.numbers[LOADED] > 0.0
    for i in range(len(which)):
        segment = which[i]
        copy_pose(poses[segment], pose)
        if loaded and after[i] > 0.0 and not is_integrated(engine, trace[segment, row.PUSHED_AT]):
            if segment != entered or after[i] < reached:
                entered, reached, slot = segment, 0.0, enter_loaded(engine, pose, trace[segment])
            carry_loaded(engine, regime_of(engine, slot), slot, after[i] - reached)
            leave_loaded(engine, slot, pose)
            reached = after[i]
        elif after[i] > 0.0 and is_integrated(engine, trace[segment, row.PUSHED_AT]):
            integrated_at(engine, pose, trace[segment], after[i])
        elif after[i] > 0.0:
            regime, clock = regime_of(engine, slot_at(engine, trace[segment])), trace[segment, layout.AT_CLOCK]
            to_block_coordinates(regime, engine.drive, pose, clock)
            advance_blocks(regime, engine.drive, pose, clock, after[i])
        copy_pose(pose, out[i])


@entry
def extremes_loaded(
    engine: ContactEngine, trace: Array, poses: Array, watch: OutputWatch, first: int
) -> tuple[int, int]:  # fmt: skip
    """Extremes of outputs over a motion under a load, whose sets have been made, into ``watch.found``.

    From segment ``first`` on: outcome, the segment that it ended in. PAUSED: called again with that one it goes on.
    """
    watch.walk[WORK] = 0.0
    for i in range(first, trace.shape[0]):
        if is_integrated(engine, trace[i, row.PUSHED_AT]):
            if watch.walk[WORK] >= piece_of(engine, poses[i]):
                return layout.PAUSED, i
            outcome = read_steps(engine, watch, trace[i], poses[i])
        else:
            outcome = read_flow(engine, watch, trace[i], poses[i])
        if outcome != layout.COMPLETE:
            return outcome, i
    return layout.COMPLETE, trace.shape[0]


@entry
def cover(
    engine: ContactEngine, omega: float, amplitude: float, trace: Array, poses: Array, tasks: Array, first: int,
    pieces: Array,
) -> tuple[int, int]:  # fmt: skip
    """Fill ``pieces`` from task ``first`` on: pieces written, the first task that found no room.

    Of a task whose order is UNKNOWN, a force that just began, order and rise are found here and written to it.
    """
    set_drive(engine, omega, amplitude)
    count, entered = 0, -1
    for i in range(first, tasks.shape[0]):
        segment, task = int(tasks[i, layout.TASK_SEGMENT]), tasks[i]
        clock, slot = trace[segment, layout.AT_CLOCK], slot_at(engine, trace[segment])
        regime, coarsest = regime_of(engine, slot), int(engine.coarsest[slot])
        if segment != entered:
            to_block_coordinates(regime, engine.drive, poses[segment], clock)
            entered = segment
        value, rate, size = show(engine, regime, int(task[layout.TASK_SIGNAL]), clock)
        if task[layout.TASK_ORDER] == regime_row.UNKNOWN:
            order, rise = leading_order(regime, max(value, 0.0), rate, size)
            task[layout.TASK_ORDER], task[layout.TASK_RISE] = max(order, 0), rise
        written = walk(signal_of(regime), coarsest, trace[segment, layout.DURATION], task, pieces, count)
        if written < 0:
            return count, i
        count += written
    return count, tasks.shape[0]
