"""The motion from event to event: flight, impact or contact, rest, release."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.block_flow import advance_blocks, set_signal, to_block_coordinates
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.drive import wrap
from vibeam.flight.kernels.events import PIECE
from vibeam.flight.kernels.extremes import extremes
from vibeam.flight.kernels.impact import contact_velocity
from vibeam.flight.kernels.layout import (
    AT_CLOCK,
    BEFORE,
    CHATTER,
    CHATTERS,
    CLOCK,
    COARSEST,
    COMPLETE,
    CONST,
    DONE,
    DURATION,
    END,
    EVENT_LIMIT,
    EVENTS,
    FORCE_SIGNAL,
    FREE,
    FULL,
    GAP_SIGNAL,
    IMPACT,
    IMPACTS,
    KIND,
    LEFT,
    LOST,
    NO_CLOCK,
    NOT_FINITE,
    ORDER,
    PANELS,
    PAUSED,
    PENETRATED,
    RELEASE,
    REMAINDER,
    RESTING,
    RISE,
    SEGMENTS,
    SPAN_END,
    SPEED,
    START,
    STEP,
    STUCK,
    UNRESOLVED,
    WHAT,
    Regime,
)
from vibeam.flight.kernels.modal_flow import ROUND_OFF
from vibeam.flight.kernels.regimes.contact_integration import integrate_contact
from vibeam.flight.kernels.regimes.contact_law import (
    approach,
    chatter_left,
    drift,
    force_parts,
    pull,
    push,
    put_on_stop,
    restitution,
    settle_on_stop,
)
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
    MOBILITY,
    PASS,
    PEAK,
    PEAKED,
    SIDE,
    SIDES,
    STALL,
    STEPPED,
    TOUCHING,
    UNKNOWN,
    RegimeEngine,
)
from vibeam.flight.kernels.regimes.leading_order import leading_order
from vibeam.flight.kernels.rest import SMALLEST
from vibeam.flight.kernels.roots.double_gap import InitialState
from vibeam.flight.kernels.roots.first_root import first_root
from vibeam.flight.kernels.roots.signal import Start, signal_of
from vibeam.flight.kernels.segments import add

Array = NDArray[np.float64]

STALLS = 6  # phases next to no time in a row, after which a signal in doubt holds until it is out of doubt

IDLE = 1000  # such phases in a row, after which a run is given up

TINY = 1e-15  # how little time, as a share of the coarsest panel

PHASES_AN_IMPACT = 16  # how many there may be on average before a run is given up

STEPS_A_PANEL = 20_000  # steps of integrated contact, on average, before a run is given up

STEP_WORK = 16  # panels that such a step is as much work as

PHASES = 10_000  # between two pauses, at most


@kernel
def advance(
    plan: RegimeEngine, pose: Array, status: Array, span: float, most: int, trace: Array, poses: Array,
    counts: NDArray[np.int64],
) -> tuple[int, float]:  # fmt: skip
    """Carry ``pose`` and ``status`` on by ``span`` seconds: outcome, time done; as the flight kernels' ``advance``.

    One loop for all regimes: enter, find the first root of the signals watched, go on to it, and ask the law what
    follows. A phase may have no duration.
    """
    done, lost, rows = status[DONE], status[LOST], trace.shape[0]
    begun, piece = counts[PANELS], piece_of(plan, pose)
    if done == 0.0:
        status[CLOCK] = wrap(plan.drive, status[CLOCK])
    status[DONE], status[LOST] = 0.0, 0.0
    panel = plan.free.levels[STEP, int(plan.drive[COARSEST])]
    if status[ORDER] == UNKNOWN:
        outcome = classify(plan, pose, status)
        if outcome != COMPLETE:
            return outcome, 0.0
    while done < span:
        row, left = counts[SEGMENTS], span - done
        if rows > 0 and row >= rows:
            return FULL, done
        if rows > 0:
            open_segment(trace, poses, pose, status, done, row)
        met, step, peak = -1, left, 0.0
        if status[KIND] == CONTACT and plan.law[FAMILY] == CURVED:
            found, step, stages = integrate_contact(
                plan, pose, status, int(status[SIDE]), status[CLOCK], left, rows > 0
            )
            met, peak = 0 if found else -1, status[PEAKED]
            counts[PANELS] += stages
            begun -= (STEP_WORK - 1) * stages
            status[BUSY] = max(status[BUSY] - STEPS_A_PANEL * step / panel, 0.0) + stages
        elif status[ORDER] == HIT:
            met, step = int(status[SIDE]), 0.0
        else:
            clock, regime = status[CLOCK], plan.free
            if status[KIND] == RESTING or status[KIND] == CONTACT:
                regime = at_side(plan, int(status[SIDE]))
            to_block_coordinates(regime, plan.drive, pose, clock)
            watched = 2 if status[KIND] == INSIDE else (int(plan.law[SIDES]) if status[KIND] == FREE else 1)
            for i in range(watched):
                which, sign = watch_for(status, i)
                value, rate, size = set_signal(regime, plan.drive, which, sign, clock)
                if not np.isfinite(size):
                    return NOT_FINITE, done
                if status[KIND] == RESTING:
                    size = max(size, force_parts(plan, pose))
                order, rise = start_of(regime, status, i, value, rate, size)
                if size == 0.0 and status[KIND] != FREE:
                    continue
                if is_held(status, i, order):
                    regime.signal[CONST] += 2.0 * (ROUND_OFF * size + max(-value, 0.0)) + SMALLEST
                    order, rise = 0, 0.0
                if order < 0:
                    met, step = i, 0.0
                    break
                found, time, panels = first_root(
                    signal_of(regime), Start(order, rise), step, int(plan.drive[COARSEST]),
                    InitialState(plan.free.blocks, plan.drive, pose, NO_CLOCK),
                )  # fmt: skip
                counts[PANELS] += panels
                if time < 0.0:
                    return UNRESOLVED, done
                if found:
                    met, step = i, time
            if status[KIND] == CONTACT and rows > 0:
                _, peak = extremes(signal_of(regime), step, int(plan.drive[COARSEST]), 0.0, 0.0)
            if step > 0.0:
                advance_blocks(regime, plan.drive, pose, clock, step)
            if not (np.isfinite(peak) and np.isfinite(pose[0, 0])):
                return UNRESOLVED, done
        if not np.isfinite(step):
            return NOT_FINITE, done
        status[CLOCK] = wrap(plan.drive, status[CLOCK] + step)
        before, end = follow(plan, pose, status, met, step)
        counts[IMPACTS] += 1 if end in (IMPACT, CHATTER, STUCK) else 0
        counts[CHATTERS] += 1 if end == CHATTER else 0
        if rows > 0:
            close_segment(trace, row, status, step, end, before, peak)
            counts[SEGMENTS] = row + 1
        struck = plan.law[FAMILY] == IMPULSIVE and end in (IMPACT, CHATTER, STUCK)
        status[STALL] = status[STALL] + 1.0 if step <= TINY * panel and not struck else 0.0
        counts[EVENTS] += 1
        if step >= left:
            return COMPLETE, span
        done, lost = add(done, lost, step)
        if done < span:
            if counts[IMPACTS] >= most or counts[EVENTS] > PHASES_AN_IMPACT * (most + 100):
                return EVENT_LIMIT, done
            if status[STALL] > IDLE or status[BUSY] > STEPS_A_PANEL:
                return UNRESOLVED, done
            if counts[PANELS] - begun >= piece or counts[EVENTS] % PHASES == 0:
                status[DONE], status[LOST] = done, lost
                return PAUSED, done
    return COMPLETE, done


@kernel
def piece_of(plan: RegimeEngine, pose: Array) -> int:
    """Panels between two pauses."""
    return int(PIECE // ((pose.shape[1] + 8) * (pose.shape[1] if plan.law[COUPLED] > 0.0 else 1)))


@kernel
def is_held(status: Array, i: int, order: int) -> bool:
    """Whether the i-th signal, which starts at 0, is taken to start above it: until it is below it beyond round-off.

    So where the stop is just touched; and in phases that take next to no time, one after the other: round-off makes
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
        release(plan, pose, status, side, step > 0.0)
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


@kernel
def open_segment(trace: Array, poses: Array, pose: Array, status: Array, time: float, row: int) -> None:
    """Note where a segment starts."""
    inside = status[KIND] == INSIDE
    trace[row, START], trace[row, AT_CLOCK] = time, status[CLOCK]
    trace[row, WHAT], trace[row, AT_SIDE] = FREE if inside else status[KIND], status[SIDE]
    trace[row, LEFT], trace[row, REMAINDER], trace[row, PEAK] = 0.0, 0.0, 0.0
    for k in range(pose.shape[1]):
        poses[row, 0, k], poses[row, 1, k] = pose[0, k], pose[1, k]


@kernel
def close_segment(trace: Array, row: int, status: Array, step: float, end: int, before: float, peak: float) -> None:
    """Note how long it was and what ended it."""
    trace[row, DURATION], trace[row, END], trace[row, BEFORE], trace[row, PEAK] = step, end, before, peak
    if end in (IMPACT, STUCK):
        trace[row, AT_SIDE] = status[SIDE]
    if end == CHATTER:
        trace[row, AT_SIDE], trace[row, LEFT], trace[row, REMAINDER] = (
            status[SIDE],
            status[LEFT_OVER],
            status[LEFT_ERROR],
        )


@kernel
def classify(plan: RegimeEngine, pose: Array, status: Array) -> int:
    """What the motion is in, from its state alone: COMPLETE, or why it cannot be."""
    kind, status[ORDER] = status[KIND], 0.0
    if kind == RESTING and plan.law[FAMILY] == IMPULSIVE:
        return COMPLETE
    status[KIND], status[STEPPED] = FREE, 0.0
    for side in range(int(plan.law[SIDES])):
        to_block_coordinates(plan.free, plan.drive, pose, status[CLOCK])
        value, _, size = set_signal(plan.free, plan.drive, GAP_SIGNAL + side, 1.0, status[CLOCK])
        if not np.isfinite(size):
            return NOT_FINITE
        if value > ROUND_OFF * size:
            continue
        deep = value < -1e4 * ROUND_OFF * size
        if deep and plan.law[FAMILY] == IMPULSIVE:
            return PENETRATED
        status[SIDE] = side
        if deep:
            status[KIND] = CONTACT
        else:
            speed = contact_velocity(plan.contact[side], pose)
            if speed > 0.0:
                status[ORDER] = HIT
            else:
                on_contact(plan, pose, status, side, speed)
    return COMPLETE


@kernel
def on_contact(plan: RegimeEngine, pose: Array, status: Array, side: int, speed: float) -> tuple[float, int]:
    """On the stop, at a contact velocity of ``speed`` towards it: what follows. Velocity before, what it was."""
    status[SIDE], status[KIND], status[ORDER] = side, FREE, 0.0
    if speed < 0.0:
        status[ORDER], status[RISE] = 1.0, -speed
        return 0.0, PASS
    status[SPEED] = max(status[SPEED], speed)
    if plan.law[FAMILY] == IMPULSIVE:
        return apply_impact(plan, pose, status, side, speed)
    if speed <= drift(plan, pose, side):
        touch(plan, pose, status, side)
        return speed, IMPACT if status[KIND] == CONTACT else PASS
    status[KIND], status[ORDER], status[STEPPED] = CONTACT, 1.0, 0.0
    return speed, IMPACT


@kernel
def touch(plan: RegimeEngine, pose: Array, status: Array, side: int) -> None:
    """On a stop that yields, without velocity: into it, away from it, or neither: then it stands there, touching it."""
    order, rise = opening_order(plan, pose, status, side)
    status[KIND], status[ORDER], status[RISE], status[STEPPED] = FREE, order, rise, 0.0
    if order == 0:
        settle_on_stop(plan, pose, side)
        status[ORDER] = TOUCHING
    elif order < 0:
        status[KIND], status[ORDER] = CONTACT, 1.0


@kernel
def opening_order(plan: RegimeEngine, pose: Array, status: Array, side: int) -> tuple[int, float]:
    """Order and size of the derivative by which the gap opens from the stop without velocity; −1 where it closes, 0
    where neither can be told from round-off.
    """
    toward, jerk = pull(plan, pose, side, status[CLOCK])
    if toward < 0.0:
        return 2, -toward
    if toward == 0.0 and jerk <= 0.0:
        return 3 if jerk < 0.0 else 0, -jerk
    return -1, 0.0


@kernel
def apply_impact(plan: RegimeEngine, pose: Array, status: Array, side: int, before: float) -> tuple[float, int]:
    """The impact by R(v): then flight, chatter's end or rest. Velocity before, what it was."""
    after = restitution(plan.law, plan.curve, before) * before
    push(plan, pose, side, -(before + after) / plan.law[MOBILITY])
    if after <= 0.0:
        settle_on_stop(plan, pose, side)
        order, rise = opening_order(plan, pose, status, side)
        status[KIND] = FREE if order > 0 else RESTING
        status[ORDER], status[RISE] = max(order, 0), rise
        return before, IMPACT if order > 0 else STUCK
    put_on_stop(plan, pose, side)
    toward, _ = pull(plan, pose, side, status[CLOCK])
    to_block_coordinates(plan.free, plan.drive, pose, status[CLOCK])
    left, remainder = chatter_left(plan, pose, status, side, toward, after)
    if left < 0.0:
        status[ORDER], status[RISE] = 1.0, after
        return before, IMPACT
    settle_on_stop(plan, pose, side)
    status[KIND], status[ORDER] = RESTING, 0.0
    status[LEFT_OVER], status[LEFT_ERROR] = left, remainder
    return before, CHATTER


@kernel
def release(plan: RegimeEngine, pose: Array, status: Array, side: int, at_root: bool) -> None:
    """Leave the stop where the motion is drawn away from it: with acceleration, or with jerk at the force's root."""
    toward, jerk = pull(plan, pose, side, status[CLOCK])
    if jerk < 0.0 and (at_root or toward >= 0.0):
        status[KIND], status[ORDER], status[RISE] = FREE, 3.0, -jerk
    elif toward < 0.0:
        status[KIND], status[ORDER], status[RISE] = FREE, 2.0, -toward


@kernel
def leave_stop(plan: RegimeEngine, pose: Array, status: Array, side: int) -> None:
    """Out of the stop's range."""
    speed = approach(plan, pose, side)
    status[KIND], status[ORDER], status[RISE], status[STEPPED] = FREE, 1.0, -speed, 0.0
    if -speed <= drift(plan, pose, side):
        touch(plan, pose, status, side)
