"""The impact: velocities jump through one impulse; an endless series of impacts is completed by its geometric limit."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.layout import ELASTIC, FAITHFUL, FLOOR, LATE, NEAR, NEAR_MODES, Engine
from vibeam.flight.kernels.modal_flow import ROUND_OFF as CANCELLED
from vibeam.flight.kernels.modal_flow import begin_flight, contact_derivatives
from vibeam.flight.kernels.roots import taylor_pairs as att
from vibeam.flight.kernels.roots.pair import norm
from vibeam.flight.kernels.roots.signal import EventSignal, magnitude, signal_of, to_node
from vibeam_models.arrays import Array

ROUND_OFF = 4.0 * 2.220446049250313e-16
ENDLESS = np.inf  # bound of the error of an accumulation's end where it has none


@joined
def difference_without_round_off(a: float, b: float) -> float:
    """a − b, and 0 where that is no more than their round-off: so that one mode put onto the stop lies still there."""
    difference = a - b
    return difference if abs(difference) > ROUND_OFF * abs(b) else 0.0


@joined
def put_contact_at(contact: Array, yields: Array, gap: float, pose: Array) -> None:
    """Move the contact exactly to ``gap``, from where it is to round-off, with the least energy."""
    beyond = -gap
    for k in range(contact.shape[0]):
        beyond += contact[k] * pose[0, k]
    for k in range(contact.shape[0]):
        pose[0, k] = difference_without_round_off(pose[0, k], yields[k] * beyond)


@joined
def stop_contact(contact: Array, mobility: float, pose: Array) -> None:
    """Take the contact velocity out by the least impulse."""
    slope = 0.0
    for k in range(contact.shape[0]):
        slope += contact[k] * pose[1, k]
    for k in range(contact.shape[0]):
        pose[1, k] = difference_without_round_off(pose[1, k], contact[k] * slope / mobility)


@joined
def contact_velocity(contact: Array, pose: Array) -> float:
    """c·η', positive toward the stop; 0 where it is but the round-off of what it is the sum of.

    Of the signal's slope, in which forced and free parts cancel, round-off would make impacts that are none.
    """
    velocity, size = 0.0, 0.0
    for k in range(contact.shape[0]):
        part = contact[k] * pose[1, k]
        velocity += part
        size += abs(part)
    return velocity if abs(velocity) > CANCELLED * size else 0.0


@joined
def put_on_stop(modes: Array, drive: Array, pose: Array) -> None:
    """Move the contact exactly onto the stop, from where it is to round-off, with the least energy."""
    put_contact_at(modes[layout.CONTACT], modes[layout.YIELD], drive[layout.GAP], pose)


@joined
def settle_on_stop(modes: Array, drive: Array, pose: Array) -> None:
    """Take contact velocity out by the least impulse, and penetration by round-off with the least energy."""
    put_on_stop(modes, drive, pose)
    stop_contact(modes[layout.CONTACT], drive[layout.MOBILITY], pose)


@joined
def strike(modes: Array, drive: Array, pose: Array) -> float:
    """η'⁺ = η'⁻ + c p with p = −(1+R) v⁻/S; returns v⁻, the contact velocity before (0 where round-off made it < 0).

    The contact is put exactly on the stop, so that round-off does not pile up from impact to impact.
    """
    before = 0.0
    for k in range(modes.shape[1]):
        before += modes[layout.CONTACT, k] * pose[1, k]
    impulse = -(1.0 + drive[layout.RESTITUTION]) * max(before, 0.0) / drive[layout.MOBILITY]
    for k in range(modes.shape[1]):
        pose[1, k] += modes[layout.CONTACT, k] * impulse
    put_on_stop(modes, drive, pose)
    return max(before, 0.0)


@joined
def is_faint(after: float, top: float, toward: float, loss: float, gap: float) -> bool:
    """True where what is left after an impact is next to nothing, so that its accumulation may be completed.

    ``top``: the largest impact velocity; ``toward``: the contact acceleration; ``loss``: see ``narrowing``.
    """
    return toward > 0.0 and loss > 0.0 and 2.0 * after * (after / top) <= NEAR * loss * (top + gap * (toward / top))


@joined
def narrowing(loss: float) -> float:
    """1 − R, as the flights to come take 1/(1 − R) as long as the next; 1 where they never end, which asks for that."""
    return loss if loss >= ELASTIC else 1.0


class Accumulation(NamedTuple):
    """An endless series of impacts from one of them on."""

    after: float  # the velocity after it
    top: float  # the largest impact velocity so far
    toward: float  # contact acceleration toward the stop
    restitution: float
    loss: float  # what its time is divided by: 1 − R for a constant R


@joined
def chatter_left(engine: Engine, pose: Array, status: Array, after: float) -> tuple[float, float]:
    """``time_left`` after an impact of a plain system, (−1, 0) where it is too early to complete a chatter.

    (0, ∞) where R is next to 1, the accumulation endless and what is left of it faint: see the page.
    """
    drive = engine.drive
    toward, _ = contact_derivatives(engine.pairs, engine.modes, drive, pose, status)
    rest = Accumulation(after, status[layout.SPEED], toward, drive[layout.RESTITUTION], 1.0 - drive[layout.RESTITUTION])
    if not is_faint(after, rest.top, toward, narrowing(rest.loss), abs(drive[layout.GAP])):
        return -1.0, 0.0
    if rest.loss < ELASTIC:
        return 0.0, ENDLESS
    begin_flight(engine, pose, status[layout.PHASE_COS], status[layout.PHASE_SIN])
    slowest = max(drive[layout.W], engine.pairs[layout.KAPPA, 0])
    return time_left(signal_of(engine), engine.modes[layout.CONTACT], drive[layout.GAP], pose, rest, slowest, 0.0)


@kernel
def time_left(
    g: EventSignal, contact: Array, gap: float, pose: Array, rest: Accumulation, slowest: float, share: float
) -> tuple[float, float]:
    """Time that the rest of an accumulation of impacts takes, and a bound of its error; (−1, 0) where it is too early.

    With contact acceleration a toward the stop the flights last 2v/a, 2Rv/a, …: together T = 2v / (a (1 − R)). Its
    relative error is at most M₃T/a, M₃ bounding the jerk of the gap g, and ``share`` where R is not constant; and the
    impulses that rest leaves out move the other modes by v T at most (Nordmark & Piiroinen 2009, to first order).
    """
    after, top, toward, restitution, loss = rest
    left, length = 2.0 * after / (toward * loss), top * (top / toward)
    jerk, size = jerk_bound(g), size_of_gap(g, contact, gap, pose)
    remainder = left * (jerk * left / toward)
    if left * slowest > 1.0 and all_turn(g.pairs):  # as long as a swing: nothing but damping draws the contact back
        return -1.0, 0.0
    if remainder > FAITHFUL * restitution * 2.0 * (top / toward) / loss and after * left >= FLOOR * length:
        return -1.0, 0.0
    remainder += share * left
    if not is_over(after, left, remainder, jerk * left / toward, length, size, pose.shape[1], slowest):
        return -1.0, 0.0
    return left, remainder


@joined
def all_turn(pairs: Array) -> bool:
    """True where no pair creeps."""
    turn = True
    for k in range(pairs.shape[1]):
        turn = turn and pairs[layout.DISC, k] < 0.0
    return turn


@kernel
def jerk_bound(g: EventSignal) -> float:
    """Bound of the third derivative of a gap just begun, for all later times."""
    g.terms[layout.HARMONIC] = norm(g.terms[layout.ZR], g.terms[layout.ZI])
    to_node(g.pairs)
    return float(magnitude(g.pairs, g.terms, 3) + att.jerk_bound(g.attached, g.terms))


@kernel
def size_of_gap(g: EventSignal, contact: Array, gap: float, pose: Array) -> float:
    """Sum of the sizes of the parts of a gap just begun."""
    pairs, _, _, signal, attached = g
    size = abs(gap) + abs(signal[layout.CONST]) + norm(signal[layout.ZR], signal[layout.ZI])
    for k in range(contact.shape[0]):
        size += abs(contact[k] * pose[0, k])
    for k in range(pairs.shape[1]):
        size += abs(pairs[layout.X0, k])
    for j in range(int(signal[layout.ATTACHED])):
        size += abs(attached[layout.AWEIGHT, j] * attached[layout.AX, j])
    return float(size)


@kernel
def is_over(
    after: float, left: float, remainder: float, change: float, length: float, size: float, modes: int, slowest: float
) -> bool:
    """True where an accumulation whose rest takes ``left`` s, to ``remainder``, may be completed by its limit.

    ``change``: the share by which the contact acceleration may change meanwhile; ``length``: about how far the first
    flight went; ``slowest``: the slowest rate.
    """
    if after * left < FLOOR * length:
        return True
    near = NEAR if modes == 1 else NEAR_MODES
    return after * left <= near * max(length, size) and change <= 0.1 and remainder * slowest <= LATE
