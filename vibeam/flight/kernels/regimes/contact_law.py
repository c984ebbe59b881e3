"""What the law says at an impact: R(v), and what is left of an endless series of impacts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.block_flow import set_signal
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.drive import phase
from vibeam.flight.kernels.impact import (
    FAITHFUL,
    FLOOR,
    is_faint,
    is_over,
    jerk_bound,
    put_contact_at,
    size_of_gap,
    stop_contact,
)
from vibeam.flight.kernels.layout import CLOCK, GAP_SIGNAL, KAPPA, SPEED, STRENGTH, W
from vibeam.flight.kernels.modal_flow import ROUND_OFF
from vibeam.flight.kernels.regimes.layout import (
    COEFFICIENT,
    CONSTANT,
    COUPLED,
    CURVE,
    EXPONENT,
    MOBILITY,
    SLOPE_AT,
    SPEED_AT,
    TABLE,
    VALUE_AT,
    VELOCITY,
    VISCOUS,
    RegimeEngine,
)
from vibeam.flight.kernels.roots.signal import signal_of

Array = NDArray[np.float64]


@kernel
def restitution(law: Array, curve: Array, velocity: float) -> float:
    """R at an impact velocity ≥ 0."""
    if law[CURVE] == CONSTANT:
        return float(law[COEFFICIENT])
    if law[CURVE] == TABLE:
        return tabulated(curve, velocity)
    if law[CURVE] == VISCOUS:
        return float(max(0.0, 1.0 - law[COEFFICIENT] * velocity ** law[EXPONENT]))
    if velocity <= law[VELOCITY] * law[COEFFICIENT] ** (1.0 / law[EXPONENT]):
        return 1.0
    return float(law[COEFFICIENT] * (velocity / law[VELOCITY]) ** -law[EXPONENT])


@kernel
def tabulated(curve: Array, velocity: float) -> float:
    """R from the table, by its cubics."""
    last = curve.shape[1] - 1
    if velocity <= curve[SPEED_AT, 0]:
        return float(curve[VALUE_AT, 0])
    if velocity >= curve[SPEED_AT, last]:
        return float(curve[VALUE_AT, last])
    i = 0
    while curve[SPEED_AT, i + 1] <= velocity:
        i += 1
    h = curve[SPEED_AT, i + 1] - curve[SPEED_AT, i]
    u = (velocity - curve[SPEED_AT, i]) / h
    rise = curve[VALUE_AT, i + 1] - curve[VALUE_AT, i]
    bend = h * u * (1.0 - u) * ((1.0 - u) * curve[SLOPE_AT, i] - u * curve[SLOPE_AT, i + 1])
    return float(curve[VALUE_AT, i] + rise * u * u * (3.0 - 2.0 * u) + bend)


@kernel
def approach(plan: RegimeEngine, pose: Array, side: int) -> float:
    """Contact velocity towards the stop of that side."""
    total = 0.0
    for k in range(pose.shape[1]):
        total += plan.contact[side, k] * pose[1, k]
    return total


@kernel
def drift(plan: RegimeEngine, pose: Array, side: int) -> float:
    """The contact velocity that is no more than round-off of what it is the sum of."""
    size = 0.0
    for k in range(pose.shape[1]):
        size += abs(plan.contact[side, k]) * (abs(pose[1, k]) + plan.omega[k] * abs(pose[0, k]))
    return ROUND_OFF * size


@kernel
def braked(plan: RegimeEngine, rates: Array, row: int, k: int) -> float:
    """What the damping does to mode k: Σ damper_kj rates_j."""
    if plan.law[COUPLED] == 0.0:
        return float(plan.damping[k] * rates[row, k])
    total = 0.0
    for j in range(plan.contact.shape[1]):
        total += plan.damper[k, j] * rates[row, j]
    return total


@kernel
def braked_at_most(plan: RegimeEngine, rates: Array, row: int, k: int) -> float:
    """The sizes of its parts, added up."""
    if plan.law[COUPLED] == 0.0:
        return float(plan.damping[k] * abs(rates[row, k]))
    total = 0.0
    for j in range(plan.contact.shape[1]):
        total += abs(plan.damper[k, j] * rates[row, j])
    return total


@kernel
def pull(plan: RegimeEngine, pose: Array, side: int, clock: float) -> tuple[float, float]:
    """Second and third derivative of the contact towards the stop in free motion, each 0 where it is but the round-off
    of what it is the sum of.
    """
    cosine, sine = phase(plan.drive, clock)
    strength, scratch, second, second_size = plan.drive[STRENGTH], plan.stages, 0.0, 0.0
    for k in range(pose.shape[1]):
        push, spring = plan.load[k] * strength, plan.spring[k] * pose[0, k]
        scratch[0, k] = push * sine + plan.static[k] - braked(plan, pose, 1, k) - spring
        scratch[1, k] = pull_parts(plan, pose, k)
        second += plan.contact[side, k] * scratch[0, k]
        second_size += abs(plan.contact[side, k]) * scratch[1, k]
    third, third_size = 0.0, 0.0
    for k in range(pose.shape[1]):
        push, spring = plan.load[k] * strength * plan.drive[W], plan.spring[k] * pose[1, k]
        third += plan.contact[side, k] * (push * cosine - braked(plan, scratch, 0, k) - spring)
        parts = abs(push) + braked_at_most(plan, scratch, 1, k) + abs(spring) + plan.omega[k] * scratch[1, k]
        third_size += abs(plan.contact[side, k]) * parts
    second = second if abs(second) > ROUND_OFF * second_size else 0.0
    third = third if abs(third) > ROUND_OFF * third_size else 0.0
    return second, third


@kernel
def pull_parts(plan: RegimeEngine, pose: Array, k: int) -> float:
    """The sizes of the parts of mode k's acceleration in free motion, added up."""
    push = abs(plan.load[k] * plan.drive[STRENGTH]) + abs(plan.static[k])
    return float(push + braked_at_most(plan, pose, 1, k) + abs(plan.spring[k] * pose[0, k]))


@kernel
def force_parts(plan: RegimeEngine, pose: Array) -> float:
    """The sizes of the parts of a hard stop's force, mode by mode, before they cancel."""
    total = 0.0
    for k in range(pose.shape[1]):
        total += abs(plan.contact[0, k]) * pull_parts(plan, pose, k)
    return float(total / plan.law[MOBILITY])


@kernel
def push(plan: RegimeEngine, pose: Array, side: int, impulse: float) -> None:
    """η'⁺ = η'⁻ + c p."""
    for k in range(pose.shape[1]):
        pose[1, k] += plan.contact[side, k] * impulse


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
def chatter_left(
    plan: RegimeEngine, pose: Array, status: Array, side: int, toward: float, after: float
) -> tuple[float, float]:
    """Time that the rest of an accumulation of impacts takes, and a bound of its error; (−1, 0) where it is too early.

    The free regime has been entered. With contact acceleration a = ``toward`` the stop the flights last 2v/a, 2Rv/a, …:
    together T = 2v / (a (1 − R)); relative error at most M₃T/a, M₃ bounding the jerk (Nordmark & Piiroinen 2009). A
    table is constant at the end; with R = 1 − c v^b the sum is ∫ 2 dv/(a c v^b) = T/(1 − b) for b < 1, but for a share
    of about 1 − R.
    """
    coefficient, top = restitution(plan.law, plan.curve, after), status[SPEED]
    loss = 1.0 - coefficient
    if plan.law[CURVE] == VISCOUS:
        loss *= max(1.0 - plan.law[EXPONENT], 0.0)
    if not is_faint(after, top, toward, loss, abs(plan.gaps[side])):
        return -1.0, 0.0
    free, contact, gap = plan.free, plan.contact[side], plan.gaps[side]
    left, length = 2.0 * after / (toward * loss), top * (top / toward)
    set_signal(free, plan.drive, GAP_SIGNAL + side, 1.0, status[CLOCK])
    jerk = jerk_bound(signal_of(free))
    size = size_of_gap(signal_of(free), contact, gap, pose)
    remainder, slowest = left * (jerk * left / toward), max(plan.drive[W], free.pairs[KAPPA, 0])
    if remainder > FAITHFUL * coefficient * 2.0 * (top / toward) / loss and after * left >= FLOOR * length:
        return -1.0, 0.0
    if plan.law[CURVE] == VISCOUS:
        remainder += 2.0 * (1.0 - coefficient) * left
    elif plan.law[CURVE] == TABLE and after > plan.curve[SPEED_AT, 0]:
        remainder += left
    if not is_over(after, left, remainder, jerk * left / toward, length, size, pose.shape[1], slowest):
        return -1.0, 0.0
    return left, remainder
