"""Laws of restitution, constant or of the impact velocity, and how R changes with the model: it does not carry over.

Stops that yield (``LinearStop``, ``Hertz``, ``HuntCrossley``) are in ``compliant``.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from itertools import pairwise
from math import inf
from typing import ClassVar

from vibeam_models.arguments import number, read_only, refuse

VELOCITY_RESTITUTION = "velocity restitution"  #: as ``law`` of a case's stop has it


@dataclass(frozen=True)
class Restitution:
    """v⁺ = −R v⁻ at the contact, ``coefficient`` R in [0, 1] (ValueError outside)."""

    coefficient: float

    def __post_init__(self) -> None:
        faults: list[str] = []
        object.__setattr__(self, "coefficient", number("coefficient", self.coefficient, faults, least=0.0, most=1.0))
        refuse("restitution", faults)

    def after(self, velocity: float) -> float:
        """Contact velocity in m/s just after, from ``velocity`` just before."""
        return -self.coefficient * velocity

    def impulse(self, velocity: float, mobility: float) -> float:
        """Impulse p = −(1+R) v⁻/S in N s on the contact coordinate; ``mobility`` S = w M⁻¹ wᵀ in 1/kg."""
        return -(1 + self.coefficient) * velocity / mobility


@dataclass(frozen=True)
class TableRestitution:
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
        v, r, slope = self.speeds, self.coefficients, self.slopes()
        i = bisect_right(v, velocity) - 1
        if i < 0 or i >= len(v) - 1:
            return r[max(i, 0)]
        h = v[i + 1] - v[i]
        u = (velocity - v[i]) / h
        lift = u * u * (3 - 2 * u)
        bend = h * u * (1 - u) * ((1 - u) * slope[i] - u * slope[i + 1])
        return r[i] + (r[i + 1] - r[i]) * lift + bend


@dataclass(frozen=True)
class PlasticRestitution:
    """R(v) = R₀ (v/v₀)^−n above the speed at which that is 1, and 1 below it, where nothing yields.

    ``coefficient`` R₀ in (0, 1] at ``velocity`` v₀ m/s; ``exponent`` n > 0, ¼ for full plasticity (Johnson, *Contact
    Mechanics*, eq. 11.47). ValueError otherwise.
    """

    coefficient: float
    velocity: float
    exponent: float = 0.25

    name: ClassVar[str] = VELOCITY_RESTITUTION

    def __post_init__(self) -> None:
        faults: list[str] = []
        object.__setattr__(self, "coefficient", number("coefficient", self.coefficient, faults, above=0.0, most=1.0))
        object.__setattr__(self, "velocity", number("velocity", self.velocity, faults, above=0.0))
        object.__setattr__(self, "exponent", number("exponent", self.exponent, faults, above=0.0))
        refuse("restitution", faults)

    def at(self, velocity: float) -> float:
        """R at an impact velocity, m/s."""
        if velocity <= self.velocity * self.coefficient ** (1 / self.exponent):
            return 1.0
        return float(self.coefficient * (velocity / self.velocity) ** -self.exponent)


@dataclass(frozen=True)
class ViscousRestitution:
    """R(v) = 1 − a v^b up to the speed at which that is 0, and 0 above it.

    ``factor`` a ≥ 0 in (s/m)^b; ``exponent`` b > 0, ⅕ for viscoelastic spheres (Kuwabara & Kono 1987). ValueError
    otherwise.
    """

    factor: float
    exponent: float = 0.2

    name: ClassVar[str] = VELOCITY_RESTITUTION

    def __post_init__(self) -> None:
        faults: list[str] = []
        object.__setattr__(self, "factor", number("factor", self.factor, faults, least=0.0))
        object.__setattr__(self, "exponent", number("exponent", self.exponent, faults, above=0.0))
        refuse("restitution", faults)

    def at(self, velocity: float) -> float:
        """R at an impact velocity, m/s."""
        return float(max(0.0, 1 - self.factor * max(velocity, 0.0) ** self.exponent))


VelocityRestitution = TableRestitution | PlasticRestitution | ViscousRestitution


def first_mode_restitution(restitution: float, first: float, mobility: float) -> float:
    """R₁ = (1+R) c₁²/S − 1: what mode 1, of contact value ``first`` c₁, sees of a contact with R.

    ``mobility`` S = Σ c_i² over the modes of the model. Negative where little of S is mode 1's.
    """
    return (1 + restitution) * first**2 / mobility - 1


def contact_restitution(first_mode: float, first: float, mobility: float) -> float:
    """R = (1+R₁) S/c₁² − 1: the contact's coefficient with which mode 1 sees R₁ = ``first_mode``.

    ValueError where no R in [0, 1] gives that R₁ in this model.
    """
    if first**2 == 0:
        raise ValueError("restitution: mode 1 does not move the contact, and sees none: give the contact's own")
    restitution = (1 + first_mode) * mobility / first**2 - 1
    if not 0 <= restitution <= 1:
        raise ValueError(
            f"restitution: mode 1 would see {first_mode} only with {restitution:.4g} at the contact, outside [0, 1]: "
            f"it carries {first**2 / mobility:.1%} of this model's contact mobility"
        )
    return restitution
