"""Contact laws: restitution R(v) of a stop that does not yield, force F(d, d') of one that does.

A law of restitution is one function here and one line in ``restitution``, another in ``accumulation`` where its R goes
on to change as v goes to 0. A law of force that is integrated is ``force`` and its rate, ``force_rate``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.kernels.thresholds import ELASTIC

Array = NDArray[np.float64]


@kernel
def restitution(law: Array, curve: Array, velocity: float) -> float:
    """R at an impact velocity ≥ 0."""
    if law[regime_layout.CURVE] == regime_layout.TABLE:
        return tabulated(curve, velocity)
    if law[regime_layout.CURVE] == regime_layout.VISCOUS:
        return viscous(law, velocity)
    if law[regime_layout.CURVE] == regime_layout.PLASTIC:
        return plastic(law, velocity)
    return float(law[regime_layout.COEFFICIENT])


@kernel
def viscous(law: Array, velocity: float) -> float:
    """R = 1 − c v^b, not below 0."""
    return float(max(0.0, 1.0 - law[regime_layout.COEFFICIENT] * velocity ** law[regime_layout.EXPONENT]))


@kernel
def plastic(law: Array, velocity: float) -> float:
    """R = c (v/v₀)^−b, not above 1."""
    if velocity <= law[regime_layout.VELOCITY] * law[regime_layout.COEFFICIENT] ** (1.0 / law[regime_layout.EXPONENT]):
        return 1.0
    return float(
        law[regime_layout.COEFFICIENT] * (velocity / law[regime_layout.VELOCITY]) ** -law[regime_layout.EXPONENT]
    )


@kernel
def tabulated(curve: Array, velocity: float) -> float:
    """R from the table, by its cubics."""
    last = curve.shape[1] - 1
    if velocity <= curve[regime_layout.SPEED_AT, 0]:
        return float(curve[regime_layout.VALUE_AT, 0])
    if velocity >= curve[regime_layout.SPEED_AT, last]:
        return float(curve[regime_layout.VALUE_AT, last])
    i = 0
    while curve[regime_layout.SPEED_AT, i + 1] <= velocity:
        i += 1
    h = curve[regime_layout.SPEED_AT, i + 1] - curve[regime_layout.SPEED_AT, i]
    u = (velocity - curve[regime_layout.SPEED_AT, i]) / h
    rise = curve[regime_layout.VALUE_AT, i + 1] - curve[regime_layout.VALUE_AT, i]
    bend = h * u * (1.0 - u) * ((1.0 - u) * curve[regime_layout.SLOPE_AT, i] - u * curve[regime_layout.SLOPE_AT, i + 1])
    return float(curve[regime_layout.VALUE_AT, i] + rise * u * u * (3.0 - 2.0 * u) + bend)


@kernel
def accumulation(law: Array, curve: Array, coefficient: float, velocity: float) -> tuple[float, float]:
    """What the time of an accumulation of impacts is divided by, and the share of it that its limit may be off.

    Flights of 2v/a, 2Rv/a, … take 2v/(a(1 − R)) with a constant R. With R = 1 − c v^b the sum is ∫ 2 dv/(a c v^b), that
    over 1 − b for b < 1, but for a share of about 1 − R. A table is constant at the end.
    """
    loss = 1.0 - coefficient
    if law[regime_layout.CURVE] == regime_layout.VISCOUS:
        return loss * max(1.0 - law[regime_layout.EXPONENT], 0.0), 2.0 * loss
    if law[regime_layout.CURVE] == regime_layout.TABLE and velocity > curve[regime_layout.SPEED_AT, 0]:
        return loss, 1.0
    return loss, 0.0


@kernel
def is_endless(law: Array, coefficient: float) -> bool:
    """Whether impacts that lose next to nothing go on for ever: not where 1 − R ~ v^b with b < 1."""
    return bool(
        1.0 - coefficient < ELASTIC
        and not (law[regime_layout.CURVE] == regime_layout.VISCOUS and law[regime_layout.EXPONENT] < 1.0)
    )


@kernel
def force(law: Array, depth: float, rate: float) -> float:
    """F = max(0, k d^p (1 + a d')) for d > 0."""
    if depth <= 0.0:
        return 0.0
    return float(
        max(
            0.0,
            law[regime_layout.STIFFNESS]
            * depth ** law[regime_layout.EXPONENT]
            * (1.0 + law[regime_layout.DAMPING] * rate),
        )
    )


@kernel
def force_rate(law: Array, depth: float, rate: float, second: float) -> float:
    """dF/dt where the force is not 0."""
    by_depth = (
        law[regime_layout.EXPONENT]
        * depth ** (law[regime_layout.EXPONENT] - 1.0)
        * rate
        * (1.0 + law[regime_layout.DAMPING] * rate)
    )
    return float(
        law[regime_layout.STIFFNESS]
        * (by_depth + depth ** law[regime_layout.EXPONENT] * law[regime_layout.DAMPING] * second)
    )
