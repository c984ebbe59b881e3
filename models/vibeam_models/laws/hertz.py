"""Declarations of Hertz's law, elastic, and of Hunt and Crossley's, which is damped."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

from vibeam_models.keys import declared
from vibeam_models.laws import ContactLaw
from vibeam_models.laws.compliant import Hertz, HuntCrossley
from vibeam_models.laws.keys import EXPONENT, HERTZ_STIFFNESS, RESTITUTION, VELOCITY


def _soft(stop: Any) -> Iterator[tuple[str, str]]:
    if stop.exponent is not None and stop.exponent < 1:
        yield "exponent", f"{stop.exponent:g} is below 1: the stop would be infinitely stiff at first touch"


@dataclass(frozen=True)
class Elastic(ContactLaw):
    """F = k d^p."""

    hertz_stiffness: float = declared(HERTZ_STIFFNESS)
    exponent: float | None = declared(EXPONENT, None)

    name: ClassVar[str] = "hertz"
    compliant: ClassVar[bool] = True

    @classmethod
    def faults(cls, stop: Any) -> Iterator[tuple[str, str]]:
        """As ``ContactLaw.faults``: an exponent below 1."""
        yield from _soft(stop)

    def contact(self, mobility: float) -> HuntCrossley:
        """As ``ContactLaw.contact``."""
        return Hertz(self.hertz_stiffness, 1.5 if self.exponent is None else self.exponent)


@dataclass(frozen=True)
class Damped(ContactLaw):
    """F = k d^p (1 + a d′), a from the restitution at one velocity."""

    hertz_stiffness: float = declared(HERTZ_STIFFNESS)
    restitution: float = declared(RESTITUTION)
    velocity: float = declared(VELOCITY)
    exponent: float | None = declared(EXPONENT, None)

    name: ClassVar[str] = "hunt-crossley"
    compliant: ClassVar[bool] = True

    @classmethod
    def faults(cls, stop: Any) -> Iterator[tuple[str, str]]:
        """As ``ContactLaw.faults``: a loss that no damping gives, an exponent below 1."""
        if stop.restitution == 0:
            yield "restitution", f'0 is more than law = "{cls.name}" can lose: write a number above 0'
        yield from _soft(stop)

    def contact(self, mobility: float) -> HuntCrossley:
        """As ``ContactLaw.contact``."""
        power = 1.5 if self.exponent is None else self.exponent
        return HuntCrossley.matched(self.hertz_stiffness, self.restitution, self.velocity, power)
