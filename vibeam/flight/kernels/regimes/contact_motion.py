"""The contact's motion in a pose: velocity, acceleration and jerk towards a stop, each with the size of its parts.

And the leading order by which a regime's signal rises from its start.
"""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.drive import phase
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.kernels.modal_flow import ROUND_OFF
from vibeam.flight.kernels.regimes import layout as row
from vibeam.flight.kernels.regimes.layout import RegimeEngine
from vibeam.flight.kernels.roots.signal import derivatives, signal_of
from vibeam_models.arrays import Array


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
def braked(engine: RegimeEngine, rates: Array, at: int, k: int) -> float:
    """Damping force on mode k: Σ damper_kj rates_j."""
    if engine.law[row.COUPLED] == 0.0:
        return float(engine.damping[k] * rates[at, k])
    total = 0.0
    for j in range(engine.contact.shape[1]):
        total += engine.damper[k, j] * rates[at, j]
    return total


@kernel
def braked_at_most(engine: RegimeEngine, rates: Array, at: int, k: int) -> float:
    """The sizes of its parts, added up."""
    if engine.law[row.COUPLED] == 0.0:
        return float(engine.damping[k] * abs(rates[at, k]))
    total = 0.0
    for j in range(engine.contact.shape[1]):
        total += abs(engine.damper[k, j] * rates[at, j])
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
    return float(total / engine.law[row.MOBILITY])


@kernel
def leading_order(regime: Regime, value: float, rate: float, size: float) -> tuple[int, float]:
    """Order and size of the first derivative by which the signal just shown rises from 0: (0, 0) where it is above it
    already, (−1, 0) where it falls.
    """
    if value > ROUND_OFF * size:
        return 0, 0.0
    if rate > 0.0 and value >= -ROUND_OFF * size:
        return 1, rate
    if rate < 0.0 or value < -ROUND_OFF * size:
        return -1, 0.0
    return curve_of(regime)


@kernel
def curve_of(regime: Regime) -> tuple[int, float]:
    """The same for a signal known to start at 0 without slope: by its second and third derivative."""
    derivatives(signal_of(regime), regime.pairs.shape[1], layout.WHOLE, 3)
    if regime.signal[layout.WHOLE + 2] > 0.0:
        return 2, float(regime.signal[layout.WHOLE + 2])
    if regime.signal[layout.WHOLE + 2] == 0.0 and regime.signal[layout.WHOLE + 3] > 0.0:
        return 3, float(regime.signal[layout.WHOLE + 3])
    return -1, 0.0
