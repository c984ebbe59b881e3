"""Event loop of a plain system, one stop and one coefficient of restitution: flight, impact, chatter, rest, release."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.drive import phase, wrap
from vibeam.flight.kernels.impact import chatter_left, contact_velocity, settle_on_stop, strike
from vibeam.flight.kernels.lanes.plain_flights import AT_STOP, NOT_PLAIN, plain_flights_in_lanes
from vibeam.flight.kernels.lanes.simd import eight, one
from vibeam.flight.kernels.layout import (
    ATTACHED,
    CHATTER,
    CHATTERS,
    CLOCK,
    COARSEST,
    COMPLETE,
    CONTACT,
    DONE,
    EVENT_LIMIT,
    EVENTS,
    FULL,
    IMPACT,
    IMPACTS,
    KIND,
    LOST,
    NOT_FINITE,
    ORDER,
    PANELS,
    PAUSED,
    PENETRATED,
    PHASE_COS,
    PHASE_SIN,
    RESTING,
    RESTITUTION,
    RISE,
    SEGMENTS,
    SPAN_END,
    SPEED,
    STUCK,
    UNRESOLVED,
    Engine,
)
from vibeam.flight.kernels.modal_flow import ROUND_OFF, begin_flight, contact_pull, end_flight
from vibeam.flight.kernels.rest import lift_or_rest, rest_on_stop
from vibeam.flight.kernels.roots.double_gap import InitialState
from vibeam.flight.kernels.roots.first_root import first_root
from vibeam.flight.kernels.roots.signal import Start, signal_of
from vibeam.flight.kernels.segments import Progress, Record, add, close_segment, note_chatter, open_segment, work_of

Array = NDArray[np.float64]

EVENTS_AN_IMPACT = 4  # flight, impact, rest, release: more are no motion but a fault, and end it

IDLE = 1000  # events in a row without time or impact, the same

PIECE = 4_000_000  # impacts and panels, times modes and a few, after which a call pauses: some hundredths of a second


@kernel
def advance(
    desk: Engine,
    pose: Array,
    status: Array,
    span: float,
    most: int,
    trace: Array,
    poses: Array,
    counts: NDArray[np.int64],
) -> tuple[int, float]:
    """Carry ``pose`` and ``status`` on by ``span`` seconds: outcome, time done.

    Segments go to ``trace`` (m, TRACE_COLUMNS) and their first poses to ``poses`` (m, 2, n), where m > 0. FULL: no row
    is left; empty them and call again with the rest of the span. PAUSED: call again with the same span, and it goes on
    to the bit. It ends at ``most`` impacts in counts[IMPACTS].
    """
    done, lost, rows, idle = status[DONE], status[LOST], trace.shape[0], 0
    plain = desk.cells.shape[0] > 0 and desk.signal[ATTACHED] == 0.0
    begun, piece, record = work_of(counts), piece_of(pose), Record(trace, poses, counts)
    if done == 0.0:
        status[CLOCK] = wrap(desk.drive, status[CLOCK])
        status[PHASE_COS], status[PHASE_SIN] = phase(desk.drive, status[CLOCK])
    status[DONE], status[LOST] = 0.0, 0.0
    while done < span:
        if rows > 0 and counts[SEGMENTS] >= rows:
            return FULL, done
        unusual = not plain or status[KIND] == RESTING
        if not unusual:
            upto = min(most, counts[IMPACTS] + piece)
            what, done, lost, flown = plain_flights(desk, pose, status, Progress(span, done, lost), upto, record)
            if what == AT_STOP:
                record_impact(desk, pose, status, flown, record)
            unusual = what == NOT_PLAIN
        if unusual:
            struck_before = counts[IMPACTS]
            if rows > 0:
                open_segment(trace, poses, pose, status, done, counts[SEGMENTS])
            if status[KIND] == RESTING:
                outcome, step = rest_on_stop(desk, pose, status, span - done, record)
            else:
                outcome, step = free_flight(desk, pose, status, span - done, record)
            if outcome != COMPLETE:
                return outcome, done
            if step >= span - done:
                return COMPLETE, span
            done, lost = add(done, lost, step)
            idle = idle + 1 if step <= 0.0 and counts[IMPACTS] == struck_before else 0
            if idle > IDLE:
                return UNRESOLVED, done
        counts[EVENTS] += 1
        if (counts[IMPACTS] >= most or counts[EVENTS] > EVENTS_AN_IMPACT * (most + 100)) and done < span:
            return EVENT_LIMIT, done
        if work_of(counts) - begun >= piece and done < span:
            status[DONE], status[LOST] = done, lost
            return PAUSED, done
    return COMPLETE, done


@joined
def piece_of(pose: Array) -> int:
    """How much of it is done between two pauses."""
    return int(PIECE // (pose.shape[1] + 8))


@joined
def plain_flights(
    desk: Engine, pose: Array, status: Array, progress: Progress, most: int, record: Record
) -> tuple[int, float, float, float]:
    """``plain_flights_in_lanes`` in as many lanes as serve the system."""
    if pose.shape[1] == 1:
        return plain_flights_in_lanes(desk, pose, status, progress, most, record, one())
    return plain_flights_in_lanes(desk, pose, status, progress, most, record, eight())


@kernel
def record_impact(desk: Engine, pose: Array, status: Array, flight: float, record: Record) -> None:
    """The impact at the end of a flight."""
    before, end = apply_impact(desk, pose, status, record)
    record.counts[IMPACTS] += 1
    record.counts[CHATTERS] += 1 if end == CHATTER else 0
    close_segment(record.trace, flight, end, before, record.counts)


@joined
def free_flight(desk: Engine, pose: Array, status: Array, span: float, record: Record) -> tuple[int, float]:
    """One flight and the impact at its end: outcome, duration."""
    value, _, size = begin_flight(desk, pose, status[PHASE_COS], status[PHASE_SIN])
    if not np.isfinite(size):
        return NOT_FINITE, 0.0
    found, flight = False, 0.0
    if status[ORDER] == 0.0 and value <= ROUND_OFF * size:
        if value < -1e4 * ROUND_OFF * size:
            return PENETRATED, 0.0
        approach = contact_velocity(desk.modes[CONTACT], pose)
        if approach < 0.0:
            status[ORDER], status[RISE] = 1.0, -approach
        elif approach > 0.0:
            found = True
        else:
            toward, jerk = contact_pull(desk.pairs, desk.modes, desk.drive, pose, status)
            if lift_or_rest(status, toward, jerk) == STUCK:
                return COMPLETE, 0.0
    if not found:
        found, flight, panels = first_root(
            signal_of(desk), Start(int(status[ORDER]), status[RISE]), span, int(desk.drive[COARSEST]),
            InitialState(desk.modes, desk.drive, pose, status[CLOCK]),
        )  # fmt: skip
        record.counts[PANELS] += panels
        if flight < 0.0:
            return UNRESOLVED, 0.0
        end_flight(desk, pose, status, flight, found)
    status[ORDER] = 0.0
    if found:
        record_impact(desk, pose, status, flight, record)
    else:
        close_segment(record.trace, flight, SPAN_END, 0.0, record.counts)
    return COMPLETE, flight


@joined
def apply_impact(desk: Engine, pose: Array, status: Array, record: Record) -> tuple[float, int]:
    """The impact: velocities through the impulse, then flight, chatter's end or rest. Velocity before, what it was."""
    before = strike(desk.modes, desk.drive, pose)
    after = desk.drive[RESTITUTION] * before
    status[SPEED] = max(status[SPEED], before)
    if after <= 0.0:
        settle_on_stop(desk.modes, desk.drive, pose)
        toward, jerk = contact_pull(desk.pairs, desk.modes, desk.drive, pose, status)
        return before, lift_or_rest(status, toward, jerk)
    left, remainder = chatter_left(desk, pose, status, after)
    if left < 0.0:
        status[ORDER], status[RISE] = 1.0, after
        return before, IMPACT
    settle_on_stop(desk.modes, desk.drive, pose)
    status[KIND], status[ORDER] = RESTING, 0.0
    note_chatter(record, left, remainder)
    return before, CHATTER
