"""Stops that yield: the contact lasts, and its force is a function of the penetration d and its rate.

All of them push only. Contact begins where d = 0 is crossed inwards; the force is zero wherever the formula would pull.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import acos, acosh, exp, sqrt
from typing import ClassVar

import numpy as np

from vibeam_models.arguments import number, real, refuse, settle
from vibeam_models.arrays import Array
from vibeam_models.laws.free_impact import (
    FreeImpact,
    falling_zero,
    hunt_crossley_impact,
    hunt_crossley_loss,
    linear_impact,
)
from vibeam_models.laws.mechanics import KernelNumbers, Spring, StopLaw, without_mass


@dataclass(frozen=True)
class LinearStop(StopLaw):
    """F = k d + c d′ while that is positive and d > 0: ``stiffness`` k > 0 in N/m, ``damping`` c ≥ 0 in N s/m.

    With damping the force vanishes before d does: the contact ends there, without adhesion. ValueError otherwise.
    """

    stiffness: float
    damping: float = 0.0

    name: ClassVar[str] = "linear"
    yields: ClassVar[bool] = True

    def __post_init__(self) -> None:
        settle(self, "stop", stiffness={"above": 0.0}, damping={"least": 0.0})

    @classmethod
    def matched(cls, stiffness: float, restitution: float, mass: float) -> LinearStop:
        """The stop that gives back a free ``mass`` (kg) the share ``restitution`` in (0, 1] of its velocity.

        For several modes the mass is 1/S, S = w M⁻¹ wᵀ: with k → ∞ the contact then goes over to that restitution.
        """
        faults: list[str] = []
        stiff, heavy = number("stiffness", stiffness, faults, above=0.0), number("mass", mass, faults, above=0.0)
        refuse("stop", faults)
        return cls(stiff, 2 * contact_damping_ratio(restitution) * sqrt(stiff * heavy))

    @property
    def spring(self) -> Spring:
        """Stiffness k and damping c."""
        return Spring(self.stiffness, self.damping)

    def kernel_numbers(self) -> KernelNumbers:
        """Numbers k and c."""
        return KernelNumbers("linear", {"stiffness": self.stiffness, "damping": self.damping})

    def force(self, depth: Array, rate: Array) -> Array:
        """max(0, k d + c d′)."""
        return np.maximum(self.stiffness * depth + self.damping * rate, 0.0)

    def balance(self, beyond: float, give: float) -> float:
        """k beyond/(1 + k give)."""
        return self.stiffness * beyond / (1 + self.stiffness * give)

    def free_impact(self, mass: float, speed: float) -> FreeImpact:
        """See ``StopLaw.free_impact``."""
        return linear_impact(self.stiffness, self.damping, mass, speed)

    def in_series(self, flexibility: float) -> LinearStop:
        """See ``StopLaw.in_series``; ValueError where it is damped."""
        if self.damping:
            raise without_mass("a damper behind a contact without mass makes a state of the first order")
        return LinearStop(self.stiffness / (1 + self.stiffness * flexibility))


def linear_restitution(zeta: float) -> float:
    """R = e^{−2θ cot θ} with ζ = cos θ (ζ < 1), e^{−2α coth α} with ζ = cosh α (ζ > 1), e⁻² between them.

    Of m d″ + c d′ + k d = 0, d(0) = 0: the force is m times the deceleration, so contact ends where d″ = 0, that is
    where tan wt = tan 2θ: after 2θ/w, with d′ = −v e^{−σt}.
    """
    if zeta == 1:
        return exp(-2)
    if zeta > 1:
        angle = acosh(zeta)
        return exp(-2 * angle / (sqrt(zeta**2 - 1) / zeta))
    return exp(-2 * acos(zeta) * zeta / sqrt(1 - zeta**2))


def contact_damping_ratio(restitution: float, relation: Callable[[float], float] = linear_restitution) -> float:
    """The ζ of a ``relation`` for R in (0, 1]; ValueError outside. Bisected: R falls steadily with ζ."""
    if not 0 < (real(restitution) or 0.0) <= 1:
        raise ValueError(f"restitution: {restitution!r} is outside (0, 1], which is what a linear stop can give")
    low, high = 0.0, 1.0
    while relation(high) > restitution:
        low, high = high, 2 * high
    return falling_zero(lambda zeta: relation(zeta) - restitution, low, high)


@dataclass(frozen=True)
class HuntCrossley(StopLaw):
    """F = k d^p (1 + a d′): ``stiffness`` k > 0 in N/m^p, ``damping`` a ≥ 0 in s/m, ``exponent`` p ≥ 1 (3/2: a sphere).

    a = 0 is Hertz's law. ValueError otherwise.
    """

    stiffness: float
    damping: float = 0.0
    exponent: float = 1.5

    yields: ClassVar[bool] = True
    integrated: ClassVar[bool] = True

    def __post_init__(self) -> None:
        settle(self, "stop", stiffness={"above": 0.0}, damping={"least": 0.0}, exponent={"least": 1.0})

    @property
    def name(self) -> str:
        """By its damping: ``"hertz"`` without."""
        return "hunt-crossley" if self.damping else "hertz"

    def kernel_numbers(self) -> KernelNumbers:
        """Numbers k, a and p."""
        values = {"exponent": self.exponent, "stiffness": self.stiffness, "damping": self.damping}
        return KernelNumbers("hunt-crossley", values)

    def force(self, depth: Array, rate: Array) -> Array:
        """max(0, k d^p (1 + a d′))."""
        return np.maximum(self.stiffness * depth**self.exponent * (1 + self.damping * rate), 0.0)

    def balance(self, beyond: float, give: float) -> float:
        """F = k d^p, d = beyond − give F, bisected."""
        depth = falling_zero(lambda d: beyond - d - give * self.stiffness * d**self.exponent, 0.0, beyond)
        return float(self.stiffness * depth**self.exponent)

    def free_impact(self, mass: float, speed: float) -> FreeImpact:
        """See ``StopLaw.free_impact``."""
        return hunt_crossley_impact(self.stiffness, self.damping, self.exponent, mass, speed)

    @classmethod
    def matched(cls, stiffness: float, restitution: float, velocity: float, exponent: float = 1.5) -> HuntCrossley:
        """The stop that gives a free mass hitting at ``velocity`` (m/s) back the share ``restitution`` in (0, 1]."""
        if not (real(velocity) or 0.0) > 0:
            raise ValueError("stop: the velocity at which the restitution holds must be a finite number above 0")
        return cls(stiffness, hunt_crossley_product(restitution) / velocity, exponent)


def Hertz(stiffness: float, exponent: float = 1.5) -> HuntCrossley:
    """F = k d^p, elastic: ``stiffness`` k in N/m^p."""
    return HuntCrossley(stiffness, 0.0, exponent)


def hunt_crossley_product(restitution: float) -> float:
    """x = a v from a v (1 + R) = ln((1 + a v)/(1 − a v R)), R in (0, 1]; ValueError outside.

    From m d′ dd′/(1 + a d′) = −k d^p dd, integrated from v to 0 and from 0 to −R v over the same depth.
    """
    if not 0 < (real(restitution) or 0.0) <= 1:
        raise ValueError(f"restitution: {restitution!r} is outside (0, 1], which is what this law can give")
    if restitution == 1:
        return 0.0
    return falling_zero(lambda x: hunt_crossley_loss(x, restitution), 0.0, (1 - 1e-16) / restitution)
