"""Contact laws: the mechanics of restitution laws and compliant stops, and their declarations, one a file."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from vibeam_models.registry import Home, Registry

if TYPE_CHECKING:
    from vibeam_models.laws.compliant import CompliantStop
    from vibeam_models.laws.restitution import VelocityRestitution

#: by ``law`` of a case's stop
LAWS: Registry[Home] = Registry(
    "contact law",
    Home("restitution", "vibeam_models.laws.constant_restitution:ConstantRestitution"),
    Home("velocity restitution", "vibeam_models.laws.velocity_restitution:VelocityDependent"),
    Home("linear", "vibeam_models.laws.linear:Linear"),
    Home("leaf spring", "vibeam_models.laws.leaf_spring:LeafSpring"),
    Home("hertz", "vibeam_models.laws.hertz:Elastic"),
    Home("hunt-crossley", "vibeam_models.laws.hertz:Damped"),
)

CONSTANT = "restitution"  # the law of a stop that names none


def declarations() -> dict[str, type[ContactLaw]]:
    """Every law that is registered."""
    return {name: home.load() for name, home in LAWS.items()}


@dataclass(frozen=True)
class ContactLaw(ABC):
    """A law by its keys in ``[stop]``: those fields without default are needed, the others may be absent.

    ``compliant``: the stop yields; else it is rigid and the velocity after an impact follows from that before it.
    ``form``: what a message adds where the law has several forms.
    """

    name: ClassVar[str]
    compliant: ClassVar[bool] = False
    form: ClassVar[str] = ""

    @classmethod
    def forms(cls) -> tuple[type[ContactLaw], ...]:
        """The ways in which the law can be said, each with its own keys: mostly one."""
        return (cls,)

    @classmethod
    def form_of(cls, stop: Any) -> type[ContactLaw]:
        """Form that a stop says; ``stop`` has its values as attributes, None what is absent or cannot be read."""
        return cls

    @classmethod
    def faults(cls, stop: Any) -> Iterator[tuple[str, str]]:
        """(key, message) of what does not go together; ``stop`` as in ``form_of``."""
        yield from ()

    @abstractmethod
    def contact(self, mobility: float) -> VelocityRestitution | CompliantStop | None:
        """Law for the solvers in a model of contact ``mobility`` S = w M⁻¹ wᵀ (1/kg); None: the plain R alone."""
