"""Event loop of several contacts: to the first root of a gap or a contact force, and what follows there."""

from __future__ import annotations

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.block_flow import advance_blocks, to_block_coordinates
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.contacts import layout as row
from vibeam.flight.kernels.contacts.algebra import NOISE, along, size_along
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.contacts.reactions import decide, each, is_rigid, pressed_ones
from vibeam.flight.kernels.contacts.sets import key_of, regime_of, slot_of
from vibeam.flight.kernels.contacts.signals import FORCE, GAP, OUT, first_signal, show
from vibeam.flight.kernels.contacts.strikes import first_of, next_of, put, stop, strike, time_left
from vibeam.flight.kernels.contacts.yielding import enter, leave, let_go, push_anew, set_condition
from vibeam.flight.kernels.drive import wrap
from vibeam.flight.kernels.events import PIECE
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.kernels.readout import extremes
from vibeam.flight.kernels.regimes import layout as regime_row
from vibeam.flight.kernels.roots.signal import signal_of
from vibeam.flight.kernels.segments import MotionRecord, add, close_segment, copy_pose, open_segment, work_of
from vibeam_models.arrays import Array, Index

DEEP = 1e4  # round-offs beyond a stop that no round-off explains
AT_STOP = 4.0  # round-offs within which a gap is none
IDLE = 64  # events in a row that take next to no time and are no impacts
EVENTS_AN_IMPACT = 16  # on average, before a run is given up
TOO_EARLY = -1  # no outcome
SOON = 1e-12  # share of the slowest time scale that no event is told from
BEGUN = 5e-324  # time done of a span that was begun, and paused at its start


@kernel
def advance(
    engine: ContactEngine, pose: Array, status: Array, span: float, most: int, trace: Array, poses: Array,
    counts: Index,
) -> tuple[int, float]:  # fmt: skip
    """Carry ``pose`` and ``status`` on by ``span`` seconds: outcome, time done; as the plain system's ``advance``.

    PAUSED with status[WANTED]: a set is to be made before it is called again.
    """
    done, lost, rows = status[layout.DONE], status[layout.LOST], trace.shape[0]
    begun, piece, record = work_of(counts), piece_of(engine, pose), MotionRecord(trace, poses, counts)
    status[layout.DONE], status[layout.LOST], status[row.WANTED] = 0.0, 0.0, 0.0
    done = 0.0 if done == BEGUN else done
    if done == 0.0:
        status[layout.CLOCK] = wrap(engine.drive, status[layout.CLOCK])
    if status[layout.ORDER] == regime_row.UNKNOWN:
        outcome = classify(engine, pose, status)
        if outcome != layout.COMPLETE:
            return outcome, 0.0
    while done < span or status[row.PHASE] == row.STRIKING:  # an instant is not left half-way
        left = span - done
        if rows > 0:
            if counts[layout.SEGMENTS] >= rows:
                return layout.FULL, done
            open_segment(trace, poses, pose, status, done, counts[layout.SEGMENTS])
        outcome, step = segment(engine, pose, status, left, record)
        if outcome == layout.PAUSED:
            status[layout.DONE], status[layout.LOST] = max(done, BEGUN), lost
            return outcome, done
        if outcome != layout.COMPLETE:
            return outcome, done
        if step >= left and status[row.PHASE] != row.STRIKING:
            return layout.COMPLETE, span
        done, lost = (span, lost) if step >= left else add(done, lost, step)
        counts[layout.EVENTS] += 1
        if status[row.PHASE] == row.STRIKING:
            continue
        if (counts[layout.IMPACTS] >= most or counts[layout.EVENTS] > EVENTS_AN_IMPACT * (most + 100)) and done < span:
            return layout.EVENT_LIMIT, done
        if work_of(counts) - begun >= piece and done < span:
            status[layout.DONE], status[layout.LOST] = max(done, BEGUN), lost
            return layout.PAUSED, done
    return layout.COMPLETE, done


@kernel
def piece_of(engine: ContactEngine, pose: Array) -> int:
    """Panels between two pauses."""
    dense = pose.shape[1] if engine.numbers[row.COUPLED] > 0.0 else 1
    return int(PIECE // ((pose.shape[1] + 8) * dense))


@kernel
def classify(engine: ContactEngine, pose: Array, status: Array) -> int:
    """Set what the motion begins in, from its state alone: COMPLETE, or why it cannot be."""
    touched, status[row.HELD], status[row.PUSHED] = 0, 0.0, 0.0
    status[layout.ORDER], status[layout.KIND], status[row.PHASE] = 0.0, layout.FREE, row.FLYING
    for j in range(engine.rows.shape[0]):
        gap, parts = clearance(engine, pose, j)
        if not np.isfinite(gap):
            return layout.NOT_FINITE
        deep = gap < -DEEP * NOISE * parts
        if deep and is_rigid(engine, j):
            return layout.PENETRATED
        set_condition(engine, status, j, row.PUSHING if deep else row.AWAY, 0.0, 0.0)
        if deep:
            status[row.PUSHED] += float(1 << j)
            status[layout.KIND] = regime_row.CONTACT
        elif gap <= AT_STOP * NOISE * parts:
            touched |= 1 << j
    if touched > 0:
        status[row.PHASE], status[row.AT] = row.BEGINNING, row.NONE
    return layout.COMPLETE


@kernel
def clearance(engine: ContactEngine, pose: Array, j: int) -> tuple[float, float]:
    """Gap of a contact, and the sum of the sizes of its parts."""
    place, size = along(engine.rows, j, pose[0]), size_along(engine.rows, j, pose[0])
    return float(engine.gaps[j] - place), float(abs(engine.gaps[j]) + size)


@kernel
def segment(engine: ContactEngine, pose: Array, status: Array, span: float, record: MotionRecord) -> tuple[int, float]:
    """Up to the first root of the signals watched, and what follows: outcome, duration, which may be 0.

    PAUSED, and all as it was, where a set is wanted for it. Impulses of one instant are a segment each.
    """
    panels = record.counts[layout.PANELS]
    copy_pose(pose, engine.saved)
    for i in range(status.shape[0]):
        engine.memory[i] = status[i]
    outcome, step, end, before = on(engine, pose, status, span, record.counts)
    if outcome == layout.PAUSED:
        wanted = status[row.WANTED]
        copy_pose(engine.saved, pose)
        for i in range(status.shape[0]):
            status[i] = engine.memory[i]
        status[row.WANTED], record.counts[layout.PANELS] = wanted, panels
    if outcome != layout.COMPLETE:
        return outcome, 0.0
    note_segment(engine, status, step, end, before, record)
    return layout.COMPLETE, step


@kernel
def note_segment(
    engine: ContactEngine, status: Array, step: float, end: int, before: float, record: MotionRecord
) -> None:
    """Count the segment's event, and write its row."""
    counts = record.counts
    struck = end in (layout.IMPACT, layout.CHATTER, layout.STUCK)
    counts[layout.IMPACTS] += 1 if struck else 0
    counts[layout.CHATTERS] += 1 if end == layout.CHATTER else 0
    if record.trace.shape[0] > 0:
        line = record.trace[counts[layout.SEGMENTS]]
        line[layout.WHAT] = layout.FREE if engine.memory[row.PHASE] == row.STRIKING else engine.memory[layout.KIND]
        line[regime_row.AT_SIDE], line[regime_row.PEAK] = max(status[row.AT], 0.0), status[regime_row.PEAKED]
        line[row.HELD_AT], line[row.PUSHED_AT] = engine.memory[row.HELD], engine.memory[row.PUSHED]
        if end == layout.CHATTER:
            line[layout.LEFT], line[layout.REMAINDER] = status[regime_row.LEFT_OVER], status[regime_row.LEFT_ERROR]
    close_segment(record.trace, step, end, before, counts)
    soon = step * engine.numbers[row.SLOWEST] < NOISE and not struck
    status[regime_row.STALL] = status[regime_row.STALL] + 1.0 if soon else 0.0


@kernel
def on(engine: ContactEngine, pose: Array, status: Array, span: float, counts: Index) -> tuple[int, float, int, float]:
    """One segment: outcome, duration, how it ends, the velocity before an impulse."""
    step, end, before, leaving = 0.0, regime_row.PASS, 0.0, row.NONE
    if status[row.PHASE] == row.FLYING:
        if status[regime_row.STALL] > IDLE:
            return layout.UNRESOLVED, 0.0, 0, 0.0
        status[row.AT] = row.NONE
        outcome, met, step = to_event(engine, pose, status, span, counts)
        if outcome != layout.COMPLETE:
            return outcome, 0.0, 0, 0.0
        if step > 0.0:
            age(engine, status)
        if met == row.NONE:
            return layout.COMPLETE, step, layout.SPAN_END, 0.0
        end, before, leaving = arrive(engine, pose, status, met)
    elif status[row.PHASE] == row.BEGINNING:
        end, before = touch_all(engine, pose, status, row.NONE)
    if status[row.PHASE] != row.STRIKING:
        status[row.PRESSED] = pressed_ones(engine, pose, status, leaving)
        struck = first_of(engine, pose, status)
        if struck == row.NONE:
            status[row.PHASE] = row.FLYING
            decide(engine, pose, status, int(status[row.TOUCHED]), leaving, 0.0)
            return layout.COMPLETE, step, end, before
        status[row.NEXT] = struck
    return impulse(engine, pose, status, step, counts)


@kernel
def age(engine: ContactEngine, status: Array) -> None:
    """Forget how the signals start, but of those that stay at zero."""
    for j in range(engine.rows.shape[0]):
        if status[each(engine, row.ORDER, j)] != regime_row.TOUCHING:
            status[each(engine, row.ORDER, j)] = 0.0


@kernel
def arrive(engine: ContactEngine, pose: Array, status: Array, met: int) -> tuple[int, float, int]:
    """At the root of a signal: how the segment ends, the velocity there, the contact that its stop lets go (or NONE).

    The rigid contacts touched are put exactly to their stops.
    """
    k = engine.rows.shape[0]
    j, kind = met % k, met // k
    status[row.AT] = j
    end, before = touch_all(engine, pose, status, j if kind == GAP else row.NONE)
    if kind == GAP:
        return end, before, row.NONE
    if is_rigid(engine, j):
        return layout.RELEASE, 0.0, j
    if kind == FORCE:
        let_go(engine, pose, status, j)
        return layout.RELEASE, 0.0, row.NONE
    if kind == OUT:
        leave(engine, pose, status, j)
    else:
        set_condition(engine, status, j, row.PUSHING, 1.0, 0.0)
    return regime_row.PASS, 0.0, row.NONE


@kernel
def touch_all(engine: ContactEngine, pose: Array, status: Array, met: int) -> tuple[int, float]:
    """Contacts at their stops, ``met`` or as near as round-off can tell: the rigid ones noted, the others entered.

    How the segment before ends, and the velocity there, by the contact met.
    """
    touched, end, before = int(status[row.HELD]), regime_row.PASS, 0.0
    for j in range(engine.rows.shape[0]):
        condition = status[each(engine, row.CONDITION, j)]
        gap, parts = clearance(engine, pose, j)
        near = j == met or (gap <= AT_STOP * NOISE * parts and (is_rigid(engine, j) or condition == row.AWAY))
        if is_rigid(engine, j) and (near or condition == row.IMPLIED):
            touched |= 1 << j
        elif near and status[each(engine, row.ORDER, j)] == 0.0:
            entry, speed = enter(engine, pose, status, j)
            if j == met or (met == row.NONE and entry == layout.IMPACT):
                end, before, status[row.AT] = entry, speed, j
    put(engine, pose, touched)
    status[row.TOUCHED] = touched
    return end, before


@kernel
def impulse(
    engine: ContactEngine, pose: Array, status: Array, step: float, counts: Index
) -> tuple[int, float, int, float]:
    """The next impulse of an instant, and what the touched contacts do after the last."""
    struck, touched = int(status[row.NEXT]), int(status[row.TOUCHED])
    before = strike(engine, pose, status, struck)
    status[row.AT], status[row.NEXT] = struck, next_of(engine, pose, status)
    if status[row.NEXT] != row.NONE:
        status[row.PHASE] = row.STRIKING
        return layout.COMPLETE, step, layout.IMPACT, before
    status[row.PHASE] = row.FLYING
    push_anew(engine, pose, status)
    decide(engine, pose, status, touched, row.NONE, NOISE * status[row.HARDEST])
    if status[each(engine, row.CONDITION, struck)] == row.KEPT:
        return layout.COMPLETE, step, layout.STUCK, before
    if status[each(engine, row.ORDER, struck)] != 1.0:
        return layout.COMPLETE, step, layout.IMPACT, before
    after = status[each(engine, row.RISE, struck)]
    left, remainder = time_left(engine, pose, status, struck, after)
    if left < 0.0:
        return layout.COMPLETE, step, layout.IMPACT, before
    outcome = complete(engine, pose, status, struck, left, counts)
    status[regime_row.LEFT_OVER], status[regime_row.LEFT_ERROR] = left, remainder
    if outcome == TOO_EARLY:
        return layout.COMPLETE, step, layout.IMPACT, before
    return outcome, step, layout.CHATTER, before


@kernel
def complete(engine: ContactEngine, pose: Array, status: Array, struck: int, left: float, counts: Index) -> int:
    """The accumulation at a contact completed by its limit: COMPLETE; TOO_EARLY, and all as before, where it is not.

    It is where the contact stays held, and no other event comes before the accumulation's end.
    """
    touched, after = int(status[row.TOUCHED]), status[each(engine, row.RISE, struck)]
    copy_pose(pose, engine.tried)
    for i in range(status.shape[0]):
        engine.trial[i] = status[i]
    stop(engine, pose, int(status[row.HELD]) | 1 << struck)
    decide(engine, pose, status, touched, row.NONE, NOISE * after)
    if status[each(engine, row.CONDITION, struck)] == row.KEPT:
        if left * engine.numbers[row.SLOWEST] < SOON:
            return layout.COMPLETE
        slot = slot_of(engine, key_of(engine, status[row.HELD], status[row.PUSHED]))
        if slot == row.NONE:
            status[row.WANTED] = key_of(engine, status[row.HELD], status[row.PUSHED]) + 1.0
            return layout.PAUSED
        regime = regime_of(engine, slot)
        to_block_coordinates(regime, engine.drive, pose, status[layout.CLOCK])
        outcome, met, _ = first_signal(engine, regime, int(engine.coarsest[slot]), pose, status, left, counts)
        if outcome != layout.COMPLETE or met == row.NONE:
            return outcome
    copy_pose(engine.tried, pose)
    for i in range(status.shape[0]):
        status[i] = engine.trial[i]
    return TOO_EARLY


@kernel
def to_event(engine: ContactEngine, pose: Array, status: Array, span: float, counts: Index) -> tuple[int, int, float]:
    """Carry ``pose`` on to the end of a segment: outcome, which signal's root it is (NONE: span's end), duration."""
    key = key_of(engine, status[row.HELD], status[row.PUSHED])
    slot = slot_of(engine, key)
    if slot == row.NONE:
        status[row.WANTED] = key + 1.0
        return layout.PAUSED, row.NONE, 0.0
    regime, clock = regime_of(engine, slot), status[layout.CLOCK]
    to_block_coordinates(regime, engine.drive, pose, clock)
    outcome, met, step = first_signal(engine, regime, int(engine.coarsest[slot]), pose, status, span, counts)
    if outcome != layout.COMPLETE:
        return outcome, row.NONE, 0.0
    status[regime_row.PEAKED] = hardest_push(engine, regime, int(engine.coarsest[slot]), status, step)
    if step > 0.0:
        advance_blocks(regime, engine.drive, pose, clock, step)
    if not np.isfinite(pose[0, 0]):
        return layout.UNRESOLVED, row.NONE, 0.0
    status[layout.CLOCK] = wrap(engine.drive, clock + step)
    return layout.COMPLETE, met, step


@kernel
def hardest_push(engine: ContactEngine, regime: Regime, coarsest: int, status: Array, step: float) -> float:
    """The largest force of the stops that push over a segment of a regime that was entered."""
    most = 0.0
    for j in range(engine.rows.shape[0]):
        if status[each(engine, row.CONDITION, j)] == row.PUSHING:
            show(engine, regime, FORCE * engine.rows.shape[0] + j, status[layout.CLOCK])
            _, most = extremes(signal_of(regime), step, coarsest, 0.0, most)
    return most
