"""The walk under a load to the first root of all signals watched, with proof, panel by panel and piece by piece.

A panel lies within one piece of the load, where all signals have all derivatives. It is clear where every signal's
verdict is; with one root in some signal the first of them is the event; else it is halved. Pieces on which an energy
bound excludes every root are merged: the flow goes through them exactly, and their signals are not looked at.
"""

from __future__ import annotations

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.contacts import course as row
from vibeam.flight.kernels.contacts import layout as contact_row
from vibeam.flight.kernels.contacts.course import Course
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.contacts.load.flow import (
    accept,
    differentiate,
    enter_blocks,
    grow,
    move_on,
    set_load,
)
from vibeam.flight.kernels.contacts.load.panel import (
    derivative_at,
    find_root,
    find_turn,
    judge,
    row_of,
    show_value,
    sign_of,
)
from vibeam.flight.kernels.contacts.load.peaks import note_push
from vibeam.flight.kernels.contacts.load.quiet import is_quiet, pass_window
from vibeam.flight.kernels.contacts.reactions import each
from vibeam.flight.kernels.contacts.signals import FORCE, GAP, OUT, list_signals
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.kernels.modal_flow import ROUND_OFF, SMALLEST
from vibeam.flight.kernels.regimes import layout as regime_row
from vibeam.flight.kernels.regimes.events import STALLS
from vibeam.flight.kernels.roots.bounds import CLEAR, MINIMUM, ROOT, SPLIT
from vibeam.flight.kernels.roots.pair import power
from vibeam_models.arrays import Array, Index

CARRIED = 8  # panels from a start over which a signal's value is what it has grown by
FINEST = 2.0**-56  # share of a piece below which a panel is not halved
MOST_FINEST = 1000  # such panels in one walk
PATIENT = 64


@kernel
def first_signal_loaded(
    engine: ContactEngine, regime: Regime, slot: int, pose: Array, status: Array, span: float, counts: Index
) -> tuple[int, int, float]:
    """The first root of the signals watched, from ``pose``: outcome, whose it is (NONE: nobody's), time.

    flow[Y], numbers[PIECE_NOW], [CLOCK_NOW] and [WHY] are where it ends: at the root, after ``span``, or before that at
    a point that is kept.
    """
    course, number = engine.course, list_signals(engine, status)
    numbers, lengths, whole = course.numbers, course.lengths, course.lengths.shape[0]
    piece, clock = int(status[contact_row.PIECE]), status[layout.CLOCK]
    enter_blocks(regime, course, pose)
    numbers[row.WHY], status[regime_row.PEAKED] = row.REACHED, 0.0
    numbers[row.PIECE_NOW], numbers[row.CLOCK_NOW] = piece, clock
    set_load(course, piece, clock)
    differentiate(regime, course, 5)
    outcome, met = start_watch(engine, regime, status, number)
    if outcome != layout.COMPLETE or met != contact_row.NONE:
        return outcome, met, 0.0
    if clock >= lengths[piece]:
        return finish(course, piece, clock, contact_row.NONE, span)
    first, segment = piece, counts[layout.SEGMENTS]
    want, done, panels, finest = first_panel(engine, regime, number, lengths[piece] - clock), 0.0, 0, 0
    since, patience, lengthened = 0, 1, False
    while done < span:
        if panels > 0:
            if clock >= lengths[piece]:
                if piece + 1 >= whole:
                    return finish(course, piece, clock, contact_row.NONE, span)
                last_u, piece, clock = numbers[row.U_LAST], piece + 1, 0.0
                set_load(course, piece, clock)
                want = fitted(want, lengths[piece])
                met = jumped(engine, regime, number, numbers[row.U] - last_u, panels >= CARRIED)
                if met != contact_row.NONE:
                    numbers[row.WHY] = row.JUMPED
                    return finish(course, piece, clock, met, done)
                if renews(engine, status, piece):
                    numbers[row.WHY] = row.RENEWED
                    return finish(course, piece, clock, contact_row.NONE, done)
                if piece - first >= row.STRIDE:
                    numbers[row.WHY] = row.KEPT_POINT
                    return finish(course, piece, clock, contact_row.NONE, done)
                if is_quiet(engine, regime, number, piece, span - done):
                    length = pass_window(regime, course, slot, piece)
                    note_all(engine, number, segment, done, length)
                    piece, clock, done = piece + row.WINDOW - 1, lengths[piece + row.WINDOW - 1], done + length
                    panels, counts[layout.PANELS] = max(panels, CARRIED), counts[layout.PANELS] + 1
                    continue
            else:
                set_load(course, piece, clock)
            if panels >= row.LONG:
                numbers[row.WHY] = row.KEPT_POINT
                return finish(course, piece, clock, contact_row.NONE, done)
            differentiate(regime, course, 5)
            renew_watch(engine, regime, number, panels >= CARRIED)
        rest = lengths[piece] - clock
        h = min(want, rest)
        found, met, time = CLEAR, contact_row.NONE, h
        while True:
            panels += 1
            counts[layout.PANELS] += 1
            grow(regime, course, slot, lengths[piece], h)
            found = judge_all(engine, regime, number, h)
            if found != SPLIT:
                break
            if h < FINEST * lengths[piece]:
                finest += 1
                break
            patience = min(2 * patience, PATIENT) if lengthened else patience
            h, since, lengthened = 0.5 * h, 0, False
            want = h
        if finest > MOST_FINEST:
            return layout.UNRESOLVED, contact_row.NONE, 0.0
        if found != CLEAR:
            met, time = first_of_panel(engine, regime, number, h)
        if met == contact_row.NONE and done + h <= span:
            note_pushes(engine, regime, status, number, h)
            note_all(engine, number, segment, done, h)
            leave_start(engine, number, h)
            accept(course)
            clock = lengths[piece] if h >= rest else clock + h
            done += h
            since, patience = since + 1, max(1, patience // 2) if lengthened else patience
            lengthened = False
            if since > patience and want <= h:
                want, since, lengthened = 2.0 * want, 0, True
            continue
        if met != contact_row.NONE and done + time > span:
            met = contact_row.NONE
        time = time if met != contact_row.NONE else span - done
        note_pushes(engine, regime, status, number, time)
        note_last(engine, number, segment, done, time, met)
        move_on(regime, course, time)
        return finish(course, piece, min(clock + time, lengths[piece]), met, done + time)
    return finish(course, piece, clock, contact_row.NONE, span)


@kernel
def finish(course: Course, piece: int, clock: float, met: int, step: float) -> tuple[int, int, float]:
    """Note where the walk ends; outcome, signal and time as they are returned."""
    course.numbers[row.PIECE_NOW], course.numbers[row.CLOCK_NOW] = piece, clock
    if piece + 1 < course.lengths.shape[0] and clock >= course.lengths[piece]:
        course.numbers[row.PIECE_NOW], course.numbers[row.CLOCK_NOW] = piece + 1, 0.0
    return layout.COMPLETE, met, step


@kernel
def fitted(want: float, length: float) -> float:
    """The longest of a piece's length, half of it, … that is no longer than ``want``; for the steps kept."""
    h = length
    while h > want and h > FINEST * length:
        h *= 0.5
    return h


@kernel
def start_watch(engine: ContactEngine, regime: Regime, status: Array, number: int) -> tuple[int, int]:
    """Begin to watch the signals: outcome, and the one that is an event at once, or NONE."""
    watch, k = engine.course.watch, engine.rows.shape[0]
    for place in range(number):
        which = engine.watched[place]
        j, kind = which % k, which // k
        watch[row.ADDED, place], watch[row.START_ORDER, place], watch[row.START_RISE, place] = 0.0, 0.0, 0.0
        show_value(engine, regime, engine.course, place, which)
        value, size = watch[row.AT, place], watch[row.PARTS, place]
        if not np.isfinite(size):
            return layout.NOT_FINITE, contact_row.NONE
        touching = status[each(engine, contact_row.ORDER, j)] == regime_row.TOUCHING
        order, rise = int(status[each(engine, contact_row.ORDER, j)]), status[each(engine, contact_row.RISE, j)]
        if kind != GAP and status[each(engine, contact_row.CONDITION, j)] != contact_row.KEPT:
            fresh = order > 0 and kind != OUT
            order, rise = leading(engine, regime, which, place, max(value, 0.0) if fresh else value)
            touching = status[regime_row.STALL] >= STALLS and order != 0
            if order < 0 and not touching:
                return layout.COMPLETE, which
        if touching:
            watch[row.ADDED, place] = 2.0 * (ROUND_OFF * size + max(-value, 0.0)) + SMALLEST
            watch[row.AT, place] = value + watch[row.ADDED, place]
        else:
            watch[row.START_ORDER, place], watch[row.START_RISE, place] = max(order, 0), rise
    return layout.COMPLETE, contact_row.NONE


@kernel
def leading(engine: ContactEngine, regime: Regime, which: int, place: int, value: float) -> tuple[int, float]:
    """Order and size of the first derivative by which a signal rises from 0, as ``leading_order``."""
    watch, course = engine.course.watch, engine.course
    rate, size = watch[row.SLOPE, place], watch[row.PARTS, place]
    if value > ROUND_OFF * size:
        return 0, 0.0
    if rate > 0.0 and value >= -ROUND_OFF * size:
        return 1, rate
    if rate < 0.0 or value < -ROUND_OFF * size:
        return -1, 0.0
    second, third = derivative_at(engine, regime, course, which, 2), derivative_at(engine, regime, course, which, 3)
    if second > 0.0:
        return 2, second
    return (3, third) if second == 0.0 and third > 0.0 else (-1, 0.0)


@kernel
def first_panel(engine: ContactEngine, regime: Regime, number: int, rest: float) -> float:
    """The length to start with: twice the shortest flight 2g'(0)/|g''(0)| that two derivatives foretell."""
    want, watch = rest, engine.course.watch
    for place in range(number):
        if watch[row.START_ORDER, place] == 1.0:
            ahead = derivative_at(engine, regime, engine.course, engine.watched[place], 2)
            if ahead < 0.0:
                want = min(want, -4.0 * watch[row.START_RISE, place] / ahead)
    return want


@kernel
def renew_watch(engine: ContactEngine, regime: Regime, number: int, anew: bool) -> None:
    """Signals at the next node: what they have grown to, or ``anew`` from the blocks."""
    watch = engine.course.watch
    for place in range(number):
        grown = watch[row.AT, place]
        show_value(engine, regime, engine.course, place, engine.watched[place])
        if not anew:
            watch[row.AT, place] = grown


@kernel
def leave_start(engine: ContactEngine, number: int, h: float) -> None:
    """The panel's end becomes the node: watch[AT] of every signal, by what it has grown."""
    watch = engine.course.watch
    for place in range(number):
        order = int(watch[row.START_ORDER, place])
        watch[row.AT, place] = watch[row.LAST, place] * power(h, order)
        watch[row.START_ORDER, place] = 0.0


@kernel
def jumped(engine: ContactEngine, regime: Regime, number: int, jump: float, anew: bool) -> int:
    """The signal that a jump of u takes below zero, NONE where there is none; the others carried over it."""
    watch, n, met = engine.course.watch, engine.omega.shape[0], contact_row.NONE
    if jump == 0.0:
        return met
    for place in range(number):
        which, grown = engine.watched[place], watch[row.AT, place]
        share = sign_of(engine, which) * regime.signals[row_of(engine, which)][2 * n + 1]
        if share == 0.0:
            continue
        show_value(engine, regime, engine.course, place, which)
        if not anew:
            watch[row.AT, place] = grown + share * jump
        if watch[row.AT, place] < -ROUND_OFF * watch[row.PARTS, place] and share * jump < 0.0:
            met = which
    return met


@kernel
def renews(engine: ContactEngine, status: Array, piece: int) -> bool:
    """True where some contact touches its stop without force, and a load begins that may press or free it."""
    pieces, loaded, touching = engine.course.pieces, False, False
    for i in range(4):
        loaded = loaded or pieces[piece, i] != pieces[piece - 1, i]
    for j in range(engine.rows.shape[0]):
        touching = touching or status[each(engine, contact_row.ORDER, j)] == regime_row.TOUCHING
    return loaded and touching


@kernel
def judge_all(engine: ContactEngine, regime: Regime, number: int, h: float) -> int:
    """CLEAR where every signal's verdict is; SPLIT where one is that; else ROOT."""
    found, watch = CLEAR, engine.course.watch
    for place in range(number):
        one = judge(engine, regime, engine.course, place, engine.watched[place], h)
        watch[row.FOUND, place] = one
        if one == SPLIT:
            found = SPLIT
        elif one != CLEAR and found != SPLIT:
            found = ROOT
    return found


@kernel
def first_of_panel(engine: ContactEngine, regime: Regime, number: int, h: float) -> tuple[int, float]:
    """The first root on a panel of which no signal is in doubt: whose, and when after the node; NONE where all miss.

    Of equal ones the last counts.
    """
    course, met, time = engine.course, contact_row.NONE, h
    for place in range(number):
        found, which = int(course.watch[row.FOUND, place]), engine.watched[place]
        if found == SPLIT:  # too short to halve
            found = ROOT if course.watch[row.LAST, place] <= 0.0 else CLEAR
        bracket = h
        if found == MINIMUM:
            bracket, value = find_turn(engine, regime, course, place, which, h)
            found = ROOT if value <= 0.0 else CLEAR
        if found == ROOT:
            root = find_root(engine, regime, course, place, which, bracket)
            if root <= time:
                met, time = which, root
    return met, time


@kernel
def note_pushes(engine: ContactEngine, regime: Regime, status: Array, number: int, h: float) -> None:
    """status[PEAKED]: the largest force of the stops that push."""
    k = engine.rows.shape[0]
    for place in range(number):
        which = engine.watched[place]
        if which // k == FORCE and status[each(engine, contact_row.CONDITION, which % k)] == contact_row.PUSHING:
            most = note_push(engine, regime, place, which, h, status[regime_row.PEAKED])
            status[regime_row.PEAKED] = most


@kernel
def is_roomy(engine: ContactEngine) -> bool:
    """True where there is room for the intervals of a segment, or none are asked for."""
    course, number = engine.course, 2 * engine.rows.shape[0]
    most = course.numbers[row.WRITTEN] + number * (row.LONG + row.STRIDE)
    return bool(course.numbers[row.CERTIFIED] == 0.0 or most <= course.intervals.shape[0])


@kernel
def note_all(engine: ContactEngine, number: int, segment: int, begin: float, length: float) -> None:
    """Intervals of a certificate: every signal is positive there."""
    note_last(engine, number, segment, begin, length, contact_row.NONE)


@kernel
def note_last(engine: ContactEngine, number: int, segment: int, begin: float, length: float, met: int) -> None:
    """The same up to a root of signal ``met``."""
    course = engine.course
    if course.numbers[row.CERTIFIED] == 0.0:
        return
    for place in range(number):
        which, at = engine.watched[place], int(course.numbers[row.WRITTEN])
        doubt = course.watch[row.ADDED, place] != 0.0 or course.watch[row.FOUND, place] == SPLIT
        claim = layout.UNPROVED if doubt else layout.CLOSES if which == met else layout.OPEN
        interval = course.intervals[at]
        interval[layout.PIECE_SEGMENT], interval[layout.PIECE_SIGNAL] = segment, which
        interval[layout.BEGIN], interval[layout.LENGTH], interval[layout.CLAIM] = begin, length, claim
        course.numbers[row.WRITTEN] += 1.0


@kernel
def reaches_knot(engine: ContactEngine, status: Array, left: float) -> bool:
    """True where the load's piece ends before a time is over: no limit holds beyond."""
    course = engine.course
    if course.numbers[row.LOADED] == 0.0:
        return False
    return bool(status[layout.CLOCK] + left > course.lengths[int(status[contact_row.PIECE])])


@kernel
def is_met(
    engine: ContactEngine, regime: Regime, slot: int, pose: Array, status: Array, span: float, counts: Index
) -> tuple[int, int]:
    """Outcome, and the signal that is met within ``span``, or NONE: a walk that leaves no trace."""
    numbers, peaked = engine.course.numbers, status[regime_row.PEAKED]
    asked, numbers[row.CERTIFIED] = numbers[row.CERTIFIED], 0.0
    outcome, met, _ = first_signal_loaded(engine, regime, slot, pose, status, span, counts)
    numbers[row.CERTIFIED], status[regime_row.PEAKED], numbers[row.WHY] = asked, peaked, row.REACHED
    return outcome, met
