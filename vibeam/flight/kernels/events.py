"""Event loop of a plain system, one stop and one coefficient of restitution: flight, impact, chatter, rest, release."""

from __future__ import annotations

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.drive import phase, wrap
from vibeam.flight.kernels.impact import chatter_left, contact_velocity, settle_on_stop, strike
from vibeam.flight.kernels.lanes.plain_flights import AT_STOP, NOT_PLAIN, plain_flights_in_lanes
from vibeam.flight.kernels.lanes.simd import eight, one
from vibeam.flight.kernels.layout import Engine
from vibeam.flight.kernels.modal_flow import (
    ROUND_OFF,
    begin_flight,
    contact_pull,
    end_flight,
    lift_or_rest,
    rest_on_stop,
)
from vibeam.flight.kernels.roots.double_gap import InitialState
from vibeam.flight.kernels.roots.first_root import first_root
from vibeam.flight.kernels.roots.signal import Start, signal_of
from vibeam.flight.kernels.segments import (
    MotionRecord,
    Progress,
    add,
    close_segment,
    note_chatter,
    open_segment,
    work_of,
)
from vibeam_models.arrays import Array, Index

EVENTS_AN_IMPACT = 4  # flight, impact, rest, release: more are no motion but a fault, and end it
IDLE = 1000  # events in a row without time or impact, the same
PIECE = 4_000_000  # impacts and panels, times modes and a few, after which a call pauses: some hundredths of a second


@kernel
def advance(
    engine: Engine, pose: Array, status: Array, span: float, most: int, trace: Array, poses: Array, counts: Index
) -> tuple[int, float]:
    """Carry ``pose`` and ``status`` on by ``span`` seconds: outcome, time done.

    Segments go to ``trace`` (m, TRACE_COLUMNS) and their first poses to ``poses`` (m, 2, n), where m > 0. FULL: no row
    is left; empty them and call again with the rest of the span. PAUSED: call again with the same span, and it goes on
    to the bit. It ends at ``most`` impacts in counts[IMPACTS].
    """
    done, lost, rows, idle = status[layout.DONE], status[layout.LOST], trace.shape[0], 0
    plain = engine.cells.shape[0] > 0 and engine.signal[layout.ATTACHED] == 0.0
    begun, piece, record = work_of(counts), piece_of(pose), MotionRecord(trace, poses, counts)
    if done == 0.0:
        status[layout.CLOCK] = wrap(engine.drive, status[layout.CLOCK])
        status[layout.PHASE_COS], status[layout.PHASE_SIN] = phase(engine.drive, status[layout.CLOCK])
    status[layout.DONE], status[layout.LOST] = 0.0, 0.0
    while done < span:
        if rows > 0 and counts[layout.SEGMENTS] >= rows:
            return layout.FULL, done
        unusual = not plain or status[layout.KIND] == layout.RESTING
        if not unusual:
            upto = min(most, counts[layout.IMPACTS] + piece)
            what, done, lost, flown = plain_flights(engine, pose, status, Progress(span, done, lost), upto, record)
            if what == AT_STOP:
                record_impact(engine, pose, status, flown, record)
            unusual = what == NOT_PLAIN
        if unusual:
            struck_before = counts[layout.IMPACTS]
            if rows > 0:
                open_segment(trace, poses, pose, status, done, counts[layout.SEGMENTS])
            if status[layout.KIND] == layout.RESTING:
                outcome, step = rest_on_stop(engine, pose, status, span - done, record)
            else:
                outcome, step = free_flight(engine, pose, status, span - done, record)
            if outcome != layout.COMPLETE:
                return outcome, done
            if step >= span - done:
                return layout.COMPLETE, span
            done, lost = add(done, lost, step)
            idle = idle + 1 if step <= 0.0 and counts[layout.IMPACTS] == struck_before else 0
            if idle > IDLE:
                return layout.UNRESOLVED, done
        counts[layout.EVENTS] += 1
        if (counts[layout.IMPACTS] >= most or counts[layout.EVENTS] > EVENTS_AN_IMPACT * (most + 100)) and done < span:
            return layout.EVENT_LIMIT, done
        if work_of(counts) - begun >= piece and done < span:
            status[layout.DONE], status[layout.LOST] = done, lost
            return layout.PAUSED, done
    return layout.COMPLETE, done


@joined
def piece_of(pose: Array) -> int:
    """Work between two pauses, in impacts and panels."""
    return int(PIECE // (pose.shape[1] + 8))


@joined
def plain_flights(
    engine: Engine, pose: Array, status: Array, progress: Progress, most: int, record: MotionRecord
) -> tuple[int, float, float, float]:
    """``plain_flights_in_lanes`` in as many lanes as serve the system."""
    if pose.shape[1] == 1:
        return plain_flights_in_lanes(engine, pose, status, progress, most, record, one())
    return plain_flights_in_lanes(engine, pose, status, progress, most, record, eight())


@kernel
def record_impact(engine: Engine, pose: Array, status: Array, flight: float, record: MotionRecord) -> None:
    """The impact at the end of a flight."""
    before, end = apply_impact(engine, pose, status, record)
    record.counts[layout.IMPACTS] += 1
    record.counts[layout.CHATTERS] += 1 if end == layout.CHATTER else 0
    close_segment(record.trace, flight, end, before, record.counts)


@joined
def free_flight(engine: Engine, pose: Array, status: Array, span: float, record: MotionRecord) -> tuple[int, float]:
    """One flight and the impact at its end: outcome, duration."""
    value, _, size = begin_flight(engine, pose, status[layout.PHASE_COS], status[layout.PHASE_SIN])
    if not np.isfinite(size):
        return layout.NOT_FINITE, 0.0
    found, flight = False, 0.0
    if status[layout.ORDER] == 0.0 and value <= ROUND_OFF * size:
        if value < -1e4 * ROUND_OFF * size:
            return layout.PENETRATED, 0.0
        approach = contact_velocity(engine.modes[layout.CONTACT], pose)
        if approach < 0.0:
            status[layout.ORDER], status[layout.RISE] = 1.0, -approach
        elif approach > 0.0:
            found = True
        else:
            toward, jerk = contact_pull(engine.pairs, engine.modes, engine.drive, pose, status)
            if lift_or_rest(status, toward, jerk) == layout.STUCK:
                return layout.COMPLETE, 0.0
    if not found:
        found, flight, panels = first_root(
            signal_of(engine), Start(int(status[layout.ORDER]), status[layout.RISE]), span,
            int(engine.drive[layout.COARSEST]), InitialState(engine.modes, engine.drive, pose, status[layout.CLOCK]),
        )  # fmt: skip
        record.counts[layout.PANELS] += panels
        if flight < 0.0:
            return layout.UNRESOLVED, 0.0
        end_flight(engine, pose, status, flight, found)
    status[layout.ORDER] = 0.0
    if found:
        record_impact(engine, pose, status, flight, record)
    else:
        close_segment(record.trace, flight, layout.SPAN_END, 0.0, record.counts)
    return layout.COMPLETE, flight


@joined
def apply_impact(engine: Engine, pose: Array, status: Array, record: MotionRecord) -> tuple[float, int]:
    """The impact: velocities through the impulse, then flight, chatter's end or rest. Velocity before, what it was."""
    before = strike(engine.modes, engine.drive, pose)
    after = engine.drive[layout.RESTITUTION] * before
    status[layout.SPEED] = max(status[layout.SPEED], before)
    if after <= 0.0:
        settle_on_stop(engine.modes, engine.drive, pose)
        toward, jerk = contact_pull(engine.pairs, engine.modes, engine.drive, pose, status)
        return before, lift_or_rest(status, toward, jerk)
    left, remainder = chatter_left(engine, pose, status, after)
    if left < 0.0:
        status[layout.ORDER], status[layout.RISE] = 1.0, after
        return before, layout.IMPACT
    settle_on_stop(engine.modes, engine.drive, pose)
    status[layout.KIND], status[layout.ORDER] = layout.RESTING, 0.0
    note_chatter(record, left, remainder)
    return before, layout.CHATTER
