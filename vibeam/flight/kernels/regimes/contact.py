"""Contact in regimes: the impact by R(v), an endless series completed by its limit, or a stop that yields.

Velocities jump through one impulse; a stop that yields is entered, left or just touched.
"""

from __future__ import annotations

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.block_flow import set_signal, to_block_coordinates
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.impact import (
    ENDLESS,
    Accumulation,
    contact_velocity,
    is_faint,
    put_contact_at,
    stop_contact,
    time_left,
)
from vibeam.flight.kernels.modal_flow import ROUND_OFF, lift_or_rest, opening_order
from vibeam.flight.kernels.regimes import layout as row
from vibeam.flight.kernels.regimes.contact_motion import approach, drift, pull
from vibeam.flight.kernels.regimes.laws import accumulation, is_endless, restitution
from vibeam.flight.kernels.regimes.layout import RegimeEngine
from vibeam.flight.kernels.roots.signal import signal_of
from vibeam_models.arrays import Array


@kernel
def apply_impact(engine: RegimeEngine, pose: Array, status: Array, side: int, before: float) -> tuple[float, int]:
    """The impact by R(v): then flight, chatter's end or rest. Velocity before, what it was."""
    after = restitution(engine.law, engine.curve, before) * before
    impulse = -(before + after) / engine.law[row.MOBILITY]
    for k in range(pose.shape[1]):
        pose[1, k] += engine.contact[side, k] * impulse
    if after <= 0.0:
        settle_on_stop(engine, pose, side)
        toward, jerk = pull(engine, pose, side, status[layout.CLOCK])
        return before, lift_or_rest(status, toward, jerk)
    put_on_stop(engine, pose, side)
    left, remainder = chatter_left(engine, pose, status, side, after)
    if left < 0.0:
        status[layout.ORDER], status[layout.RISE] = 1.0, after
        return before, layout.IMPACT
    settle_on_stop(engine, pose, side)
    status[layout.KIND], status[layout.ORDER] = layout.RESTING, 0.0
    status[row.LEFT_OVER], status[row.LEFT_ERROR] = left, remainder
    return before, layout.CHATTER


@kernel
def put_on_stop(engine: RegimeEngine, pose: Array, side: int) -> None:
    """Move the contact exactly onto the stop of that side, with the least energy."""
    put_contact_at(engine.contact[side], engine.yields[side], engine.gaps[side], pose)


@kernel
def settle_on_stop(engine: RegimeEngine, pose: Array, side: int) -> None:
    """Take contact velocity out by the least impulse, and penetration by round-off with the least energy."""
    put_on_stop(engine, pose, side)
    stop_contact(engine.contact[side], engine.law[row.MOBILITY], pose)


@kernel
def chatter_left(engine: RegimeEngine, pose: Array, status: Array, side: int, after: float) -> tuple[float, float]:
    """``time_left`` after an impact on the stop of that side, (−1, 0) where it is too early to complete a chatter."""
    free, contact, gap = engine.free, engine.contact[side], engine.gaps[side]
    toward, _ = pull(engine, pose, side, status[layout.CLOCK])
    coefficient = restitution(engine.law, engine.curve, after)
    loss, share = accumulation(engine.law, engine.curve, coefficient, after)
    rest = Accumulation(after, status[layout.SPEED], toward, coefficient, loss)
    endless = is_endless(engine.law, coefficient)
    if not is_faint(after, rest.top, toward, 1.0 if endless else loss, abs(gap)):
        return -1.0, 0.0
    if endless:
        return 0.0, ENDLESS
    to_block_coordinates(free, engine.drive, pose, status[layout.CLOCK])
    set_signal(free, engine.drive, layout.GAP_SIGNAL + side, 1.0, status[layout.CLOCK])
    slowest = max(engine.drive[layout.W], free.pairs[layout.KAPPA, 0])
    return time_left(signal_of(free), contact, gap, pose, rest, slowest, share)


@kernel
def classify(engine: RegimeEngine, pose: Array, status: Array) -> int:
    """Set the regime that the motion is in, from its state alone: COMPLETE, or why it cannot be."""
    kind, status[layout.ORDER] = status[layout.KIND], 0.0
    if kind == layout.RESTING and engine.law[row.FAMILY] == row.IMPULSIVE:
        return layout.COMPLETE
    status[layout.KIND], status[row.STEPPED] = layout.FREE, 0.0
    for side in range(int(engine.law[row.SIDES])):
        to_block_coordinates(engine.free, engine.drive, pose, status[layout.CLOCK])
        value, _, size = set_signal(engine.free, engine.drive, layout.GAP_SIGNAL + side, 1.0, status[layout.CLOCK])
        if not np.isfinite(size):
            return layout.NOT_FINITE
        if value > ROUND_OFF * size:
            continue
        deep = value < -1e4 * ROUND_OFF * size
        if deep and engine.law[row.FAMILY] == row.IMPULSIVE:
            return layout.PENETRATED
        status[row.SIDE] = side
        if deep:
            status[layout.KIND] = row.CONTACT
        else:
            speed = contact_velocity(engine.contact[side], pose)
            if speed > 0.0:
                status[layout.ORDER] = row.HIT
            else:
                on_contact(engine, pose, status, side, speed)
    return layout.COMPLETE


@kernel
def on_contact(engine: RegimeEngine, pose: Array, status: Array, side: int, speed: float) -> tuple[float, int]:
    """On the stop, at a contact velocity of ``speed`` towards it: what follows. Velocity before, what it was."""
    status[row.SIDE], status[layout.KIND], status[layout.ORDER] = side, layout.FREE, 0.0
    if speed < 0.0:
        status[layout.ORDER], status[layout.RISE] = 1.0, -speed
        return 0.0, row.PASS
    status[layout.SPEED] = max(status[layout.SPEED], speed)
    if engine.law[row.FAMILY] == row.IMPULSIVE:
        return apply_impact(engine, pose, status, side, speed)
    if speed <= drift(engine, pose, side):
        touch(engine, pose, status, side)
        return speed, layout.IMPACT if status[layout.KIND] == row.CONTACT else row.PASS
    status[layout.KIND], status[layout.ORDER], status[row.STEPPED] = row.CONTACT, 1.0, 0.0
    return speed, layout.IMPACT


@kernel
def touch(engine: RegimeEngine, pose: Array, status: Array, side: int) -> None:
    """On a stop that yields, without velocity: into it, away from it, or neither: then it stands there, touching it."""
    toward, jerk = pull(engine, pose, side, status[layout.CLOCK])
    order, rise = opening_order(toward, jerk)
    status[layout.KIND], status[layout.ORDER], status[layout.RISE] = layout.FREE, order, rise
    status[row.STEPPED] = 0.0
    if order == 0:
        settle_on_stop(engine, pose, side)
        status[layout.ORDER] = row.TOUCHING
    elif order < 0:
        status[layout.KIND], status[layout.ORDER] = row.CONTACT, 1.0


@kernel
def leave_stop(engine: RegimeEngine, pose: Array, status: Array, side: int) -> None:
    """Out of the range of a stop that yields."""
    speed = approach(engine, pose, side)
    status[layout.KIND], status[layout.ORDER], status[layout.RISE] = layout.FREE, 1.0, -speed
    status[row.STEPPED] = 0.0
    if -speed <= drift(engine, pose, side):
        touch(engine, pose, status, side)
