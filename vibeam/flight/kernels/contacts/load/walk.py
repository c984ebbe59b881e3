"""The walk under a load to the first root of all signals watched, with proof, panel by panel and piece by piece.

A panel lies within one piece of the load, where all signals have all derivatives. It is clear where every signal's
verdict is; with one root in some signal the first of them is the event; else it is halved. Pieces on which an energy
bound excludes every root are merged: the flow goes through them exactly, and their signals are not looked at.
"""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.contacts import course as row
from vibeam.flight.kernels.contacts import layout as contact_row
from vibeam.flight.kernels.contacts.course import Course
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.contacts.load import panel, starts
from vibeam.flight.kernels.contacts.load.flow import (
    FINEST,
    accept,
    differentiate,
    enter_blocks,
    fitted,
    grow,
    move_on,
    set_load,
)
from vibeam.flight.kernels.contacts.load.notes import note_all, note_last, note_pushes
from vibeam.flight.kernels.contacts.load.quiet import is_quiet, pass_window
from vibeam.flight.kernels.contacts.signals import list_signals
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.kernels.modal_flow import ROUND_OFF
from vibeam.flight.kernels.regimes import layout as regime_row
from vibeam.flight.kernels.roots.bounds import CLEAR, MINIMUM, ROOT, SPLIT
from vibeam.flight.kernels.roots.pair import power
from vibeam_models.arrays import Array, Index

CARRIED = 8  # panels from a start over which a signal's value is what it has grown by
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
    outcome, met = starts.start_watch(engine, regime, status, number)
    if outcome != layout.COMPLETE or met != contact_row.NONE:
        return outcome, met, 0.0
    if clock >= lengths[piece]:
        return finish(course, piece, clock, contact_row.NONE, span)
    first, segment = piece, counts[layout.SEGMENTS]
    want, done, panels, finest = starts.first_panel(engine, regime, number, lengths[piece] - clock), 0.0, 0, 0
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
                if renews(engine, regime, number):
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
        met, time, begun = contact_row.NONE, h, counts[layout.PANELS]
        found = try_panel(engine, regime, slot, number, lengths[piece], h, counts)
        while found == SPLIT and h >= FINEST * lengths[piece]:
            patience = min(2 * patience, PATIENT) if lengthened else patience
            h, since, lengthened = 0.5 * h, 0, False
            want = h
            found = try_panel(engine, regime, slot, number, lengths[piece], h, counts)
        panels += counts[layout.PANELS] - begun
        finest += 1 if found == SPLIT else 0
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
def renew_watch(engine: ContactEngine, regime: Regime, number: int, anew: bool) -> None:
    """Signals at the next node: what they have grown to, or ``anew`` from the blocks."""
    watch = engine.course.watch
    for place in range(number):
        grown = watch[row.AT, place]
        panel.show_value(engine, regime, engine.course, place, engine.watched[place])
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
        share = panel.sign_of(engine, which) * regime.signals[panel.row_of(engine, which)][2 * n + 1]
        if share == 0.0:
            continue
        panel.show_value(engine, regime, engine.course, place, which)
        if not anew:
            watch[row.AT, place] = grown + share * jump
        if watch[row.AT, place] < -ROUND_OFF * watch[row.PARTS, place] and share * jump < 0.0:
            met = which
    return met


@kernel
def renews(engine: ContactEngine, regime: Regime, number: int) -> bool:
    """True where a signal that stays at zero would leave it by the load of the piece that begins."""
    course, found = engine.course, False
    for place in range(number):
        if course.watch[row.ADDED, place] != 0.0:
            differentiate(regime, course, 5)
            found = found or starts.first_derivative(engine, regime, engine.watched[place])[0] > 0
    return found


@kernel
def try_panel(
    engine: ContactEngine, regime: Regime, slot: int, number: int, length: float, h: float, counts: Index
) -> int:  # fmt: skip
    """A panel of length h: CLEAR where every signal's verdict is; SPLIT where one is that; else ROOT."""
    found, watch = CLEAR, engine.course.watch
    grow(regime, engine.course, slot, length, h)
    counts[layout.PANELS] += 1
    for place in range(number):
        one = panel.judge(engine, regime, engine.course, place, engine.watched[place], h)
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
            bracket, value = panel.find_turn(engine, regime, course, place, which, h)
            found = ROOT if value <= 0.0 else CLEAR
        if found == ROOT:
            root = panel.find_root(engine, regime, course, place, which, bracket)
            if root <= time:
                met, time = which, root
    return met, time


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
