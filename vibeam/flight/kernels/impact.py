"""The impact: velocities jump through one impulse; an endless series of impacts is completed by its geometric limit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import joined
from vibeam.flight.kernels.layout import (
    AWEIGHT,
    AX,
    CONTACT,
    GAP,
    HARMONIC,
    KAPPA,
    MOBILITY,
    PHASE_COS,
    PHASE_SIN,
    RESTITUTION,
    SPEED,
    YIELD,
    ZI,
    ZR,
    Engine,
    W,
)
from vibeam.flight.kernels.modal_flow import begin_flight, contact_derivatives
from vibeam.flight.kernels.roots import taylor_pairs as att
from vibeam.flight.kernels.roots.pair import norm
from vibeam.flight.kernels.roots.signal import magnitude, to_node

Array = NDArray[np.float64]

ROUND_OFF = 4.0 * 2.220446049250313e-16


@joined
def difference_without_round_off(a: float, b: float) -> float:
    """a − b, and 0 where that is no more than their round-off: so that one mode put onto the stop lies still there."""
    difference = a - b
    return difference if abs(difference) > ROUND_OFF * abs(b) else 0.0


@joined
def put_on_stop(modes: Array, drive: Array, pose: Array) -> None:
    """Move the contact exactly onto the stop, from where it is to round-off, with the least energy."""
    beyond = -drive[GAP]
    for k in range(modes.shape[1]):
        beyond += modes[CONTACT, k] * pose[0, k]
    for k in range(modes.shape[1]):
        pose[0, k] = difference_without_round_off(pose[0, k], modes[YIELD, k] * beyond)


@joined
def settle_on_stop(modes: Array, drive: Array, pose: Array) -> None:
    """Take contact velocity out by the least impulse, and penetration by round-off with the least energy."""
    put_on_stop(modes, drive, pose)
    slope = 0.0
    for k in range(modes.shape[1]):
        slope += modes[CONTACT, k] * pose[1, k]
    for k in range(modes.shape[1]):
        pose[1, k] = difference_without_round_off(pose[1, k], modes[CONTACT, k] * slope / drive[MOBILITY])


NEAR = 1e-11  # share of the length scale that what is left of a chatter may span before its completion is considered

NEAR_MODES = 4e-15  # the same where other modes feel the impulses left out

FAITHFUL = 1e-11  # share of the whole accumulation by which its end may be misjudged

LATE = 1e-12  # share of the slowest time scale by which the end of the accumulation may be misjudged

FLOOR = 1e-26  # share of the length scale below which a flight is no longer one


@joined
def strike(modes: Array, drive: Array, pose: Array) -> float:
    """η'⁺ = η'⁻ + c p with p = −(1+R) v⁻/S; returns v⁻, the contact velocity before (0 where round-off made it < 0).

    The contact is put exactly on the stop, so that round-off does not pile up from impact to impact.
    """
    before = 0.0
    for k in range(modes.shape[1]):
        before += modes[CONTACT, k] * pose[1, k]
    impulse = -(1.0 + drive[RESTITUTION]) * max(before, 0.0) / drive[MOBILITY]
    for k in range(modes.shape[1]):
        pose[1, k] += modes[CONTACT, k] * impulse
    put_on_stop(modes, drive, pose)
    return max(before, 0.0)


@joined
def is_faint(after: float, top: float, toward: float, loss: float, gap: float) -> bool:
    """Whether what is left after an impact is next to nothing, so that its accumulation may be completed.

    ``top``: the largest impact velocity; ``toward``: the contact acceleration; ``loss``: 1 − R.
    """
    return toward > 0.0 and loss > 0.0 and 2.0 * after * (after / top) <= NEAR * loss * (top + gap * (toward / top))


@joined
def chatter_left(desk: Engine, pose: Array, status: Array, after: float) -> tuple[float, float]:
    """Time that the rest of an accumulation of impacts takes, and a bound of its error; (−1, 0) where it is too early.

    With contact acceleration a toward the stop the flights last 2v/a, 2Rv/a, …: together T = 2v / (a (1 − R)). Its
    relative error is at most M₃T/a, M₃ bounding the jerk; and the impulses that rest leaves out move the other modes
    by v T at most (Nordmark & Piiroinen 2009, to first order).
    """
    drive = desk.drive
    toward, _ = contact_derivatives(desk.pairs, desk.modes, drive, pose, status)
    loss = 1.0 - drive[RESTITUTION]
    if not is_faint(after, status[SPEED], toward, loss, abs(drive[GAP])):
        return -1.0, 0.0
    fall = status[SPEED] / toward
    left, length = 2.0 * after / (toward * loss), status[SPEED] * fall
    _, _, size = begin_flight(desk, pose, status[PHASE_COS], status[PHASE_SIN])
    desk.signal[HARMONIC] = norm(desk.signal[ZR], desk.signal[ZI])
    to_node(desk.pairs)
    for j in range(desk.attached.shape[1]):
        size += abs(desk.attached[AWEIGHT, j] * desk.attached[AX, j])
    jerk = magnitude(desk.pairs, desk.signal, 3) + att.jerk_bound(desk.attached, desk.signal)
    remainder = left * (jerk * left / toward)
    if after * left < FLOOR * length:
        return left, remainder
    near = NEAR if pose.shape[1] == 1 else NEAR_MODES
    slowest = max(drive[W], desk.pairs[KAPPA, 0])
    if remainder > FAITHFUL * drive[RESTITUTION] * 2.0 * fall / loss:
        return -1.0, 0.0
    if after * left > near * max(length, size) or jerk * left > 0.1 * toward or remainder * slowest > LATE:
        return -1.0, 0.0
    return left, remainder
