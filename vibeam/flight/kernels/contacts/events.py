"""Event loop of several contacts: to the first root of a gap or a contact force, and what follows there."""

from __future__ import annotations

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.block_flow import advance_blocks, to_block_coordinates
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.contacts import layout as row
from vibeam.flight.kernels.contacts.algebra import NOISE
from vibeam.flight.kernels.contacts.course import LOADED, WRITTEN
from vibeam.flight.kernels.contacts.instants import arrive, classify, impulse, touch_all
from vibeam.flight.kernels.contacts.integration import integrate, is_integrated
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.contacts.load.events import is_jump, is_on_the_way, to_event_loaded
from vibeam.flight.kernels.contacts.load.notes import is_roomy
from vibeam.flight.kernels.contacts.reactions import clearance, decide, each, is_curved, pressed_ones
from vibeam.flight.kernels.contacts.sets import key_of, regime_of, slot_of
from vibeam.flight.kernels.contacts.signals import FORCE, first_signal, show
from vibeam.flight.kernels.contacts.strikes import first_of
from vibeam.flight.kernels.drive import wrap
from vibeam.flight.kernels.events import PIECE
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.kernels.readout import extremes
from vibeam.flight.kernels.regimes import layout as regime_row
from vibeam.flight.kernels.regimes.events import STEP_WORK, STEPS_A_PANEL
from vibeam.flight.kernels.roots.signal import signal_of
from vibeam.flight.kernels.segments import (
    MotionRecord,
    add,
    close_segment,
    copy_pose,
    open_segment,
    turns_of,
    work_of,
)
from vibeam_models.arrays import Array, Index

IDLE = 64  # events in a row that take next to no time and are no impacts
EVENTS_AN_IMPACT = 16  # on average, before a run is given up
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
            if counts[layout.SEGMENTS] >= rows or not is_roomy(engine):
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
        begun -= turns_of(engine.omega, step)
        counts[layout.EVENTS] += 0 if is_on_the_way(engine) else 1
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
    dense, curved = pose.shape[1] if engine.numbers[row.COUPLED] > 0.0 else 1, False
    for j in range(engine.rows.shape[0]):
        curved = curved or is_curved(engine, j)
    return int(PIECE // ((pose.shape[1] + 8) * dense * (STEP_WORK if curved else 1)))


@kernel
def segment(engine: ContactEngine, pose: Array, status: Array, span: float, record: MotionRecord) -> tuple[int, float]:
    """Up to the first root of the signals watched, and what follows: outcome, duration, which may be 0.

    PAUSED, and all as it was, where a set is wanted for it. Impulses of one instant are a segment each.
    """
    panels, written = record.counts[layout.PANELS], engine.course.numbers[WRITTEN]
    copy_pose(pose, engine.saved)
    for i in range(status.shape[0]):
        engine.memory[i] = status[i]
    outcome, step, end, before = on(engine, pose, status, span, record.counts)
    if outcome == layout.PAUSED:
        wanted = status[row.WANTED]
        copy_pose(engine.saved, pose)
        for i in range(status.shape[0]):
            status[i] = engine.memory[i]
        status[row.WANTED], record.counts[layout.PANELS], engine.course.numbers[WRITTEN] = wanted, panels, written
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
        line[row.MET_AT], line[row.PIECE_AT] = status[row.MET], engine.memory[row.PIECE]
        for i in range(row.TRACED * engine.rows.shape[0]):
            line[row.EACH_AT + i] = engine.memory[row.EACH + i]
        if end == layout.CHATTER:
            line[layout.LEFT], line[layout.REMAINDER] = status[regime_row.LEFT_OVER], status[regime_row.LEFT_ERROR]
    close_segment(record.trace, step, end, before, counts)
    soon = step * engine.numbers[row.SLOWEST] < NOISE and not struck
    status[regime_row.STALL] = status[regime_row.STALL] + 1.0 if soon else 0.0


@kernel
def on(engine: ContactEngine, pose: Array, status: Array, span: float, counts: Index) -> tuple[int, float, int, float]:
    """One segment: outcome, duration, how it ends, the velocity before an impulse."""
    step, end, before, leaving, status[row.MET] = 0.0, regime_row.PASS, 0.0, row.NONE, row.NONE
    if status[row.PHASE] == row.FLYING:
        if status[regime_row.STALL] > IDLE or status[regime_row.BUSY] > STEPS_A_PANEL:
            return layout.UNRESOLVED, 0.0, 0, 0.0
        status[row.AT] = row.NONE
        outcome, met, step = to_event(engine, pose, status, span, counts)
        if outcome != layout.COMPLETE:
            return outcome, 0.0, 0, 0.0
        status[row.MET] = met
        if step > 0.0:
            age(engine, pose, status)
        if met == row.NONE:
            return layout.COMPLETE, step, layout.SPAN_END, 0.0
        end, before, leaving = arrive(engine, pose, status, met)
        leaving = row.NONE if is_jump(engine) else leaving
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
def age(engine: ContactEngine, pose: Array, status: Array) -> None:
    """Forget how the signals start, but of those that stay at zero."""
    for j in range(engine.rows.shape[0]):
        gap, least = clearance(engine, pose, j)
        deep = status[each(engine, row.CONDITION, j)] == row.PUSHING and gap < -least
        if deep or status[each(engine, row.ORDER, j)] != regime_row.TOUCHING:
            status[each(engine, row.ORDER, j)] = 0.0


@kernel
def to_event(engine: ContactEngine, pose: Array, status: Array, span: float, counts: Index) -> tuple[int, int, float]:
    """Carry ``pose`` on to the end of a segment: outcome, which signal's root it is (NONE: span's end), duration."""
    if engine.course.numbers[LOADED] > 0.0:
        return to_event_loaded(engine, pose, status, span, counts)
    if is_integrated(engine, status[row.PUSHED]):
        return through_contact(engine, pose, status, span, counts)
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
    if not (np.isfinite(status[regime_row.PEAKED]) and np.isfinite(pose[0, 0])):
        return layout.UNRESOLVED, row.NONE, 0.0
    status[layout.CLOCK] = wrap(engine.drive, clock + step)
    return layout.COMPLETE, met, step


@kernel
def through_contact(
    engine: ContactEngine, pose: Array, status: Array, span: float, counts: Index
) -> tuple[int, int, float]:
    """The same where a contact that pushes is integrated."""
    longest = engine.levels[0, layout.STEP, int(engine.coarsest[0])]
    met, step, steps = integrate(engine, pose, status, span)
    counts[layout.PANELS] += steps
    if not (np.isfinite(step) and np.isfinite(pose[0, 0])):
        return layout.NOT_FINITE, row.NONE, 0.0
    status[regime_row.BUSY] = max(status[regime_row.BUSY] - STEPS_A_PANEL * step / longest, 0.0) + steps
    status[layout.CLOCK] = wrap(engine.drive, status[layout.CLOCK] + step)
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
