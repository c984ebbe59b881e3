"""Contact in regimes: what follows at the stop, and where one that yields is left or just touched."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.block_flow import set_signal, to_block_coordinates
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.impact import contact_velocity
from vibeam.flight.kernels.layout import (
    CLOCK,
    COMPLETE,
    FREE,
    GAP_SIGNAL,
    IMPACT,
    KIND,
    NOT_FINITE,
    ORDER,
    PENETRATED,
    RESTING,
    RISE,
    SPEED,
)
from vibeam.flight.kernels.modal_flow import ROUND_OFF
from vibeam.flight.kernels.regimes.contact_motion import approach, drift, pull
from vibeam.flight.kernels.regimes.impact import apply_impact, settle_on_stop
from vibeam.flight.kernels.regimes.layout import (
    CONTACT,
    FAMILY,
    HIT,
    IMPULSIVE,
    PASS,
    SIDE,
    SIDES,
    STEPPED,
    TOUCHING,
    RegimeEngine,
)
from vibeam.flight.kernels.rest import opening_order

Array = NDArray[np.float64]


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
    toward, jerk = pull(plan, pose, side, status[CLOCK])
    order, rise = opening_order(toward, jerk)
    status[KIND], status[ORDER], status[RISE], status[STEPPED] = FREE, order, rise, 0.0
    if order == 0:
        settle_on_stop(plan, pose, side)
        status[ORDER] = TOUCHING
    elif order < 0:
        status[KIND], status[ORDER] = CONTACT, 1.0


@kernel
def leave_stop(plan: RegimeEngine, pose: Array, status: Array, side: int) -> None:
    """Out of the range of a stop that yields."""
    speed = approach(plan, pose, side)
    status[KIND], status[ORDER], status[RISE], status[STEPPED] = FREE, 1.0, -speed, 0.0
    if -speed <= drift(plan, pose, side):
        touch(plan, pose, status, side)
