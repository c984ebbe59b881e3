"""The contact's motion in a pose: velocity, acceleration and jerk towards a stop, each with the size of its parts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.drive import phase
from vibeam.flight.kernels.layout import STRENGTH, W
from vibeam.flight.kernels.modal_flow import ROUND_OFF
from vibeam.flight.kernels.regimes.layout import COUPLED, MOBILITY, RegimeEngine

Array = NDArray[np.float64]


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
