"""The motion from event to event: flight, impact or contact, rest, release."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.solvers.kernels.drive import wrap
from vibeam.solvers.kernels.extremes import extremes
from vibeam.solvers.kernels.isolate import first_root
from vibeam.solvers.kernels.jit import kernel
from vibeam.solvers.kernels.layout import (
    AT_CLOCK,
    BEFORE,
    CHATTER,
    CHATTERS,
    CLOCK,
    COARSEST,
    COMPLETE,
    DURATION,
    END,
    EVENT_LIMIT,
    FREE,
    FULL,
    IMPACT,
    IMPACTS,
    KIND,
    LEFT,
    NOT_FINITE,
    ORDER,
    PANELS,
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
    WHOLE,
)
from vibeam.solvers.regimes.kernels.law import approach, chatter_left, push, restitution, settle_on_stop
from vibeam.solvers.regimes.kernels.layout import (
    AT_SIDE,
    CONTACT,
    CURVED,
    DAMPING,
    FAMILY,
    FORCE,
    GAP,
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
    UNKNOWN,
    Plan,
    Regime,
)
from vibeam.solvers.regimes.kernels.regime import ROUND_OFF, curve_of, enter, launch, proceed, show
from vibeam.solvers.regimes.kernels.squeeze import squeeze

Array = NDArray[np.float64]
STALLS = 6  # phases without duration in a row, after which a very short one is taken as it comes
SHORT = 1e-9  # how short, as a share of the coarsest panel
PHASES_AN_IMPACT = 16  # how many there may be on average before a run is given up
NO_CLOCK = -1.0  # tells ``first_root`` that the signal is no gap of uncoupled modes, which it could judge more sharply


@kernel
def advance(
    plan: Plan, pose: Array, status: Array, span: float, limit: int, trace: Array, poses: Array,
    counts: NDArray[np.int64],
) -> tuple[int, float]:  # fmt: skip
    """Carry ``pose`` and ``status`` on by ``span`` seconds: outcome, time done; as the flight kernels' ``advance``.

    One loop for all regimes: enter, find the first root of the signals watched, go on to it, and ask the law what
    follows. A phase may have no duration.
    """
    done, rows = 0.0, trace.shape[0]
    most, phases = counts[IMPACTS] + limit, 0
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
            found, step, stages = squeeze(plan, pose, status, int(status[SIDE]), status[CLOCK], left)
            met, peak = 0 if found else -1, status[PEAKED]
            counts[PANELS] += stages
        elif status[ORDER] == HIT:
            met, step = int(status[SIDE]), 0.0
        else:
            clock, regime = status[CLOCK], plan.free
            if status[KIND] == RESTING or status[KIND] == CONTACT:
                regime = at_side(plan, int(status[SIDE]))
            enter(regime, plan.drive, pose, clock)
            watched = 2 if status[KIND] == INSIDE else (int(plan.law[SIDES]) if status[KIND] == FREE else 1)
            crawling = status[KIND] != FREE and status[STALL] >= STALLS
            for i in range(watched):
                which, sign = watch_for(status, i)
                value, rate, size = show(regime, plan.drive, which, sign, clock)
                if not np.isfinite(size):
                    return NOT_FINITE, done
                order, rise = start_of(regime, status, i, value, rate, size)
                if crawling or (size == 0.0 and status[KIND] != FREE):
                    continue
                if order < 0:
                    met, step = i, 0.0
                    break
                found, time, panels = first_root(
                    regime.pairs, regime.table, regime.levels, regime.signal, regime.attached, order, rise, step,
                    int(plan.drive[COARSEST]), plan.free.blocks, plan.drive, pose, NO_CLOCK,
                )  # fmt: skip
                counts[PANELS] += panels
                if time < 0.0:
                    return UNRESOLVED, done
                if found:
                    met, step = i, time
            if crawling:
                step = min(left, SHORT * plan.free.levels[STEP, int(plan.drive[COARSEST])])
            if status[KIND] == CONTACT and rows > 0:
                _, peak = extremes(
                    regime.pairs, regime.table, regime.levels, regime.signal, regime.attached, step,
                    int(plan.drive[COARSEST]), 0.0, 0.0,
                )  # fmt: skip
            if step > 0.0:
                proceed(regime, plan.drive, pose, clock, step)
        if not np.isfinite(step):
            return NOT_FINITE, done
        status[CLOCK] = wrap(plan.drive, status[CLOCK] + step)
        before, end = follow(plan, pose, status, met, step)
        counts[IMPACTS] += 1 if end in (IMPACT, CHATTER, STUCK) else 0
        counts[CHATTERS] += 1 if end == CHATTER else 0
        if rows > 0:
            close_segment(trace, row, status, step, end, before, peak)
            counts[SEGMENTS] = row + 1
        status[STALL] = status[STALL] + 1.0 if step == 0.0 else 0.0
        done += step
        phases += 1
        if (counts[IMPACTS] >= most or phases > PHASES_AN_IMPACT * (limit + 100)) and done < span:
            return EVENT_LIMIT, done
    return COMPLETE, done


@kernel
def watch_for(status: Array, i: int) -> tuple[int, float]:
    """The i-th signal to watch and its sign: in flight the gaps, on the stop its force, inside its range both."""
    if status[KIND] == FREE:
        return GAP + i, 1.0
    if status[KIND] == INSIDE:
        return (GAP if i == 0 else FORCE) + int(status[SIDE]), -1.0
    return FORCE + int(status[SIDE]), 1.0


@kernel
def start_of(regime: Regime, status: Array, i: int, value: float, rate: float, size: float) -> tuple[int, float]:
    """How the signal just shown starts: see ``launch``. A flight knows which stop it left, and how.

    A contact or a retreat that just began knows that its force cannot be negative yet, whatever round-off makes of it.
    """
    if status[KIND] != FREE:
        fresh = status[ORDER] > 0.0 and (status[KIND] == CONTACT or i == 1)
        return launch(regime, max(value, 0.0) if fresh else value, rate, size)
    if status[ORDER] > 0.0 and int(status[SIDE]) == i:
        return int(status[ORDER]), status[RISE]
    return 0, 0.0


@kernel
def follow(plan: Plan, pose: Array, status: Array, met: int, step: float) -> tuple[float, int]:
    """What comes after the root of the ``met``-th signal (−1: none): contact velocity before, what it was."""
    kind, side = status[KIND], int(status[SIDE])
    if met < 0:
        status[ORDER] = UNKNOWN if kind == FREE else 0.0
        return 0.0, SPAN_END
    if kind == FREE:
        return arrive(plan, pose, status, met)
    if kind == INSIDE:
        if met == 0:
            leave(plan, pose, status, side)
        else:
            status[KIND], status[ORDER] = CONTACT, 1.0
        return 0.0, PASS
    if kind == RESTING:
        release(plan, pose, status, side, step > 0.0)
    elif plan.law[FAMILY] == LINEAR and plan.law[DAMPING] > 0.0:
        status[KIND], status[ORDER] = INSIDE, 1.0  # the force is gone before the penetration is
    else:
        leave(plan, pose, status, side)
    return 0.0, RELEASE


@kernel
def at_side(plan: Plan, side: int) -> Regime:
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
def classify(plan: Plan, pose: Array, status: Array) -> int:
    """What the motion is in, from its state alone: COMPLETE, or why it cannot be."""
    kind, status[ORDER] = status[KIND], 0.0
    if kind == RESTING and plan.law[FAMILY] == IMPULSIVE:
        return COMPLETE
    status[KIND], status[STEPPED] = FREE, 0.0
    for side in range(int(plan.law[SIDES])):
        enter(plan.free, plan.drive, pose, status[CLOCK])
        value, _, size = show(plan.free, plan.drive, GAP + side, 1.0, status[CLOCK])
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
        elif approach(plan, pose, side) > 0.0:
            status[ORDER] = HIT
        else:
            arrive(plan, pose, status, side)
    return COMPLETE


@kernel
def arrive(plan: Plan, pose: Array, status: Array, side: int) -> tuple[float, int]:
    """On the stop, at whatever velocity: what follows. Velocity before, what it was."""
    speed = approach(plan, pose, side)
    status[SIDE], status[KIND], status[ORDER] = side, FREE, 0.0
    if speed < 0.0:
        status[ORDER], status[RISE] = 1.0, -speed
        return 0.0, PASS
    status[SPEED] = max(status[SPEED], speed)
    if plan.law[FAMILY] == IMPULSIVE:
        return meet(plan, pose, status, side, speed)
    if speed == 0.0:
        order, rise = lifting(plan, pose, status, side)
        if order > 0:
            status[ORDER], status[RISE] = order, rise
            return 0.0, PASS
    status[KIND], status[ORDER], status[STEPPED] = CONTACT, 1.0, 0.0
    return speed, IMPACT


@kernel
def lifting(plan: Plan, pose: Array, status: Array, side: int) -> tuple[int, float]:
    """Order and size of the derivative by which the gap opens from the stop without velocity; −1 where it does not."""
    enter(plan.free, plan.drive, pose, status[CLOCK])
    show(plan.free, plan.drive, GAP + side, 1.0, status[CLOCK])
    return curve_of(plan.free)


@kernel
def meet(plan: Plan, pose: Array, status: Array, side: int, before: float) -> tuple[float, int]:
    """The impact by R(v): then flight, chatter's end or rest. Velocity before, what it was."""
    after = restitution(plan.law, plan.curve, before) * before
    push(plan, pose, side, -(before + after) / plan.law[MOBILITY])
    if after <= 0.0:
        settle_on_stop(plan, pose, side)
        order, rise = lifting(plan, pose, status, side)
        status[KIND] = FREE if order > 0 else RESTING
        status[ORDER], status[RISE] = max(order, 0), rise
        return before, IMPACT if order > 0 else STUCK
    lifting(plan, pose, status, side)
    left, remainder = chatter_left(plan, status, side, -plan.free.signal[WHOLE + 2], after, status[CLOCK])
    if left < 0.0:
        status[ORDER], status[RISE] = 1.0, after
        return before, IMPACT
    settle_on_stop(plan, pose, side)
    status[KIND], status[ORDER] = RESTING, 0.0
    status[LEFT_OVER], status[LEFT_ERROR] = left, remainder
    return before, CHATTER


@kernel
def release(plan: Plan, pose: Array, status: Array, side: int, at_root: bool) -> None:
    """Leave the stop where the motion is drawn away from it: with acceleration, or with jerk at the force's root."""
    lifting(plan, pose, status, side)
    second, third = plan.free.signal[WHOLE + 2], plan.free.signal[WHOLE + 3]
    if third > 0.0 and (at_root or second <= 0.0):
        status[KIND], status[ORDER], status[RISE] = FREE, 3.0, third
    elif second > 0.0:
        status[KIND], status[ORDER], status[RISE] = FREE, 2.0, second


@kernel
def leave(plan: Plan, pose: Array, status: Array, side: int) -> None:
    """Out of the stop's range."""
    speed = approach(plan, pose, side)
    status[KIND], status[ORDER], status[RISE], status[STEPPED] = FREE, 1.0, -speed, 0.0
    if speed >= 0.0:
        order, rise = lifting(plan, pose, status, side)
        status[ORDER], status[RISE] = max(order, 0), rise
