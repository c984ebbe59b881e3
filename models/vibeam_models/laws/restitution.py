"""Laws of restitution, constant or of the impact velocity, and how R changes with the model: it does not carry over.

Stops that yield (``LinearStop``, ``Hertz``, ``HuntCrossley``) are in ``compliant``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf
from typing import ClassVar

import numpy as np

from vibeam_models.arguments import number, read_only, refuse, settle
from vibeam_models.arrays import Array
from vibeam_models.laws.mechanics import KernelNumbers, StopLaw

VELOCITY_RESTITUTION = "velocity restitution"  #: as ``law`` of a case's stop has it
VISCOUS_RESTITUTION = "viscous restitution"


@dataclass(frozen=True)
class Restitution(StopLaw):
    """v⁺ = −R v⁻ at the contact, ``coefficient`` R in [0, 1] (ValueError outside)."""

    coefficient: float

    name: ClassVar[str] = "restitution"

    def __post_init__(self) -> None:
        settle(self, "restitution", coefficient={"least": 0.0, "most": 1.0})

    @property
    def constant(self) -> float:
        """R."""
        return self.coefficient

    def kernel_numbers(self) -> KernelNumbers:
        """R alone."""
        return KernelNumbers("constant", {"coefficient": self.coefficient})

    def at(self, velocity: float) -> float:
        """R, at every velocity."""
        return self.coefficient

    def rebound(self, speeds: Array) -> Array:
        """R v."""
        return np.asarray(self.coefficient * speeds)

    def rebound_slope(self, speeds: Array) -> Array:
        """R."""
        return np.full(len(speeds), self.coefficient)

    def coefficients_up_to(self, speeds: Array) -> tuple[Array, Array]:
        """R twice."""
        return self.coefficient * np.ones(len(speeds)), self.coefficient * np.ones(len(speeds))


@dataclass(frozen=True)
class TableRestitution(StopLaw):
    """R(v) through points (``speeds`` m/s ascending, ``coefficients`` in [0, 1]), by monotone cubics between them.

    Below the first speed R keeps the first value, above the last one the last: the table says no more. ValueError for
    fewer than two points, speeds that do not ascend from ≥ 0, coefficients outside [0, 1].
    """

    speeds: tuple[float, ...]
    coefficients: tuple[float, ...]

    name: ClassVar[str] = VELOCITY_RESTITUTION

    def __post_init__(self) -> None:
        for name in ("speeds", "coefficients"):
            column = read_only(getattr(self, name))
            if column is None or column.ndim != 1:
                raise ValueError(f"restitution: the {name} of the table must be a list of numbers")
            object.__setattr__(self, name, tuple(column.tolist()))
        if len(self.speeds) != len(self.coefficients) or len(self.speeds) < 2:
            raise ValueError("restitution: a table needs two or more speeds and as many coefficients")
        if self.speeds[0] < 0 or not all(a < b for a, b in zip(self.speeds, (*self.speeds[1:], inf), strict=True)):
            raise ValueError("restitution: the speeds of the table must be ≥ 0 and ascend")
        if not all(0 <= r <= 1 for r in self.coefficients):
            raise ValueError("restitution: a coefficient of the table is outside [0, 1]")

    @classmethod
    def through(cls, restitution: Callable[[float], float], speeds: Sequence[float]) -> TableRestitution:
        """Table of a function R(v) at ``speeds``, m/s: what the kernels fly of a law that they have no formula of."""
        return cls(tuple(speeds), tuple(restitution(speed) for speed in speeds))

    def slopes(self) -> tuple[float, ...]:
        """dR/dv at the points, so that the cubics are monotone where the points are (Fritsch & Butland 1984)."""
        v, r = self.speeds, self.coefficients
        h = [b - a for a, b in pairwise(v)]
        rise = [(b - a) / step for (a, b), step in zip(pairwise(r), h, strict=True)]
        inner = []
        for i in range(1, len(h)):
            first, second = 2 * h[i] + h[i - 1], h[i] + 2 * h[i - 1]
            turns = rise[i - 1] * rise[i] <= 0
            inner.append(0.0 if turns else (first + second) / (first / rise[i - 1] + second / rise[i]))
        return (0.0, *inner, 0.0)  # level at both ends, as R is constant beyond them

    def at(self, velocity: float) -> float:
        """R at an impact velocity, m/s."""
        return float(self._coefficients(np.asarray(velocity)))

    def kernel_numbers(self) -> KernelNumbers:
        """The points with their slopes."""
        return KernelNumbers("table", table=np.array([self.speeds, self.coefficients, self.slopes()]))

    def rebound(self, speeds: Array) -> Array:
        """R v by the monotone cubics, R constant beyond their ends."""
        return self._coefficients(speeds) * speeds

    def rebound_slope(self, speeds: Array) -> Array:
        """R + v dR/dv."""
        from scipy.interpolate import CubicHermiteSpline

        v = np.array(self.speeds)
        inside = (speeds >= v[0]) & (speeds <= v[-1])
        slope = CubicHermiteSpline(v, self.coefficients, self.slopes()).derivative()
        fall = np.where(inside, slope(np.clip(speeds, v[0], v[-1])), 0.0)
        return self._coefficients(speeds) + fall * speeds

    def coefficients_up_to(self, speeds: Array) -> tuple[Array, Array]:
        """Least and largest of the points that bound R below ``speeds``."""
        last = np.minimum(np.searchsorted(self.speeds, speeds), len(self.speeds) - 1)
        values = np.array(self.coefficients)
        return np.minimum.accumulate(values)[last], np.maximum.accumulate(values)[last]

    def _coefficients(self, speeds: Array) -> Array:
        v, r, slope = np.array(self.speeds), np.array(self.coefficients), np.array(self.slopes())
        i = np.clip(np.searchsorted(v, speeds, side="right") - 1, 0, len(v) - 2)
        h = v[i + 1] - v[i]
        u = np.clip((speeds - v[i]) / h, 0.0, 1.0)
        bend = h * u * (1 - u) * ((1 - u) * slope[i] - u * slope[i + 1])
        return np.asarray(r[i] + (r[i + 1] - r[i]) * u * u * (3 - 2 * u) + bend)


@dataclass(frozen=True)
class PlasticRestitution(StopLaw):
    """R(v) = R₀ (v/v₀)^−n above the speed at which that is 1, and 1 below it, where nothing yields.

    ``coefficient`` R₀ in (0, 1] at ``velocity`` v₀ m/s; ``exponent`` n > 0, ¼ for full plasticity (Johnson, *Contact
    Mechanics*, eq. 11.47). ValueError otherwise.
    """

    coefficient: float
    velocity: float
    exponent: float = 0.25

    name: ClassVar[str] = VELOCITY_RESTITUTION

    def __post_init__(self) -> None:
        shares, positive = {"above": 0.0, "most": 1.0}, {"above": 0.0}
        settle(self, "restitution", coefficient=shares, velocity=positive, exponent=positive)

    @property
    def elastic(self) -> float:
        """Speed up to which nothing yields and R is 1, m/s."""
        return float(self.velocity * self.coefficient ** (1 / self.exponent))

    def kernel_numbers(self) -> KernelNumbers:
        """R₀, v₀ and n."""
        values = {"coefficient": self.coefficient, "velocity": self.velocity, "exponent": self.exponent}
        return KernelNumbers("plastic", values)

    def at(self, velocity: float) -> float:
        """R at an impact velocity, m/s."""
        if velocity <= self.elastic:
            return 1.0
        return float(self.coefficient * (velocity / self.velocity) ** -self.exponent)

    def rebound(self, speeds: Array) -> Array:
        """R v."""
        fast = np.maximum(speeds, self.elastic)
        falling = self.coefficient * (fast / self.velocity) ** -self.exponent
        return np.where(speeds > self.elastic, falling, 1.0) * speeds

    def rebound_slope(self, speeds: Array) -> Array:
        """(1 − n) R, or 1 where nothing yields."""
        share = self.rebound(speeds) / speeds
        return np.where(share < 1, (1 - self.exponent) * share, 1.0)


@dataclass(frozen=True)
class ViscousRestitution(StopLaw):
    """R(v) = 1 − a v^b up to the speed at which that is 0, and 0 above it.

    ``factor`` a ≥ 0 in (s/m)^b; ``exponent`` b > 0, ⅕ for viscoelastic spheres (Kuwabara & Kono 1987). ValueError
    otherwise.
    """

    factor: float
    exponent: float = 0.2

    name: ClassVar[str] = VISCOUS_RESTITUTION

    def __post_init__(self) -> None:
        settle(self, "restitution", factor={"least": 0.0}, exponent={"above": 0.0})

    def at(self, velocity: float) -> float:
        """R at an impact velocity, m/s."""
        return float(max(0.0, 1 - self.factor * max(velocity, 0.0) ** self.exponent))

    @classmethod
    def matched(cls, restitution: float, velocity: float, exponent: float = 0.2) -> ViscousRestitution:
        """The law R = 1 − (1 − R₀) (v/v₀)^b: ``restitution`` R₀ in [0, 1] at ``velocity`` v₀ > 0, m/s."""
        faults: list[str] = []
        share = 1 - number("restitution", restitution, faults, least=0.0, most=1.0)
        speed = number("velocity", velocity, faults, above=0.0)
        refuse("restitution", faults)
        return cls(share / speed**exponent, exponent)

    @property
    def converges(self) -> bool:
        """With b < 1: the times 2v/a between impacts have a finite sum."""
        return self.exponent < 1

    def kernel_numbers(self) -> KernelNumbers:
        """Numbers a and b."""
        return KernelNumbers("viscous", {"coefficient": self.factor, "exponent": self.exponent})

    def rebound(self, speeds: Array) -> Array:
        """R v."""
        return np.asarray(np.maximum(0.0, 1 - self.factor * speeds**self.exponent) * speeds)

    def rebound_slope(self, speeds: Array) -> Array:
        """1 − (1 + b) a v^b, or 0 where R is."""
        fallen = self.factor * speeds**self.exponent
        return np.where(fallen < 1, 1 - (1 + self.exponent) * fallen, 0.0)

    def accumulation_loss(self, speeds: Array) -> Array:
        """(1 − b) a v^b, from ∫ du/(a u^b)."""
        return np.asarray(self.factor * (1 - self.exponent) * speeds**self.exponent)

    def accumulation(self, speed: Array, least: Array, most: Array, jerk: Array) -> tuple[Array, Array, Array]:
        """See ``StopLaw.accumulation``: sums of launch velocities that fall by κ'u^{1+b} to κ''u^{1+b}."""
        b, theta = self.exponent, jerk / least**2
        weaker, stronger = self.factor - theta * speed ** (1 - b), self.factor + theta * speed ** (1 - b)
        bounded = (weaker > 0) & (stronger * speed**b < 1) & (theta * speed < 1)
        whole = np.where(bounded, speed ** (1 - b) / (1 - b), np.nan)
        shortest, longest = (1 - stronger * speed**b) ** b * whole / stronger, whole / weaker
        return 2 * shortest / most, 2 * longest / least, 2 * longest * (1 + theta * speed)


def first_mode_restitution(restitution: float, first: float, mobility: float) -> float:
    """R₁ = (1+R) c₁²/S − 1: what mode 1, of contact value ``first`` c₁, sees of a contact with R.

    ``mobility`` S = Σ c_i² over the modes of the model. Negative where little of S is mode 1's.
    """
    return (1 + restitution) * first**2 / mobility - 1


def needed_restitution(first_mode: float, first: float, mobility: float) -> float:
    """R = (1+R₁) S/c₁² − 1 with which mode 1 sees R₁ = ``first_mode``; above 1 no contact can do that."""
    return (1 + first_mode) * mobility / first**2 - 1


def contact_restitution(first_mode: float, first: float, mobility: float) -> float:
    """The ``needed_restitution``; ValueError where no R in [0, 1] gives that R₁ in this model."""
    if first**2 == 0:
        raise ValueError("restitution: mode 1 does not move the contact, and sees none: give the contact's own")
    restitution = needed_restitution(first_mode, first, mobility)
    if not 0 <= restitution <= 1:
        raise ValueError(
            f"restitution: mode 1 would see {first_mode} only with {restitution:.12g} at the contact, outside [0, 1]: "
            f"it carries {first**2 / mobility:.1%} of this model's contact mobility; hold the contact's own "
            '(restitution_of = "contact"), or let the stop yield: vibeam modes writes its table'
        )
    return restitution
