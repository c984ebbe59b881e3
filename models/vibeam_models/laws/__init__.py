"""Contact laws: the registry, what a declaration says of its law, and the keys of ``[stop]`` that several laws share.

Declarations are in ``rigid`` and ``yielding``; the mechanics that they give the solvers in ``restitution`` and
``compliant``, with what a law can be asked for in ``mechanics``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from vibeam_models.keys import Key
from vibeam_models.registry import Home, Registry

if TYPE_CHECKING:
    from vibeam_models.laws.mechanics import StopLaw

#: by ``law`` of a case's stop
LAWS: Registry[Home] = Registry(
    "contact law",
    Home("restitution", "vibeam_models.laws.rigid:ConstantRestitution"),
    Home("velocity restitution", "vibeam_models.laws.rigid:VelocityDependent"),
    Home("viscous restitution", "vibeam_models.laws.rigid:Viscous"),
    Home("linear", "vibeam_models.laws.yielding:Linear"),
    Home("hertz", "vibeam_models.laws.yielding:Elastic"),
    Home("hunt-crossley", "vibeam_models.laws.yielding:Damped"),
)

CONSTANT = "restitution"  # the law of a stop that names none

RESTITUTION = Key("speed after over speed before an impact", 0.72, least=0, most=1, plain=("", 0.9, ""))

HERTZ_STIFFNESS = Key(
    "of laws hertz and hunt-crossley: force over penetration^exponent, in N/m^exponent",
    1e9,
    above=0,
    missing="N/m^exponent, or radius, youngs_modulus and poissons_ratio of the stop",
    plain=(
        "of hertz and hunt-crossley, force over mass and penetration^exponent",
        1e4,
        "force over mass and penetration^exponent",
    ),
)

EXPONENT = Key(
    "of the penetration, absent = 1.5; in velocity restitution the n of R = R0 (v/v0)^-n, absent = 0.25; in viscous "
    "restitution the b of R = 1 - (1 - R0) (v/v0)^b, absent = 0.2",
    1.5,
    above=0,
    plain=(
        "of the penetration, absent = 1.5; of the velocity in R = R0 (v/v0)^-n, absent = 0.25, or in "
        "R = 1 - (1 - R0) (v/v0)^b, absent = 0.2",
        1.5,
        "",
    ),
)

VELOCITY = Key(
    "of impact, v0, at which the restitution holds; for laws hunt-crossley, velocity and viscous restitution",
    "0.1 m/s",
    "m/s",
    above=0,
    missing="at which the restitution holds",
    plain=(
        "at which the restitution holds, for hunt-crossley, velocity and viscous restitution",
        0.01,
        "at which the restitution holds",
    ),
)


def declarations() -> dict[str, type[ContactLaw]]:
    """Every law that is registered."""
    return {name: home.load() for name, home in LAWS.items()}


@dataclass(frozen=True)
class ContactLaw(ABC):
    """A law by its keys in ``[stop]``: those fields without default are needed, the others may be absent.

    ``compliant``: the stop yields; else it is rigid and the velocity after an impact follows from that before it.
    ``integrated``: its contacts have no closed form, so that no velocity or acceleration is read in them.
    ``form``: what a message adds where the law has several forms. ``of_beam``: its key → key of the beam that stands
    for it where it is absent.
    """

    name: ClassVar[str]
    compliant: ClassVar[bool] = False
    integrated: ClassVar[bool] = False
    form: ClassVar[str] = ""
    of_beam: ClassVar[Mapping[str, str]] = {}

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
    def contact(self, mobility: float) -> StopLaw:
        """Mechanics for the solvers in a model of contact ``mobility`` S = w M⁻¹ wᵀ (1/kg)."""
