"""Event loop of regimes, any law, two stops, coupled damping: flight, contact, rest, release."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.block_flow import advance_blocks, set_signal, to_block_coordinates
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.drive import wrap
from vibeam.flight.kernels.events import IDLE, PIECE
from vibeam.flight.kernels.extremes import extremes
from vibeam.flight.kernels.layout import (
    CHATTER,
    CHATTERS,
    CLOCK,
    COARSEST,
    COMPLETE,
    CONST,
    DONE,
    EVENT_LIMIT,
    EVENTS,
    FORCE_SIGNAL,
    FREE,
    FULL,
    GAP_SIGNAL,
    IMPACT,
    IMPACTS,
    KIND,
    LOST,
    NO_CLOCK,
    NOT_FINITE,
    ORDER,
    PANELS,
    PAUSED,
    RELEASE,
    RESTING,
    RISE,
    SEGMENTS,
    SPAN_END,
    STEP,
    STUCK,
    UNRESOLVED,
    WHAT,
    Regime,
)
from vibeam.flight.kernels.modal_flow import ROUND_OFF
from vibeam.flight.kernels.regimes.contact import classify, leave_stop, on_contact
from vibeam.flight.kernels.regimes.contact_integration import integrate_contact
from vibeam.flight.kernels.regimes.contact_motion import approach, force_parts, pull
from vibeam.flight.kernels.regimes.layout import (
    AT_SIDE,
    BUSY,
    CONTACT,
    COUPLED,
    CURVED,
    DAMPING,
    FAMILY,
    HIT,
    IMPULSIVE,
    INSIDE,
    LEFT_ERROR,
    LEFT_OVER,
    LINEAR,
    PASS,
    PEAK,
    PEAKED,
    SIDE,
    SIDES,
    STALL,
    TOUCHING,
    UNKNOWN,
    RegimeEngine,
)
from vibeam.flight.kernels.regimes.leading_order import leading_order
from vibeam.flight.kernels.rest import SMALLEST, release
from vibeam.flight.kernels.roots.double_gap import InitialState
from vibeam.flight.kernels.roots.first_root import first_root
from vibeam.flight.kernels.roots.signal import Start, signal_of
from vibeam.flight.kernels.segments import Record, add, close_segment, note_chatter, open_segment, work_of

Array = NDArray[np.float64]

EVENTS_AN_IMPACT = 16  # on average, before a run is given up

STALLS = 6  # segments next to no time in a row, after which a signal in doubt holds until it is out of doubt

TINY = 1e-15  # how little time, as a share of the coarsest panel

STEPS_A_PANEL = 20_000  # steps of integrated contact, on average, before a run is given up

STEP_WORK = 16  # panels that such a step is as much work as

NONE = -1  # no signal has a root


@kernel
def advance(
    plan: RegimeEngine, pose: Array, status: Array, span: float, most: int, trace: Array, poses: Array,
    counts: NDArray[np.int64],
) -> tuple[int, float]:  # fmt: skip
    """Carry ``pose`` and ``status`` on by ``span`` seconds: outcome, time done; as the plain system's ``advance``."""
    done, lost, rows = status[DONE], status[LOST], trace.shape[0]
    begun, piece, record = work_of(counts), piece_of(plan, pose), Record(trace, poses, counts)
    status[DONE], status[LOST] = 0.0, 0.0
    if done == 0.0:
        status[CLOCK] = wrap(plan.drive, status[CLOCK])
    if status[ORDER] == UNKNOWN:
        outcome = classify(plan, pose, status)
        if outcome != COMPLETE:
            return outcome, 0.0
    while done < span:
        left = span - done
        if rows > 0:
            if counts[SEGMENTS] >= rows:
                return FULL, done
            open_segment(trace, poses, pose, status, done, counts[SEGMENTS])
        outcome, step = segment(plan, pose, status, left, record)
        if outcome != COMPLETE:
            return outcome, done
        if step >= left:
            return COMPLETE, span
        done, lost = add(done, lost, step)
        counts[EVENTS] += 1
        if (counts[IMPACTS] >= most or counts[EVENTS] > EVENTS_AN_IMPACT * (most + 100)) and done < span:
            return EVENT_LIMIT, done
        if work_of(counts) - begun >= piece and done < span:
            status[DONE], status[LOST] = done, lost
            return PAUSED, done
    return COMPLETE, done


@kernel
def piece_of(plan: RegimeEngine, pose: Array) -> int:
    """Panels between two pauses."""
    dense = pose.shape[1] if plan.law[COUPLED] > 0.0 else 1
    return int(PIECE // ((pose.shape[1] + 8) * dense * (STEP_WORK if plan.law[FAMILY] == CURVED else 1)))


@kernel
def segment(plan: RegimeEngine, pose: Array, status: Array, span: float, record: Record) -> tuple[int, float]:
    """Up to the first root of the signals watched, and what follows by the law: outcome, duration, which may be 0."""
    if status[STALL] > IDLE or status[BUSY] > STEPS_A_PANEL:
        return UNRESOLVED, 0.0
    counts, what, side, status[PEAKED] = record.counts, status[KIND], status[SIDE], 0.0
    outcome, met, step = to_event(plan, pose, status, span, record)
    if outcome != COMPLETE or not np.isfinite(step):
        return NOT_FINITE if outcome == COMPLETE else outcome, 0.0
    status[CLOCK] = wrap(plan.drive, status[CLOCK] + step)
    before, end = follow(plan, pose, status, met, step)
    struck = end in (IMPACT, CHATTER, STUCK)
    counts[IMPACTS] += 1 if struck else 0
    counts[CHATTERS] += 1 if end == CHATTER else 0
    if end == CHATTER:
        note_chatter(record, status[LEFT_OVER], status[LEFT_ERROR])
    if record.trace.shape[0] > 0:
        row = record.trace[counts[SEGMENTS]]
        row[WHAT], row[AT_SIDE] = FREE if what == INSIDE else what, status[SIDE] if struck else side
        row[PEAK] = status[PEAKED]
    close_segment(record.trace, step, end, before, counts)
    soon = step <= TINY * longest_panel(plan) and not (struck and plan.law[FAMILY] == IMPULSIVE)
    status[STALL] = status[STALL] + 1.0 if soon else 0.0
    return COMPLETE, step


@kernel
def longest_panel(plan: RegimeEngine) -> float:
    """The longest panel, s."""
    return float(plan.free.levels[STEP, int(plan.drive[COARSEST])])


@kernel
def to_event(plan: RegimeEngine, pose: Array, status: Array, span: float, record: Record) -> tuple[int, int, float]:
    """Carry ``pose`` on to the end of a segment: outcome, which signal's root it is (NONE: span's end), duration."""
    side, traced = int(status[SIDE]), record.trace.shape[0] > 0
    if status[KIND] == CONTACT and plan.law[FAMILY] == CURVED:
        found, step, stages = integrate_contact(plan, pose, status, side, status[CLOCK], span, traced)
        record.counts[PANELS] += stages
        status[BUSY] = max(status[BUSY] - STEPS_A_PANEL * step / longest_panel(plan), 0.0) + stages
        return COMPLETE, 0 if found else NONE, step
    if status[ORDER] == HIT:
        return COMPLETE, side, 0.0
    clock, regime = status[CLOCK], plan.free
    if status[KIND] == RESTING or status[KIND] == CONTACT:
        regime = at_side(plan, side)
    to_block_coordinates(regime, plan.drive, pose, clock)
    outcome, met, step = first_signal(plan, regime, pose, status, span, record.counts)
    if outcome != COMPLETE:
        return outcome, NONE, 0.0
    if status[KIND] == CONTACT and traced:
        _, status[PEAKED] = extremes(signal_of(regime), step, int(plan.drive[COARSEST]), 0.0, 0.0)
    if step > 0.0:
        advance_blocks(regime, plan.drive, pose, clock, step)
    if not (np.isfinite(status[PEAKED]) and np.isfinite(pose[0, 0])):
        return UNRESOLVED, NONE, 0.0
    return COMPLETE, met, step


@kernel
def first_signal(
    plan: RegimeEngine, regime: Regime, pose: Array, status: Array, span: float, counts: NDArray[np.int64]
) -> tuple[int, int, float]:
    """The first root of the signals watched in a regime just entered: outcome, whose it is (NONE: nobody's), time."""
    met, step, kind = NONE, span, status[KIND]
    watched = 2 if kind == INSIDE else (int(plan.law[SIDES]) if kind == FREE else 1)
    for i in range(watched):
        which, sign = watch_for(status, i)
        value, rate, size = set_signal(regime, plan.drive, which, sign, status[CLOCK])
        if not np.isfinite(size):
            return NOT_FINITE, NONE, 0.0
        if kind == RESTING:
            size = max(size, force_parts(plan, pose))
        order, rise = start_of(regime, status, i, value, rate, size)
        if size == 0.0 and kind != FREE:
            continue
        if is_held(status, i, order):
            regime.signal[CONST] += 2.0 * (ROUND_OFF * size + max(-value, 0.0)) + SMALLEST
            order, rise = 0, 0.0
        if order < 0:
            return COMPLETE, i, 0.0
        found, time, panels = first_root(
            signal_of(regime), Start(order, rise), step, int(plan.drive[COARSEST]),
            InitialState(plan.free.blocks, plan.drive, pose, NO_CLOCK),
        )  # fmt: skip
        counts[PANELS] += panels
        if time < 0.0:
            return UNRESOLVED, NONE, 0.0
        if found:
            met, step = i, time
    return COMPLETE, met, step


@kernel
def is_held(status: Array, i: int, order: int) -> bool:
    """Whether the i-th signal, which starts at 0, is taken to start above it: until it is below it beyond round-off.

    So where the stop is just touched; and in segments that take next to no time, one after the other: round-off makes
    them, and what it says is not to be followed.
    """
    if status[KIND] == FREE and status[ORDER] == TOUCHING:
        return int(status[SIDE]) == i
    return status[STALL] >= STALLS and order != 0


@kernel
def watch_for(status: Array, i: int) -> tuple[int, float]:
    """The i-th signal to watch and its sign: in flight the gaps, on the stop its force, inside its range both."""
    if status[KIND] == FREE:
        return GAP_SIGNAL + i, 1.0
    if status[KIND] == INSIDE:
        return (GAP_SIGNAL if i == 0 else FORCE_SIGNAL) + int(status[SIDE]), -1.0
    return FORCE_SIGNAL + int(status[SIDE]), 1.0


@kernel
def start_of(regime: Regime, status: Array, i: int, value: float, rate: float, size: float) -> tuple[int, float]:
    """How the signal just shown starts: see ``leading_order``. A flight knows which stop it left, and how.

    A contact or a retreat that just began knows that its force cannot be negative yet, whatever round-off makes of it.
    """
    if status[KIND] != FREE:
        fresh = status[ORDER] > 0.0 and (status[KIND] == CONTACT or i == 1)
        return leading_order(regime, max(value, 0.0) if fresh else value, rate, size)
    if int(status[SIDE]) == i and status[ORDER] > 0.0:
        return int(status[ORDER]), status[RISE]
    return 0, 0.0


@kernel
def follow(plan: RegimeEngine, pose: Array, status: Array, met: int, step: float) -> tuple[float, int]:
    """What comes after the root of the ``met``-th signal (−1: none): contact velocity before, what it was."""
    kind, side = status[KIND], int(status[SIDE])
    if met < 0:
        status[ORDER] = UNKNOWN if kind == FREE else 0.0
        return 0.0, SPAN_END
    if kind == FREE:
        return on_contact(plan, pose, status, met, approach(plan, pose, met))
    if kind == INSIDE:
        if met == 0:
            leave_stop(plan, pose, status, side)
        else:
            status[KIND], status[ORDER] = CONTACT, 1.0
        return 0.0, PASS
    if kind == RESTING:
        toward, jerk = pull(plan, pose, side, status[CLOCK])
        release(status, toward, jerk, step > 0.0)
    elif plan.law[FAMILY] == LINEAR and plan.law[DAMPING] > 0.0:
        status[KIND], status[ORDER] = INSIDE, 1.0  # the force is gone before the penetration is
    else:
        leave_stop(plan, pose, status, side)
    return 0.0, RELEASE


@kernel
def at_side(plan: RegimeEngine, side: int) -> Regime:
    """The regime at one of the stops."""
    if side == 0:
        return plan.upper
    return plan.lower
