"""Closed forms of a free mass that strikes a stop which yields: what it gets back, for how long it is in contact."""

from __future__ import annotations

from math import acos, acosh, inf, log1p, sinh, sqrt

from scipy.optimize import brentq

from vibeam_models.laws.compliant import HuntCrossley, LinearStop, linear_restitution


def damping_ratio(stop: LinearStop, mass: float) -> float:
    """ζ = c / 2√(km) of a free ``mass`` (kg) in contact."""
    return stop.damping / (2 * sqrt(stop.stiffness * mass))


def restitution(stop: LinearStop, mass: float) -> float:
    """R of a free ``mass`` (kg)."""
    return linear_restitution(damping_ratio(stop, mass))


def duration(stop: LinearStop, mass: float) -> float:
    """Contact time in s of a free ``mass`` (kg): 2θ / (ω sin θ), ζ = cos θ, or its hyperbolic form."""
    zeta, omega = damping_ratio(stop, mass), sqrt(stop.stiffness / mass)
    if zeta < 1:
        angle = acos(zeta)
        return 2 * angle / (omega * sqrt(1 - zeta**2)) if angle > 0 else 2 / omega
    angle = acosh(zeta)
    return 2 * angle / (omega * sinh(angle)) if angle > 0 else 2 / omega


def given_back(stop: HuntCrossley, velocity: float) -> float:
    """R of a free mass hitting at ``velocity`` (m/s): x (1 + R) = ln((1 + x)/(1 − xR)) with x = a v."""
    x = stop.damping * velocity
    if x == 0:
        return 1.0

    def loss(r: float) -> float:
        return x * (1 + r) - log1p(x) + (log1p(-x * r) if x * r < 1 else -inf)

    return float(brentq(loss, 1e-12, min(1.0, (1 - 1e-15) / x), xtol=1e-15, rtol=1e-15))


def depth(stop: HuntCrossley, mass: float, velocity: float) -> float:
    """Largest penetration in m of a free ``mass`` (kg) without damping: ½ m v² = k d^{p+1}/(p + 1)."""
    power = stop.exponent + 1
    return float((power * mass * velocity**2 / (2 * stop.stiffness)) ** (1 / power))
