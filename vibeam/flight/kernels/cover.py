"""The intervals that cover a flight: on each a bound says that the gap stays open, on the last that it closes once.

The same walk as ``roots.first_root``, but along a flight whose end is known, and written down.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import entry, kernel
from vibeam.flight.kernels.drive import phase, set_drive
from vibeam.flight.kernels.layout import (
    AT_CLOCK,
    ATTACHED,
    CHATTER,
    COARSEST,
    CONST,
    DURATION,
    END,
    HARMONIC,
    IMPACT,
    LEVELS,
    RESTING,
    STEP,
    STUCK,
    WHAT,
    WHOLE,
    ZI,
    ZR,
    Engine,
)
from vibeam.flight.kernels.modal_flow import begin_flight
from vibeam.flight.kernels.pieces import CLAIM, CLOSES, FLIGHT, FROM, LENGTH, OPEN, UNPROVED, Flights
from vibeam.flight.kernels.roots import taylor_pairs as att
from vibeam.flight.kernels.roots.bounds import CLEAR, MINIMUM, SPLIT
from vibeam.flight.kernels.roots.first_root import first_level
from vibeam.flight.kernels.roots.newton import EPSILON, polish_minimum
from vibeam.flight.kernels.roots.pair import norm
from vibeam.flight.kernels.roots.panels import Node, accept, launching, next_node, ordinary, step_pairs
from vibeam.flight.kernels.roots.signal import Start, derivatives, signal_of, to_node

Array = NDArray[np.float64]


@entry
def cover(desk: Engine, omega: float, amplitude: float, flights: Flights, first: int, pieces: Array) -> tuple[int, int]:
    """Fill ``pieces`` from flight ``first`` on: pieces written, the first flight that found no room."""
    set_drive(desk, omega, amplitude)
    count, trace = 0, flights.trace
    for flight in range(first, trace.shape[0]):
        if trace[flight, WHAT] == RESTING or trace[flight, DURATION] == 0.0:
            continue
        written = along(desk, flights, flight, pieces, count)
        if written < 0:
            return count, flight
        count += written
    return count, trace.shape[0]


@kernel
def along(desk: Engine, flights: Flights, flight: int, pieces: Array, row: int) -> int:
    """Pieces of one flight, written from ``row`` on; −1 where there is no room for them.

    The verdicts are those of ``bounds.verdict``. A last panel that reaches beyond the flight's end and holds one root
    there is open up to the end, where the gap is.
    """
    g, trace, start = signal_of(desk), flights.trace, Start(int(flights.orders[flight]), flights.rises[flight])
    pairs, table, levels, signal, attached = g
    cosine, sine = phase(desk.drive, trace[flight, AT_CLOCK])
    begin_flight(desk, flights.poses[flight], cosine, sine)
    total = to_node(pairs)
    if signal[ATTACHED] > 0.0:
        att.restart(attached, signal)
    re, im = signal[ZR], signal[ZI]
    signal[HARMONIC] = norm(re, im)
    duration, end, coarsest = trace[flight, DURATION], trace[flight, END], int(desk.drive[COARSEST])
    tolerance = 8.0 * EPSILON * (abs(signal[CONST]) + signal[HARMONIC] + total + att.swing(attached, signal, duration))
    closes = end in (IMPACT, CHATTER, STUCK)
    node, level, since, count = Node(0.0, re, im), coarsest, 0, 0
    if start.order > 0:
        derivatives(g, pairs.shape[1], WHOLE, start.order + 1)
        level = first_level(g, start, coarsest)
    while node.time < duration:
        h, time = levels[STEP, level], node.time
        here = Start(start.order if time == 0.0 else 0, start.rise)
        found = launching(g, start, level) if here.order > 0 else ordinary(g, node, level, tolerance)
        if found == SPLIT and level < LEVELS - 1:
            level += 1
            since = 0
            continue
        if found == MINIMUM:
            _, value = polish_minimum(g, here, time, h)
            found = CLEAR if value > 0.0 else found
        last = time + h >= duration
        claim = OPEN if found == CLEAR or last else UNPROVED
        if last and closes:
            claim = CLOSES
        if row + count >= pieces.shape[0]:
            return -1
        pieces[row + count, FLIGHT], pieces[row + count, FROM] = flight, time
        pieces[row + count, LENGTH], pieces[row + count, CLAIM] = min(h, duration - time), claim
        count += 1
        if here.order > 0:
            step_pairs(pairs, table, level)
        if signal[ATTACHED] > 0.0:
            att.carry(attached, signal, time, h)
        accept(g)
        node = next_node(levels, level, node)
        since += 1
        if level > coarsest and since > 1:
            level -= 1
            since = 0
    return count
