"""Declaration of the plainest law: one coefficient of restitution at every velocity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from vibeam_models.keys import declared
from vibeam_models.laws import ContactLaw
from vibeam_models.laws.keys import RESTITUTION


@dataclass(frozen=True)
class ConstantRestitution(ContactLaw):
    """v⁺ = −R v⁻: the system's own coefficient, so that the solvers need no law beside it."""

    restitution: float = declared(RESTITUTION)

    name: ClassVar[str] = "restitution"

    def contact(self, mobility: float) -> None:
        """As ``ContactLaw.contact``."""
