"""Disturbances over flights and impacts: closed-form flow, saltation matrix; see ``flight.tangent``."""

from __future__ import annotations

from math import sin, sqrt

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.roots.pair import propagator
from vibeam_models.arrays import Array


@joined
def is_lost(trace: Array, i: int, restitution: float) -> bool:
    """Whether directions are lost in a segment or at its end: at rest, at the end of a chatter, by R = 0."""
    end = trace[i, layout.END]
    stuck = end in (layout.CHATTER, layout.STUCK) or (end == layout.IMPACT and restitution == 0.0)
    return bool(trace[i, layout.WHAT] == layout.RESTING or stuck)


@kernel
def carry_over_flight(pairs: Array, time: float, columns: Array) -> None:
    """Disturbances (c, 2, n) over free flight: each mode's propagator."""
    for k in range(pairs.shape[1]):
        p00, p01, p10, p11 = propagator(pairs[layout.SIGMA, k], pairs[layout.OMEGA, k], pairs[layout.DISC, k], time)
        for j in range(columns.shape[0]):
            x, y = columns[j, 0, k], columns[j, 1, k]
            columns[j, 0, k], columns[j, 1, k] = p00 * x + p01 * y, p10 * x + p11 * y


@kernel
def acceleration_before(
    pairs: Array, modes: Array, drive: Array, after: Array, before: float, clock: float
) -> float:  # fmt: skip
    """The contact's acceleration towards the stop just before an impact, from the pose after it.

    ``before``: contact velocity; η'⁻ = η'⁺ + c (v⁻ − c·η'⁺)/S.
    """
    slope = 0.0
    for k in range(modes.shape[1]):
        slope += modes[layout.CONTACT, k] * after[1, k]
    impulse, push, found = (
        (before - slope) / drive[layout.MOBILITY],
        drive[layout.STRENGTH] * sin(drive[layout.W] * clock),
        0.0,
    )
    for k in range(modes.shape[1]):
        c, own = modes[layout.CONTACT, k], pairs[layout.OMEGA, k]
        velocity = after[1, k] + c * impulse
        force = modes[layout.LOAD, k] * push + modes[layout.STATIC, k]
        found += c * (force - 2.0 * pairs[layout.SIGMA, k] * velocity - own * own * after[0, k])
    return found


@kernel
def carry_over_impact(pairs: Array, modes: Array, drive: Array, lean: float, columns: Array) -> None:
    """Disturbances (c, 2, n) over an impact; ``lean``: the contact's acceleration over its velocity before it."""
    share = (1.0 + drive[layout.RESTITUTION]) / drive[layout.MOBILITY]
    for j in range(columns.shape[0]):
        moved, swung = 0.0, 0.0
        for k in range(modes.shape[1]):
            moved += modes[layout.CONTACT, k] * columns[j, 0, k]
            swung += modes[layout.CONTACT, k] * columns[j, 1, k]
        for k in range(modes.shape[1]):
            c = share * modes[layout.CONTACT, k]
            columns[j, 0, k] -= c * moved
            columns[j, 1, k] += c * ((2.0 * pairs[layout.SIGMA, k] + lean) * moved - swung)


@kernel
def carry_along(
    pairs: Array, modes: Array, drive: Array, trace: Array, poses: Array, last: Array, count: int, columns: Array
) -> bool:
    """Disturbances over the segments traced, ``last`` the pose after them; whether a direction is lost on the way."""
    for i in range(count):
        if is_lost(trace, i, drive[layout.RESTITUTION]):
            return True
        carry_over_flight(pairs, trace[i, layout.DURATION], columns)
        speed = trace[i, layout.BEFORE]
        if trace[i, layout.END] == layout.IMPACT and speed > 0.0:
            after = last if i == count - 1 else poses[i + 1]
            toward = acceleration_before(
                pairs, modes, drive, after, speed, trace[i, layout.AT_CLOCK] + trace[i, layout.DURATION]
            )
            carry_over_impact(pairs, modes, drive, toward / speed, columns)
    return False


@kernel
def normalized(pairs: Array, w: float, column: Array) -> float:
    """Make a disturbance (2, n) one of size 1 in units of velocity; what it was."""
    square = 0.0
    for k in range(pairs.shape[1]):
        unit = pairs[layout.OMEGA, k] if pairs[layout.OMEGA, k] > 0.0 else w
        square += (unit * column[0, k]) * (unit * column[0, k]) + column[1, k] * column[1, k]
    size = sqrt(square)
    if size == 0.0:
        return size
    for k in range(pairs.shape[1]):
        column[0, k] /= size
        column[1, k] /= size
    return size
