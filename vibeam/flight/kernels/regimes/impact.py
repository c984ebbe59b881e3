"""The impact in regimes: velocities jump through one impulse by R(v); an endless series is completed by its limit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.block_flow import set_signal, to_block_coordinates
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.impact import ENDLESS, Accumulation, is_faint, put_contact_at, stop_contact, time_left
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.kernels.regimes.contact_motion import pull
from vibeam.flight.kernels.regimes.laws import accumulation, is_endless, restitution
from vibeam.flight.kernels.regimes.layout import RegimeEngine
from vibeam.flight.kernels.rest import lift_or_rest
from vibeam.flight.kernels.roots.signal import signal_of

Array = NDArray[np.float64]


@kernel
def apply_impact(engine: RegimeEngine, pose: Array, status: Array, side: int, before: float) -> tuple[float, int]:
    """The impact by R(v): then flight, chatter's end or rest. Velocity before, what it was."""
    after = restitution(engine.law, engine.curve, before) * before
    impulse = -(before + after) / engine.law[regime_layout.MOBILITY]
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
    status[regime_layout.LEFT_OVER], status[regime_layout.LEFT_ERROR] = left, remainder
    return before, layout.CHATTER


@kernel
def put_on_stop(engine: RegimeEngine, pose: Array, side: int) -> None:
    """Move the contact exactly onto the stop of that side, with the least energy."""
    put_contact_at(engine.contact[side], engine.yields[side], engine.gaps[side], pose)


@kernel
def settle_on_stop(engine: RegimeEngine, pose: Array, side: int) -> None:
    """Take contact velocity out by the least impulse, and penetration by round-off with the least energy."""
    put_on_stop(engine, pose, side)
    stop_contact(engine.contact[side], engine.law[regime_layout.MOBILITY], pose)


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
