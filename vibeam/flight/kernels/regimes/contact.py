"""Contact in regimes: what follows at the stop, and where one that yields is left or just touched."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.block_flow import set_signal, to_block_coordinates
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.impact import contact_velocity
from vibeam.flight.kernels.modal_flow import ROUND_OFF
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.kernels.regimes.contact_motion import approach, drift, pull
from vibeam.flight.kernels.regimes.impact import apply_impact, settle_on_stop
from vibeam.flight.kernels.regimes.layout import RegimeEngine
from vibeam.flight.kernels.rest import opening_order

Array = NDArray[np.float64]


@kernel
def classify(engine: RegimeEngine, pose: Array, status: Array) -> int:
    """What the motion is in, from its state alone: COMPLETE, or why it cannot be."""
    kind, status[layout.ORDER] = status[layout.KIND], 0.0
    if kind == layout.RESTING and engine.law[regime_layout.FAMILY] == regime_layout.IMPULSIVE:
        return layout.COMPLETE
    status[layout.KIND], status[regime_layout.STEPPED] = layout.FREE, 0.0
    for side in range(int(engine.law[regime_layout.SIDES])):
        to_block_coordinates(engine.free, engine.drive, pose, status[layout.CLOCK])
        value, _, size = set_signal(engine.free, engine.drive, layout.GAP_SIGNAL + side, 1.0, status[layout.CLOCK])
        if not np.isfinite(size):
            return layout.NOT_FINITE
        if value > ROUND_OFF * size:
            continue
        deep = value < -1e4 * ROUND_OFF * size
        if deep and engine.law[regime_layout.FAMILY] == regime_layout.IMPULSIVE:
            return layout.PENETRATED
        status[regime_layout.SIDE] = side
        if deep:
            status[layout.KIND] = regime_layout.CONTACT
        else:
            speed = contact_velocity(engine.contact[side], pose)
            if speed > 0.0:
                status[layout.ORDER] = regime_layout.HIT
            else:
                on_contact(engine, pose, status, side, speed)
    return layout.COMPLETE


@kernel
def on_contact(engine: RegimeEngine, pose: Array, status: Array, side: int, speed: float) -> tuple[float, int]:
    """On the stop, at a contact velocity of ``speed`` towards it: what follows. Velocity before, what it was."""
    status[regime_layout.SIDE], status[layout.KIND], status[layout.ORDER] = side, layout.FREE, 0.0
    if speed < 0.0:
        status[layout.ORDER], status[layout.RISE] = 1.0, -speed
        return 0.0, regime_layout.PASS
    status[layout.SPEED] = max(status[layout.SPEED], speed)
    if engine.law[regime_layout.FAMILY] == regime_layout.IMPULSIVE:
        return apply_impact(engine, pose, status, side, speed)
    if speed <= drift(engine, pose, side):
        touch(engine, pose, status, side)
        return speed, layout.IMPACT if status[layout.KIND] == regime_layout.CONTACT else regime_layout.PASS
    status[layout.KIND], status[layout.ORDER], status[regime_layout.STEPPED] = regime_layout.CONTACT, 1.0, 0.0
    return speed, layout.IMPACT


@kernel
def touch(engine: RegimeEngine, pose: Array, status: Array, side: int) -> None:
    """On a stop that yields, without velocity: into it, away from it, or neither: then it stands there, touching it."""
    toward, jerk = pull(engine, pose, side, status[layout.CLOCK])
    order, rise = opening_order(toward, jerk)
    status[layout.KIND], status[layout.ORDER], status[layout.RISE], status[regime_layout.STEPPED] = (
        layout.FREE,
        order,
        rise,
        0.0,
    )
    if order == 0:
        settle_on_stop(engine, pose, side)
        status[layout.ORDER] = regime_layout.TOUCHING
    elif order < 0:
        status[layout.KIND], status[layout.ORDER] = regime_layout.CONTACT, 1.0


@kernel
def leave_stop(engine: RegimeEngine, pose: Array, status: Array, side: int) -> None:
    """Out of the range of a stop that yields."""
    speed = approach(engine, pose, side)
    status[layout.KIND], status[layout.ORDER], status[layout.RISE], status[regime_layout.STEPPED] = (
        layout.FREE,
        1.0,
        -speed,
        0.0,
    )
    if -speed <= drift(engine, pose, side):
        touch(engine, pose, status, side)
