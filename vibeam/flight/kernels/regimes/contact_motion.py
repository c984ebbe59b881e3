"""The contact's motion in a pose: velocity, acceleration and jerk towards a stop, each with the size of its parts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.drive import phase
from vibeam.flight.kernels.modal_flow import ROUND_OFF
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.kernels.regimes.layout import RegimeEngine

Array = NDArray[np.float64]


@kernel
def approach(engine: RegimeEngine, pose: Array, side: int) -> float:
    """Contact velocity towards the stop of that side."""
    total = 0.0
    for k in range(pose.shape[1]):
        total += engine.contact[side, k] * pose[1, k]
    return total


@kernel
def drift(engine: RegimeEngine, pose: Array, side: int) -> float:
    """The contact velocity that is no more than round-off of what it is the sum of."""
    size = 0.0
    for k in range(pose.shape[1]):
        size += abs(engine.contact[side, k]) * (abs(pose[1, k]) + engine.omega[k] * abs(pose[0, k]))
    return ROUND_OFF * size


@kernel
def braked(engine: RegimeEngine, rates: Array, row: int, k: int) -> float:
    """What the damping does to mode k: Σ damper_kj rates_j."""
    if engine.law[regime_layout.COUPLED] == 0.0:
        return float(engine.damping[k] * rates[row, k])
    total = 0.0
    for j in range(engine.contact.shape[1]):
        total += engine.damper[k, j] * rates[row, j]
    return total


@kernel
def braked_at_most(engine: RegimeEngine, rates: Array, row: int, k: int) -> float:
    """The sizes of its parts, added up."""
    if engine.law[regime_layout.COUPLED] == 0.0:
        return float(engine.damping[k] * abs(rates[row, k]))
    total = 0.0
    for j in range(engine.contact.shape[1]):
        total += abs(engine.damper[k, j] * rates[row, j])
    return total


@kernel
def pull(engine: RegimeEngine, pose: Array, side: int, clock: float) -> tuple[float, float]:
    """Second and third derivative of the contact towards the stop in free motion, each 0 where it is but the round-off
    of what it is the sum of.
    """
    cosine, sine = phase(engine.drive, clock)
    strength, scratch, second, second_size = engine.drive[layout.STRENGTH], engine.stages, 0.0, 0.0
    for k in range(pose.shape[1]):
        push, spring = engine.load[k] * strength, engine.spring[k] * pose[0, k]
        scratch[0, k] = push * sine + engine.static[k] - braked(engine, pose, 1, k) - spring
        scratch[1, k] = pull_parts(engine, pose, k)
        second += engine.contact[side, k] * scratch[0, k]
        second_size += abs(engine.contact[side, k]) * scratch[1, k]
    third, third_size = 0.0, 0.0
    for k in range(pose.shape[1]):
        push, spring = engine.load[k] * strength * engine.drive[layout.W], engine.spring[k] * pose[1, k]
        third += engine.contact[side, k] * (push * cosine - braked(engine, scratch, 0, k) - spring)
        parts = abs(push) + braked_at_most(engine, scratch, 1, k) + abs(spring) + engine.omega[k] * scratch[1, k]
        third_size += abs(engine.contact[side, k]) * parts
    second = second if abs(second) > ROUND_OFF * second_size else 0.0
    third = third if abs(third) > ROUND_OFF * third_size else 0.0
    return second, third


@kernel
def pull_parts(engine: RegimeEngine, pose: Array, k: int) -> float:
    """The sizes of the parts of mode k's acceleration in free motion, added up."""
    push = abs(engine.load[k] * engine.drive[layout.STRENGTH]) + abs(engine.static[k])
    return float(push + braked_at_most(engine, pose, 1, k) + abs(engine.spring[k] * pose[0, k]))


@kernel
def force_parts(engine: RegimeEngine, pose: Array) -> float:
    """The sizes of the parts of a hard stop's force, mode by mode, before they cancel."""
    total = 0.0
    for k in range(pose.shape[1]):
        total += abs(engine.contact[0, k]) * pull_parts(engine, pose, k)
    return float(total / engine.law[regime_layout.MOBILITY])
