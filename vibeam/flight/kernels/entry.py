"""Entry points, which Python calls: motions and steady points, poses, the intervals that cover a segment.

``cover`` walks as ``roots.first_root`` does, but along a segment whose end is known, and writes its panels down: a
bound says that a signal is positive on each, and on the last that it closes once. A signal is a gap or a contact force
(``layout``: ``GAP_SIGNAL``, ``FORCE_SIGNAL``, each plus the side), or its negative (plus ``NEGATIVE``).
"""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.block_flow import advance_blocks, set_signal, to_block_coordinates
from vibeam.flight.kernels.compiler import entry, joined, kernel
from vibeam.flight.kernels.drive import phase, set_drive
from vibeam.flight.kernels.events import advance, piece_of
from vibeam.flight.kernels.layout import Engine, PointSchedule, Regime, Watch
from vibeam.flight.kernels.modal_flow import begin_flight, end_flight
from vibeam.flight.kernels.readout import read_segment
from vibeam.flight.kernels.roots import taylor_pairs as att
from vibeam.flight.kernels.roots.bounds import CLEAR, MINIMUM, ROOT, SPLIT
from vibeam.flight.kernels.roots.first_root import first_level
from vibeam.flight.kernels.roots.newton import EPSILON, polish_minimum
from vibeam.flight.kernels.roots.pair import norm
from vibeam.flight.kernels.roots.panels import Node, accept, launching, next_node, ordinary, step_pairs
from vibeam.flight.kernels.roots.signal import EventSignal, Start, derivatives, signal_of, to_node, value_at
from vibeam.flight.kernels.segments import copy_pose
from vibeam.flight.kernels.steady_point import steady_kernel
from vibeam_models.arrays import Array, Index

steady_point = steady_kernel(advance, read_segment)
WATCHING = 64  # panels that reading a segment off is as much work as, about
MOST_DOUBTS = 64  # pieces without proof after which the rest of a segment is one of them
CLOSE = 1e-10  # share of the segment's length within which the signal must vanish at its end


@entry
def move(
    engine: Engine, omega: float, amplitude: float, pose: Array, status: Array, span: float, settle: int, hold: int,
    limit: int, watch: Watch, counts: Index, longest: int,
) -> tuple[int, float]:  # fmt: skip
    """Carry ``pose`` on under one drive; one function for both uses, so that the engine is compiled once.

    span > 0: every segment of that time goes to ``watch.trace``: outcome, time done; at most ``limit`` impacts in
    counts[IMPACTS]. Otherwise a point of a sweep, ``settle`` and ``hold`` periods watched: outcome, period (0 where the
    motion does not repeat). PAUSED: called again with the same arguments it goes on as if it had not been.
    """
    set_drive(engine, omega, amplitude)
    if span > 0.0:
        return advance(engine, pose, status, span, limit, watch.trace, watch.poses, counts)
    schedule = PointSchedule(settle, hold, limit, longest, piece_of(pose), WATCHING)
    return steady_point(engine, engine.pairs[layout.OMEGA], pose, status, schedule, watch, counts)


@entry
def poses_at(
    engine: Engine, omega: float, amplitude: float, trace: Array, poses: Array, which: Index, after: Array,
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


@entry
def cover(
    engine: Engine, omega: float, amplitude: float, trace: Array, poses: Array, tasks: Array, first: int, pieces: Array
) -> tuple[int, int]:
    """Fill ``pieces`` from task ``first`` on: pieces written, the first task that found no room.

    ``trace`` (m, TRACE_COLUMNS), ``poses`` (m, 2, n); ``tasks`` (k, 5) in the order of the segments.
    """
    set_drive(engine, omega, amplitude)
    count, coarsest, at_rest = 0, int(engine.drive[layout.COARSEST]), int(engine.drive[layout.COARSEST_AT_REST])
    for i in range(first, tasks.shape[0]):
        segment = int(tasks[i, layout.TASK_SEGMENT])
        clock, pose = trace[segment, layout.AT_CLOCK], poses[segment]
        if trace[segment, layout.WHAT] == layout.RESTING:
            to_block_coordinates(engine.rest, engine.drive, pose, clock)
            show(engine.rest, engine.drive, clock, tasks[i])
            written = walk(signal_of(engine.rest), at_rest, trace[segment, layout.DURATION], tasks[i], pieces, count)
        else:
            cosine, sine = phase(engine.drive, clock)
            begin_flight(engine, pose, cosine, sine)
            written = walk(signal_of(engine), coarsest, trace[segment, layout.DURATION], tasks[i], pieces, count)
        if written < 0:
            return count, i
        count += written
    return count, tasks.shape[0]


@joined
def show(regime: Regime, drive: Array, clock: float, task: Array) -> None:
    """Make the task's signal that of the regime, whose block coordinates are set."""
    which, sign = int(task[layout.TASK_SIGNAL]), 1.0
    if which >= layout.NEGATIVE:
        which, sign = which - layout.NEGATIVE, -1.0
    set_signal(regime, drive, which, sign, clock)


@kernel
def walk(g: EventSignal, coarsest: int, duration: float, task: Array, pieces: Array, row: int) -> int:
    """Pieces of one signal, just begun, over its segment, written from ``row`` on; −1 where there is no room for them.

    The verdicts are those of ``bounds.verdict``. The last panel reaches beyond the segment's end; where the signal
    closes, also one that is not clear and ends less than ``CLOSE`` of the length before it, for a root at a panel's end
    may lie on either side of it by round-off. That panel must hold one root (or, where a graze leaves that in doubt,
    the signal must vanish at the end, to ``CLOSE`` of the length), and the signal must be seen to start above zero, or
    to rise from it by its order. Elsewhere a panel is halved until nothing of it is in doubt.
    """
    pairs, table, levels, signal, attached = g
    start = Start(int(task[layout.TASK_ORDER]), task[layout.TASK_RISE])
    total = to_node(pairs)
    if signal[layout.ATTACHED] > 0.0:
        att.restart(attached, signal)
    re, im = signal[layout.ZR], signal[layout.ZI]
    signal[layout.HARMONIC] = norm(re, im)
    size = abs(signal[layout.CONST]) + signal[layout.HARMONIC] + total
    tolerance = 8.0 * EPSILON * (size + att.swing(attached, signal, duration))
    never = signal[layout.CONST] - signal[layout.HARMONIC] - total > tolerance and signal[layout.ATTACHED] == 0.0
    closing = task[layout.CLOSING] > 0.0
    if never and start.order == 0 and not closing:
        return note(pieces, row, task, 0.0, duration, layout.OPEN)
    node, level, since, count, doubts = Node(0.0, re, im), coarsest, 0, 0, 0
    begun = start.order > 0 or not closing or value_at(g, 0.0, 0.0)[0] > tolerance
    if start.order > 0:
        derivatives(g, pairs.shape[1], layout.WHOLE, start.order + 1)
        level = first_level(g, start, coarsest, size)
    while node.time < duration:
        h, time = levels[layout.STEP, level], node.time
        here = Start(start.order if time == 0.0 else 0, start.rise)
        found = launching(g, start, level) if here.order > 0 else ordinary(g, node, level, tolerance)
        if found == SPLIT and level < layout.LEVELS - 1:
            level += 1
            since = 0
            continue
        if found == MINIMUM:
            _, value = polish_minimum(g, here, time, h)
            found = CLEAR if value > 0.0 else found
        near = closing and found != CLEAR and time + h >= (1.0 - CLOSE) * duration
        last = time + h >= duration or near
        claim = layout.OPEN if found == CLEAR else layout.UNPROVED
        if last and closing:
            closed = found == ROOT or vanishes(g, time, duration, tolerance)
            claim = layout.CLOSES if closed and (begun or time > 0.0) else layout.UNPROVED
        elif last and found != CLEAR and level < layout.LEVELS - 1:
            level += 1
            since = 0
            continue
        doubts += 1 if claim == layout.UNPROVED else 0
        last = last or doubts > MOST_DOUBTS
        if note(pieces, row + count, task, time, duration - time if last else h, claim) < 0:
            return -1
        count += 1
        if last:
            break
        if here.order > 0:
            step_pairs(pairs, table, level)
        if signal[layout.ATTACHED] > 0.0:
            att.carry(attached, signal, time, h)
        accept(g)
        node = next_node(levels, level, node)
        since += 1
        if level > coarsest and since > 1:
            level -= 1
            since = 0
    return count


@joined
def note(pieces: Array, row: int, task: Array, time: float, length: float, claim: float) -> int:
    """Write a piece: how many were written, −1 where there is no room."""
    if row >= pieces.shape[0]:
        return -1
    piece = pieces[row]
    piece[layout.PIECE_SEGMENT], piece[layout.PIECE_SIGNAL] = task[layout.TASK_SEGMENT], task[layout.TASK_SIGNAL]
    piece[layout.BEGIN], piece[layout.LENGTH], piece[layout.CLAIM] = time, length, claim
    return 1


@kernel
def vanishes(g: EventSignal, node: float, t: float, tolerance: float) -> bool:
    """True where the signal is 0 at t, or within ``CLOSE`` of it."""
    value, slope, _ = value_at(g, node, t)
    return abs(value) <= CLOSE * t * abs(slope) + 64.0 * tolerance
