"""Declarations of the laws of a stop that yields: linear, Hertz's, Hunt and Crossley's."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

from vibeam_models.keys import declared, quantity
from vibeam_models.laws import EXPONENT, HERTZ_STIFFNESS, RESTITUTION, VELOCITY, ContactLaw
from vibeam_models.laws.compliant import Hertz, HuntCrossley, LinearStop
from vibeam_models.laws.hertz import EXPONENTS, PUNCH, ElasticBodies, by_bodies


def _lost(law: str, stop: Any) -> Iterator[tuple[str, str]]:
    if stop.restitution == 0:
        yield "restitution", f'0 is more than law = "{law}" can lose: write a number above 0'


class Yielding(ContactLaw):
    """A law of a stop that yields, by its stiffness or by two bodies that give it; ``by_shape``: the latter."""

    compliant: ClassVar[bool] = True
    by_shape: ClassVar[type[ContactLaw] | None] = None

    @classmethod
    def forms(cls) -> tuple[type[ContactLaw], ...]:
        """The stiffness, and the bodies."""
        return (cls,) if cls.by_shape is None else (cls, cls.by_shape)

    @classmethod
    def form_of(cls, stop: Any) -> type[ContactLaw]:
        """The bodies where the stop says its shape or materials, else the stiffness."""
        return cls.by_shape if cls.by_shape and by_bodies(stop) else cls


@dataclass(frozen=True)
class Linear(Yielding):
    """F = k d + c d′, the damping as given or from the restitution of a free mass 1/S."""

    stiffness: float = quantity(
        "N/m",
        "of law linear: force over penetration",
        "1e6 N/m",
        above=0,
        missing="force over penetration",
        plain=("of a linear stop: force over mass and penetration", 400, "force over mass and penetration"),
    )
    damping: float | None = quantity(
        "N s/m",
        "of law linear: force over velocity; absent = what gives the restitution to a free mass 1/S, S the contact's "
        "mobility",
        "10 N s/m",
        None,
        least=0,
        plain=("of a linear stop, force over mass and velocity; absent = what gives the restitution", 2.5, ""),
    )
    restitution: float | None = declared(RESTITUTION, None)

    name: ClassVar[str] = "linear"

    @classmethod
    def faults(cls, stop: Any) -> Iterator[tuple[str, str]]:
        """The loss, said once."""
        if (stop.damping is None) == (stop.restitution is None):
            said = "is not said" if stop.damping is None else "is said twice"
            yield "damping", f"the loss of the linear stop {said}: write damping, or restitution"
        yield from _lost(cls.name, stop)

    def contact(self, mobility: float) -> LinearStop:
        """The stop with the damping, or with what gives a free mass 1/S the restitution."""
        if self.damping is not None:
            return LinearStop(self.stiffness, self.damping)
        return LinearStop.matched(self.stiffness, 1.0 if self.restitution is None else self.restitution, 1 / mobility)


@dataclass(frozen=True)
class LinearBodies(ElasticBodies, Yielding):
    """F = 2 E* a d + c d′: a flat punch of radius a."""

    damping: float | None = declared(Linear.__dataclass_fields__["damping"].metadata["key"], None)
    restitution: float | None = declared(RESTITUTION, None)

    name: ClassVar[str] = "linear"
    shapes: ClassVar[tuple[str, ...]] = (PUNCH,)

    @classmethod
    def faults(cls, stop: Any) -> Iterator[tuple[str, str]]:
        """The loss, said once; another shape, a radius missing."""
        yield from Linear.faults(stop)
        yield from super().faults(stop)

    def contact(self, mobility: float) -> LinearStop:
        """The linear stop of that stiffness."""
        return Linear(self.body_stiffness, self.damping, self.restitution).contact(mobility)


@dataclass(frozen=True)
class Elastic(Yielding):
    """F = k d^p."""

    hertz_stiffness: float = declared(HERTZ_STIFFNESS)
    exponent: float | None = declared(EXPONENT, None)

    name: ClassVar[str] = "hertz"
    integrated: ClassVar[bool] = True

    @classmethod
    def faults(cls, stop: Any) -> Iterator[tuple[str, str]]:
        """An exponent below 1."""
        if stop.exponent is not None and stop.exponent < 1:
            yield "exponent", f"{stop.exponent:g} is below 1: the stop would be infinitely stiff at first touch"

    def contact(self, mobility: float) -> HuntCrossley:
        """Hertz's law, p = 3/2 where it is not said."""
        return Hertz(self.hertz_stiffness, 1.5 if self.exponent is None else self.exponent)


@dataclass(frozen=True)
class ElasticContact(ElasticBodies, Yielding):
    """F = k d^p with k and p of two bodies: p = 3/2 for a sphere."""

    name: ClassVar[str] = "hertz"
    integrated: ClassVar[bool] = True

    def contact(self, mobility: float) -> HuntCrossley:
        """Hertz's law for the sphere, Palmgren's relation for the cylinder."""
        return Hertz(self.body_stiffness, EXPONENTS[self.body_shape])


@dataclass(frozen=True)
class Damped(Yielding):
    """F = k d^p (1 + a d′), a from the restitution at one velocity."""

    hertz_stiffness: float = declared(HERTZ_STIFFNESS)
    restitution: float = declared(RESTITUTION)
    velocity: float = declared(VELOCITY)
    exponent: float | None = declared(EXPONENT, None)

    name: ClassVar[str] = "hunt-crossley"
    integrated: ClassVar[bool] = True

    @classmethod
    def faults(cls, stop: Any) -> Iterator[tuple[str, str]]:
        """A loss that no damping gives, an exponent below 1."""
        yield from _lost(cls.name, stop)
        yield from Elastic.faults(stop)

    def contact(self, mobility: float) -> HuntCrossley:
        """Law with the damping that gives the restitution at that velocity."""
        power = 1.5 if self.exponent is None else self.exponent
        return HuntCrossley.matched(self.hertz_stiffness, self.restitution, self.velocity, power)


@dataclass(frozen=True)
class DampedContact(ElasticBodies, Yielding):
    """F = k d^p (1 + a d′) with k and p of two bodies, a from the restitution at one velocity."""

    restitution: float = declared(RESTITUTION)
    velocity: float = declared(VELOCITY)

    name: ClassVar[str] = "hunt-crossley"
    integrated: ClassVar[bool] = True

    @classmethod
    def faults(cls, stop: Any) -> Iterator[tuple[str, str]]:
        """A loss that no damping gives; another shape, a size missing."""
        yield from _lost(cls.name, stop)
        yield from super().faults(stop)

    def contact(self, mobility: float) -> HuntCrossley:
        """Law with the damping that gives the restitution at that velocity."""
        return HuntCrossley.matched(self.body_stiffness, self.restitution, self.velocity, EXPONENTS[self.body_shape])


Linear.by_shape, Elastic.by_shape, Damped.by_shape = LinearBodies, ElasticContact, DampedContact
