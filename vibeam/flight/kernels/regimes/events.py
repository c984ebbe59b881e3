"""Event loop of regimes, any law, two stops, coupled damping: flight, contact, rest, release."""

from __future__ import annotations

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.block_flow import advance_blocks, set_signal, to_block_coordinates
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.drive import wrap
from vibeam.flight.kernels.events import IDLE, PIECE
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.kernels.modal_flow import ROUND_OFF, SMALLEST, release
from vibeam.flight.kernels.readout import extremes
from vibeam.flight.kernels.regimes import layout as row
from vibeam.flight.kernels.regimes.contact import classify, leave_stop, on_contact
from vibeam.flight.kernels.regimes.contact_integration import integrate_contact
from vibeam.flight.kernels.regimes.contact_motion import approach, force_parts, leading_order, pull
from vibeam.flight.kernels.regimes.layout import RegimeEngine
from vibeam.flight.kernels.roots.double_gap import InitialState
from vibeam.flight.kernels.roots.first_root import first_root
from vibeam.flight.kernels.roots.signal import Start, signal_of
from vibeam.flight.kernels.segments import (
    MotionRecord,
    add,
    close_segment,
    note_chatter,
    open_segment,
    turns_of,
    work_of,
)
from vibeam_models.arrays import Array, Index

EVENTS_AN_IMPACT = 16  # on average, before a run is given up
STALLS = 6  # segments next to no time in a row, after which a signal in doubt holds until it is out of doubt
TINY = 1e-15  # how little time, as a share of the coarsest panel
STEPS_A_PANEL = 20_000  # steps of integrated contact, on average, before a run is given up
STEP_WORK = 16  # panels that such a step is as much work as
NONE = -1  # no signal has a root


@kernel
def advance(
    engine: RegimeEngine, pose: Array, status: Array, span: float, most: int, trace: Array, poses: Array,
    counts: Index,
) -> tuple[int, float]:  # fmt: skip
    """Carry ``pose`` and ``status`` on by ``span`` seconds: outcome, time done; as the plain system's ``advance``."""
    done, lost, rows = status[layout.DONE], status[layout.LOST], trace.shape[0]
    begun, piece, record = work_of(counts), piece_of(engine, pose), MotionRecord(trace, poses, counts)
    status[layout.DONE], status[layout.LOST] = 0.0, 0.0
    if done == 0.0:
        status[layout.CLOCK] = wrap(engine.drive, status[layout.CLOCK])
    if status[layout.ORDER] == row.UNKNOWN:
        outcome = classify(engine, pose, status)
        if outcome != layout.COMPLETE:
            return outcome, 0.0
    while done < span:
        left = span - done
        if rows > 0:
            if counts[layout.SEGMENTS] >= rows:
                return layout.FULL, done
            open_segment(trace, poses, pose, status, done, counts[layout.SEGMENTS])
        outcome, step = segment(engine, pose, status, left, record)
        if outcome != layout.COMPLETE:
            return outcome, done
        if step >= left:
            return layout.COMPLETE, span
        done, lost = add(done, lost, step)
        begun -= turns_of(engine.omega, step) if rows > 0 else 0
        counts[layout.EVENTS] += 1
        if (counts[layout.IMPACTS] >= most or counts[layout.EVENTS] > EVENTS_AN_IMPACT * (most + 100)) and done < span:
            return layout.EVENT_LIMIT, done
        if work_of(counts) - begun >= piece and done < span:
            status[layout.DONE], status[layout.LOST] = done, lost
            return layout.PAUSED, done
    return layout.COMPLETE, done


@kernel
def piece_of(engine: RegimeEngine, pose: Array) -> int:
    """Panels between two pauses."""
    dense = pose.shape[1] if engine.law[row.COUPLED] > 0.0 else 1
    return int(PIECE // ((pose.shape[1] + 8) * dense * (STEP_WORK if engine.law[row.FAMILY] == row.CURVED else 1)))


@kernel
def segment(engine: RegimeEngine, pose: Array, status: Array, span: float, record: MotionRecord) -> tuple[int, float]:
    """Up to the first root of the signals watched, and what follows by the law: outcome, duration, which may be 0."""
    if status[row.STALL] > IDLE or status[row.BUSY] > STEPS_A_PANEL:
        return layout.UNRESOLVED, 0.0
    counts, what, side = record.counts, status[layout.KIND], status[row.SIDE]
    status[row.PEAKED] = 0.0
    outcome, met, step = to_event(engine, pose, status, span, record)
    if outcome != layout.COMPLETE or not np.isfinite(step):
        return layout.NOT_FINITE if outcome == layout.COMPLETE else outcome, 0.0
    status[layout.CLOCK] = wrap(engine.drive, status[layout.CLOCK] + step)
    before, end = follow(engine, pose, status, met, step)
    struck = end in (layout.IMPACT, layout.CHATTER, layout.STUCK)
    counts[layout.IMPACTS] += 1 if struck else 0
    counts[layout.CHATTERS] += 1 if end == layout.CHATTER else 0
    if end == layout.CHATTER:
        note_chatter(record, status[row.LEFT_OVER], status[row.LEFT_ERROR])
    if record.trace.shape[0] > 0:
        line = record.trace[counts[layout.SEGMENTS]]
        line[layout.WHAT] = layout.FREE if what == row.INSIDE else what
        line[row.AT_SIDE] = status[row.SIDE] if struck else side
        line[row.PEAK] = status[row.PEAKED]
    close_segment(record.trace, step, end, before, counts)
    soon = step <= TINY * longest_panel(engine) and not (struck and engine.law[row.FAMILY] == row.IMPULSIVE)
    status[row.STALL] = status[row.STALL] + 1.0 if soon else 0.0
    return layout.COMPLETE, step


@kernel
def longest_panel(engine: RegimeEngine) -> float:
    """The longest panel, s."""
    return float(engine.free.levels[layout.STEP, int(engine.drive[layout.COARSEST])])


@kernel
def to_event(
    engine: RegimeEngine, pose: Array, status: Array, span: float, record: MotionRecord
) -> tuple[int, int, float]:
    """Carry ``pose`` on to the end of a segment: outcome, which signal's root it is (NONE: span's end), duration."""
    side, traced = int(status[row.SIDE]), record.trace.shape[0] > 0
    if status[layout.KIND] == row.CONTACT and engine.law[row.FAMILY] == row.CURVED:
        found, step, stages = integrate_contact(engine, pose, status, side, status[layout.CLOCK], span, traced)
        record.counts[layout.PANELS] += stages
        status[row.BUSY] = max(status[row.BUSY] - STEPS_A_PANEL * step / longest_panel(engine), 0.0) + stages
        return layout.COMPLETE, 0 if found else NONE, step
    if status[layout.ORDER] == row.HIT:
        return layout.COMPLETE, side, 0.0
    clock, regime = status[layout.CLOCK], regime_of(engine, status[layout.KIND], side)
    to_block_coordinates(regime, engine.drive, pose, clock)
    outcome, met, step = first_signal(engine, regime, pose, status, span, record.counts)
    if outcome != layout.COMPLETE:
        return outcome, NONE, 0.0
    if status[layout.KIND] == row.CONTACT and traced:
        _, status[row.PEAKED] = extremes(signal_of(regime), step, int(engine.drive[layout.COARSEST]), 0.0, 0.0)
    if step > 0.0:
        advance_blocks(regime, engine.drive, pose, clock, step)
    if not (np.isfinite(status[row.PEAKED]) and np.isfinite(pose[0, 0])):
        return layout.UNRESOLVED, NONE, 0.0
    return layout.COMPLETE, met, step


@kernel
def first_signal(
    engine: RegimeEngine, regime: Regime, pose: Array, status: Array, span: float, counts: Index
) -> tuple[int, int, float]:
    """The first root of the signals watched in a regime just entered: outcome, whose it is (NONE: nobody's), time."""
    met, step, kind = NONE, span, status[layout.KIND]
    watched = 2 if kind == row.INSIDE else (int(engine.law[row.SIDES]) if kind == layout.FREE else 1)
    for i in range(watched):
        which, sign = watch_for(status, i)
        value, rate, size = set_signal(regime, engine.drive, which, sign, status[layout.CLOCK])
        if not np.isfinite(size):
            return layout.NOT_FINITE, NONE, 0.0
        if kind == layout.RESTING:
            size = max(size, force_parts(engine, pose))
        order, rise = start_of(regime, status, i, value, rate, size)
        if size == 0.0 and kind != layout.FREE:
            continue
        if is_held(status, i, order):
            regime.signal[layout.CONST] += 2.0 * (ROUND_OFF * size + max(-value, 0.0)) + SMALLEST
            order, rise = 0, 0.0
        if order < 0:
            return layout.COMPLETE, i, 0.0
        found, time, panels = first_root(
            signal_of(regime), Start(order, rise), step, int(engine.drive[layout.COARSEST]),
            InitialState(engine.free.blocks, engine.drive, pose, layout.NO_CLOCK),
        )  # fmt: skip
        counts[layout.PANELS] += panels
        if time < 0.0:
            return layout.UNRESOLVED, NONE, 0.0
        if found:
            met, step = i, time
    return layout.COMPLETE, met, step


@kernel
def is_held(status: Array, i: int, order: int) -> bool:
    """True where the i-th signal, which starts at 0, is taken to start above it: until it is below it beyond round-off.

    So where the stop is just touched; and in segments that take next to no time, one after the other: round-off makes
    them, and what it says is not to be followed.
    """
    if status[layout.KIND] == layout.FREE and status[layout.ORDER] == row.TOUCHING:
        return int(status[row.SIDE]) == i
    return status[row.STALL] >= STALLS and order != 0


@kernel
def watch_for(status: Array, i: int) -> tuple[int, float]:
    """The i-th signal to watch and its sign: in flight the gaps, on the stop its force, inside its range both."""
    if status[layout.KIND] == layout.FREE:
        return layout.GAP_SIGNAL + i, 1.0
    if status[layout.KIND] == row.INSIDE:
        return (layout.GAP_SIGNAL if i == 0 else layout.FORCE_SIGNAL) + int(status[row.SIDE]), -1.0
    return layout.FORCE_SIGNAL + int(status[row.SIDE]), 1.0


@kernel
def start_of(regime: Regime, status: Array, i: int, value: float, rate: float, size: float) -> tuple[int, float]:
    """Start of the signal just shown: see ``leading_order``. A flight knows which stop it left, and how.

    A contact or a retreat that just began knows that its force cannot be negative yet, whatever round-off makes of it.
    """
    if status[layout.KIND] != layout.FREE:
        fresh = status[layout.ORDER] > 0.0 and (status[layout.KIND] == row.CONTACT or i == 1)
        return leading_order(regime, max(value, 0.0) if fresh else value, rate, size)
    if int(status[row.SIDE]) == i and status[layout.ORDER] > 0.0:
        return int(status[layout.ORDER]), status[layout.RISE]
    return 0, 0.0


@kernel
def follow(engine: RegimeEngine, pose: Array, status: Array, met: int, step: float) -> tuple[float, int]:
    """Sequel of the root of the ``met``-th signal (−1: none): contact velocity before, what it was."""
    kind, side = status[layout.KIND], int(status[row.SIDE])
    if met < 0:
        status[layout.ORDER] = row.UNKNOWN if kind == layout.FREE else 0.0
        return 0.0, layout.SPAN_END
    if kind == layout.FREE:
        return on_contact(engine, pose, status, met, approach(engine, pose, met))
    if kind == row.INSIDE:
        if met == 0:
            leave_stop(engine, pose, status, side)
        else:
            status[layout.KIND], status[layout.ORDER] = row.CONTACT, 1.0
        return 0.0, row.PASS
    if kind == layout.RESTING:
        toward, jerk = pull(engine, pose, side, status[layout.CLOCK])
        release(status, toward, jerk, step > 0.0)
    elif engine.law[row.FAMILY] == row.LINEAR and engine.law[row.DAMPING] > 0.0:
        status[layout.KIND], status[layout.ORDER] = (row.INSIDE, 1.0)  # the force is gone before the penetration is
    else:
        leave_stop(engine, pose, status, side)
    return 0.0, layout.RELEASE


@kernel
def regime_of(engine: RegimeEngine, kind: float, side: int) -> Regime:
    """The regime of flight and retreat, or the one at a stop, pushed by it or resting on it."""
    if kind != layout.RESTING and kind != row.CONTACT:
        return engine.free
    return engine.upper if side == 0 else engine.lower
