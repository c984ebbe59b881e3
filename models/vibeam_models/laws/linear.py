"""Declaration of the linear stop: a spring and a damper."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

from vibeam_models.keys import declared, quantity
from vibeam_models.laws import ContactLaw
from vibeam_models.laws.compliant import LinearStop
from vibeam_models.laws.keys import RESTITUTION


@dataclass(frozen=True)
class Linear(ContactLaw):
    """F = k d + c d′, the damping as given or from the restitution of a free mass 1/S."""

    stiffness: float = quantity(
        "N/m",
        "of law linear: force over penetration",
        "1e6 N/m",
        above=0,
        written=False,
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
        written=False,
        plain=("of a linear stop, force over mass and velocity; absent = what gives the restitution", 2.5, ""),
    )
    restitution: float | None = declared(RESTITUTION, None)

    name: ClassVar[str] = "linear"
    compliant: ClassVar[bool] = True

    @classmethod
    def faults(cls, stop: Any) -> Iterator[tuple[str, str]]:
        """As ``ContactLaw.faults``: the loss, said once."""
        if (stop.damping is None) == (stop.restitution is None):
            said = "is not said" if stop.damping is None else "is said twice"
            yield "damping", f"the loss of the linear stop {said}: write damping, or restitution"
        if stop.restitution == 0:
            yield "restitution", f'0 is more than law = "{cls.name}" can lose: write a number above 0'

    def contact(self, mobility: float) -> LinearStop:
        """As ``ContactLaw.contact``."""
        if self.damping is not None:
            return LinearStop(self.stiffness, self.damping)
        return LinearStop.matched(self.stiffness, 1.0 if self.restitution is None else self.restitution, 1 / mobility)
