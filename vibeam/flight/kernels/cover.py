"""The intervals that cover a segment: on each a bound says that a signal is positive, on the last that it closes once.

The same walk as ``roots.first_root``, but along a segment whose end is known, and written down. A signal is a gap or a
contact force (``layout``: ``GAP_SIGNAL``, ``FORCE_SIGNAL``, each plus the side), or its negative (plus ``NEGATIVE``).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.block_flow import set_signal, to_block_coordinates
from vibeam.flight.kernels.compiler import entry, joined, kernel
from vibeam.flight.kernels.drive import phase, set_drive
from vibeam.flight.kernels.layout import Engine, Regime
from vibeam.flight.kernels.modal_flow import begin_flight
from vibeam.flight.kernels.pieces import (
    CLAIM,
    CLOSES,
    CLOSING,
    FLIGHT,
    FROM,
    LENGTH,
    NEGATIVE,
    OPEN,
    ORDER,
    RISE,
    SEGMENT,
    SIGNAL,
    UNPROVED,
    WATCHED,
)
from vibeam.flight.kernels.roots import taylor_pairs as att
from vibeam.flight.kernels.roots.bounds import CLEAR, MINIMUM, ROOT, SPLIT
from vibeam.flight.kernels.roots.first_root import first_level
from vibeam.flight.kernels.roots.newton import EPSILON, polish_minimum
from vibeam.flight.kernels.roots.pair import norm
from vibeam.flight.kernels.roots.panels import Node, accept, launching, next_node, ordinary, step_pairs
from vibeam.flight.kernels.roots.signal import Signal, Start, derivatives, signal_of, to_node, value_at

Array = NDArray[np.float64]

MOST_DOUBTS = 64  # pieces without proof after which the rest of a segment is one of them

CLOSE = 1e-10  # share of the segment's length within which the signal must vanish at its end


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
        segment = int(tasks[i, SEGMENT])
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
    which, sign = int(task[WATCHED]), 1.0
    if which >= NEGATIVE:
        which, sign = which - NEGATIVE, -1.0
    set_signal(regime, drive, which, sign, clock)


@kernel
def walk(g: Signal, coarsest: int, duration: float, task: Array, pieces: Array, row: int) -> int:
    """Pieces of one signal, just begun, over its segment, written from ``row`` on; −1 where there is no room for them.

    The verdicts are those of ``bounds.verdict``. The last panel reaches beyond the segment's end; where the signal
    closes, also one that is not clear and ends less than ``CLOSE`` of the length before it, for a root at a panel's end
    may lie on either side of it by round-off. That panel must hold one root (or, where a graze leaves that in doubt,
    the signal must vanish at the end, to ``CLOSE`` of the length), and the signal must be seen to start above zero, or
    to rise from it by its order. Elsewhere a panel is halved until nothing of it is in doubt.
    """
    pairs, table, levels, signal, attached = g
    start = Start(int(task[ORDER]), task[RISE])
    total = to_node(pairs)
    if signal[layout.ATTACHED] > 0.0:
        att.restart(attached, signal)
    re, im = signal[layout.ZR], signal[layout.ZI]
    signal[layout.HARMONIC] = norm(re, im)
    size = abs(signal[layout.CONST]) + signal[layout.HARMONIC] + total
    tolerance = 8.0 * EPSILON * (size + att.swing(attached, signal, duration))
    never = signal[layout.CONST] - signal[layout.HARMONIC] - total > tolerance and signal[layout.ATTACHED] == 0.0
    if never and start.order == 0 and task[CLOSING] == 0.0:
        return note(pieces, row, task, 0.0, duration, OPEN)
    node, level, since, count, doubts = Node(0.0, re, im), coarsest, 0, 0, 0
    begun = start.order > 0 or task[CLOSING] == 0.0 or value_at(g, 0.0, 0.0)[0] > tolerance
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
        last = time + h >= duration or (task[CLOSING] > 0.0 and found != CLEAR and time + h >= (1.0 - CLOSE) * duration)
        claim = OPEN if found == CLEAR else UNPROVED
        if last and task[CLOSING] > 0.0:
            closed = found == ROOT or vanishes(g, time, duration, tolerance)
            claim = CLOSES if closed and (begun or time > 0.0) else UNPROVED
        elif last and found != CLEAR and level < layout.LEVELS - 1:
            level += 1
            since = 0
            continue
        doubts += 1 if claim == UNPROVED else 0
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
    pieces[row, FLIGHT], pieces[row, FROM], pieces[row, LENGTH] = task[SEGMENT], time, length
    pieces[row, CLAIM], pieces[row, SIGNAL] = claim, task[WATCHED]
    return 1


@kernel
def vanishes(g: Signal, node: float, t: float, tolerance: float) -> bool:
    """Whether the signal is 0 at t, or within ``CLOSE`` of it."""
    value, slope, _ = value_at(g, node, t)
    return abs(value) <= CLOSE * t * abs(slope) + 64.0 * tolerance
