"""Contact laws: restitution R(v) of a stop that does not yield, force F(d, d') of one that does.

A law of restitution is one function here and one line in ``restitution``, another in ``accumulation`` where its R goes
on to change as v goes to 0. A law of force that is integrated is ``force`` and its rate, ``force_rate``.
"""

from __future__ import annotations

from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.layout import ELASTIC
from vibeam.flight.kernels.regimes import layout as row
from vibeam_models.arrays import Array


@kernel
def restitution(law: Array, curve: Array, velocity: float) -> float:
    """R at an impact velocity ≥ 0."""
    if law[row.CURVE] == row.TABLE:
        return tabulated(curve, velocity)
    if law[row.CURVE] == row.VISCOUS:
        return viscous(law, velocity)
    if law[row.CURVE] == row.PLASTIC:
        return plastic(law, velocity)
    return float(law[row.COEFFICIENT])


@kernel
def viscous(law: Array, velocity: float) -> float:
    """R = 1 − c v^b, not below 0."""
    return float(max(0.0, 1.0 - law[row.COEFFICIENT] * velocity ** law[row.EXPONENT]))


@kernel
def plastic(law: Array, velocity: float) -> float:
    """R = c (v/v₀)^−b, not above 1."""
    if velocity <= law[row.VELOCITY] * law[row.COEFFICIENT] ** (1.0 / law[row.EXPONENT]):
        return 1.0
    return float(law[row.COEFFICIENT] * (velocity / law[row.VELOCITY]) ** -law[row.EXPONENT])


@kernel
def tabulated(curve: Array, velocity: float) -> float:
    """R from the table, by its cubics."""
    last = curve.shape[1] - 1
    if velocity <= curve[row.SPEED_AT, 0]:
        return float(curve[row.VALUE_AT, 0])
    if velocity >= curve[row.SPEED_AT, last]:
        return float(curve[row.VALUE_AT, last])
    i = 0
    while curve[row.SPEED_AT, i + 1] <= velocity:
        i += 1
    h = curve[row.SPEED_AT, i + 1] - curve[row.SPEED_AT, i]
    u = (velocity - curve[row.SPEED_AT, i]) / h
    rise = curve[row.VALUE_AT, i + 1] - curve[row.VALUE_AT, i]
    bend = h * u * (1.0 - u) * ((1.0 - u) * curve[row.SLOPE_AT, i] - u * curve[row.SLOPE_AT, i + 1])
    return float(curve[row.VALUE_AT, i] + rise * u * u * (3.0 - 2.0 * u) + bend)


@kernel
def accumulation(law: Array, curve: Array, coefficient: float, velocity: float) -> tuple[float, float]:
    """Divisor of the time of an accumulation of impacts, and the share of it that its limit may be off.

    Flights of 2v/a, 2Rv/a, … take 2v/(a(1 − R)) with a constant R. With R = 1 − c v^b the sum is ∫ 2 dv/(a c v^b), that
    over 1 − b for b < 1, but for a share of about 1 − R. A table is constant at the end.
    """
    loss = 1.0 - coefficient
    if law[row.CURVE] == row.VISCOUS:
        return loss * max(1.0 - law[row.EXPONENT], 0.0), 2.0 * loss
    if law[row.CURVE] == row.TABLE and velocity > curve[row.SPEED_AT, 0]:
        return loss, 1.0
    return loss, 0.0


@kernel
def is_endless(law: Array, coefficient: float) -> bool:
    """True where impacts that lose next to nothing go on for ever: not where 1 − R ~ v^b with b < 1."""
    return bool(1.0 - coefficient < ELASTIC and not (law[row.CURVE] == row.VISCOUS and law[row.EXPONENT] < 1.0))


@kernel
def force(law: Array, depth: float, rate: float) -> float:
    """F = max(0, k d^p (1 + a d')) for d > 0."""
    if depth <= 0.0:
        return 0.0
    return float(max(0.0, law[row.STIFFNESS] * depth ** law[row.EXPONENT] * (1.0 + law[row.DAMPING] * rate)))


@kernel
def force_rate(law: Array, depth: float, rate: float, second: float) -> float:
    """dF/dt where the force is not 0."""
    by_depth = law[row.EXPONENT] * depth ** (law[row.EXPONENT] - 1.0) * rate * (1.0 + law[row.DAMPING] * rate)
    return float(law[row.STIFFNESS] * (by_depth + depth ** law[row.EXPONENT] * law[row.DAMPING] * second))
