"""Declarations of the laws of a rigid stop: one coefficient of restitution, or R(v) by a power, a table, viscosity."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

from vibeam_models.keys import declared, quantity
from vibeam_models.laws import EXPONENT, RESTITUTION, VELOCITY, ContactLaw
from vibeam_models.laws.restitution import (
    VELOCITY_RESTITUTION,
    VISCOUS_RESTITUTION,
    PlasticRestitution,
    Restitution,
    TableRestitution,
    ViscousRestitution,
)


@dataclass(frozen=True)
class ConstantRestitution(ContactLaw):
    """v⁺ = −R v⁻: the system's own coefficient, so that the solvers need no law beside it."""

    restitution: float = declared(RESTITUTION)

    name: ClassVar[str] = "restitution"

    def contact(self, mobility: float) -> Restitution:
        """R alone."""
        return Restitution(self.restitution)


@dataclass(frozen=True)
class VelocityDependent(ContactLaw):
    """R = R₀ (v/v₀)^−n."""

    restitution: float = declared(RESTITUTION)
    velocity: float = declared(VELOCITY)
    exponent: float | None = declared(EXPONENT, None)

    name: ClassVar[str] = VELOCITY_RESTITUTION

    @classmethod
    def forms(cls) -> tuple[type[ContactLaw], ...]:
        """The power and the table."""
        return VelocityDependent, Tabled

    @classmethod
    def form_of(cls, stop: Any) -> type[ContactLaw]:
        """The table where the stop gives part of one, else the power."""
        return VelocityDependent if stop.speeds is None and stop.restitutions is None else Tabled

    @classmethod
    def faults(cls, stop: Any) -> Iterator[tuple[str, str]]:
        """Nothing that could fall."""
        if stop.restitution == 0:
            yield "restitution", "0 leaves nothing to fall with the velocity: write a number above 0"

    def contact(self, mobility: float) -> PlasticRestitution:
        """The power, n = ¼ where it is not said."""
        return PlasticRestitution(self.restitution, self.velocity, 0.25 if self.exponent is None else self.exponent)


@dataclass(frozen=True)
class Tabled(ContactLaw):
    """R(v) through points."""

    speeds: tuple[float, ...] = quantity(
        "m/s",
        "of impact, of a table for law velocity restitution, instead of restitution and velocity",
        ["0.02 m/s", "0.2 m/s"],
        above=0,
        several=True,
        ascending=True,
        missing="of the table",
        plain=("of a table of restitutions, instead of restitution and velocity", [0.002, 0.02], "of the table"),
    )
    restitutions: tuple[float, ...] = quantity(
        "",
        "at these speeds, monotone cubics between them",
        [0.8, 0.6],
        missing="at the speeds",
        least=0,
        most=1,
        several=True,
        plain=("at the speeds", [0.8, 0.6], ""),
    )

    name: ClassVar[str] = VELOCITY_RESTITUTION
    form: ClassVar[str] = " and a table"

    @classmethod
    def faults(cls, stop: Any) -> Iterator[tuple[str, str]]:
        """Columns of unlike length, a table of one point."""
        if stop.speeds and stop.restitutions and len(stop.speeds) != len(stop.restitutions):
            yield "restitutions", f"{len(stop.restitutions)} numbers for {len(stop.speeds)} speeds"
        elif stop.speeds and len(stop.speeds) < 2:
            yield "speeds", "one speed makes no table: write two or more"

    def contact(self, mobility: float) -> TableRestitution:
        """The table."""
        return TableRestitution(self.speeds, self.restitutions)


@dataclass(frozen=True)
class Viscous(ContactLaw):
    """R = 1 − (1 − R₀)(v/v₀)^b, viscoelastic: the slower the impact, the less is lost; b = ⅕ for spheres."""

    restitution: float = declared(RESTITUTION)
    velocity: float = declared(VELOCITY)
    exponent: float | None = declared(EXPONENT, None)

    name: ClassVar[str] = VISCOUS_RESTITUTION

    def contact(self, mobility: float) -> ViscousRestitution:
        """Law of Kuwabara & Kono (1987)."""
        power = 0.2 if self.exponent is None else self.exponent
        return ViscousRestitution.matched(self.restitution, self.velocity, power)
