"""The impact in regimes: velocities jump through one impulse by R(v); an endless series is completed by its limit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.block_flow import set_signal, to_block_coordinates
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.impact import ENDLESS, Accumulation, is_faint, put_contact_at, stop_contact, time_left
from vibeam.flight.kernels.layout import (
    CHATTER,
    CLOCK,
    GAP_SIGNAL,
    IMPACT,
    KAPPA,
    KIND,
    ORDER,
    RESTING,
    RISE,
    SPEED,
    W,
)
from vibeam.flight.kernels.regimes.contact_motion import pull
from vibeam.flight.kernels.regimes.laws import accumulation, is_endless, restitution
from vibeam.flight.kernels.regimes.layout import LEFT_ERROR, LEFT_OVER, MOBILITY, RegimeEngine
from vibeam.flight.kernels.rest import lift_or_rest
from vibeam.flight.kernels.roots.signal import signal_of

Array = NDArray[np.float64]


@kernel
def apply_impact(plan: RegimeEngine, pose: Array, status: Array, side: int, before: float) -> tuple[float, int]:
    """The impact by R(v): then flight, chatter's end or rest. Velocity before, what it was."""
    after = restitution(plan.law, plan.curve, before) * before
    impulse = -(before + after) / plan.law[MOBILITY]
    for k in range(pose.shape[1]):
        pose[1, k] += plan.contact[side, k] * impulse
    if after <= 0.0:
        settle_on_stop(plan, pose, side)
        toward, jerk = pull(plan, pose, side, status[CLOCK])
        return before, lift_or_rest(status, toward, jerk)
    put_on_stop(plan, pose, side)
    left, remainder = chatter_left(plan, pose, status, side, after)
    if left < 0.0:
        status[ORDER], status[RISE] = 1.0, after
        return before, IMPACT
    settle_on_stop(plan, pose, side)
    status[KIND], status[ORDER] = RESTING, 0.0
    status[LEFT_OVER], status[LEFT_ERROR] = left, remainder
    return before, CHATTER


@kernel
def put_on_stop(plan: RegimeEngine, pose: Array, side: int) -> None:
    """Move the contact exactly onto the stop of that side, with the least energy."""
    put_contact_at(plan.contact[side], plan.yields[side], plan.gaps[side], pose)


@kernel
def settle_on_stop(plan: RegimeEngine, pose: Array, side: int) -> None:
    """Take contact velocity out by the least impulse, and penetration by round-off with the least energy."""
    put_on_stop(plan, pose, side)
    stop_contact(plan.contact[side], plan.law[MOBILITY], pose)


@kernel
def chatter_left(plan: RegimeEngine, pose: Array, status: Array, side: int, after: float) -> tuple[float, float]:
    """``time_left`` after an impact on the stop of that side, (−1, 0) where it is too early to complete a chatter."""
    free, contact, gap = plan.free, plan.contact[side], plan.gaps[side]
    toward, _ = pull(plan, pose, side, status[CLOCK])
    coefficient = restitution(plan.law, plan.curve, after)
    loss, share = accumulation(plan.law, plan.curve, coefficient, after)
    rest = Accumulation(after, status[SPEED], toward, coefficient, loss)
    endless = is_endless(plan.law, coefficient)
    if not is_faint(after, rest.top, toward, 1.0 if endless else loss, abs(gap)):
        return -1.0, 0.0
    if endless:
        return 0.0, ENDLESS
    to_block_coordinates(free, plan.drive, pose, status[CLOCK])
    set_signal(free, plan.drive, GAP_SIGNAL + side, 1.0, status[CLOCK])
    slowest = max(plan.drive[W], free.pairs[KAPPA, 0])
    return time_left(signal_of(free), contact, gap, pose, rest, slowest, share)
