"""Restitution held equal in all fidelities of a comparison: the contact's, or that which mode 1 sees."""

from __future__ import annotations

from dataclasses import dataclass, replace

from vibeam.system.number_text import ratio
from vibeam_models.scene import AnyScene

SYMBOLS = {"contact": "R", "first mode": "R₁"}
PLACES = {"contact": "at the contact", "first mode": "of mode 1"}


@dataclass(frozen=True)
class Held:
    """Held restitution: ``restitution_of`` as in the case file; ``coefficient`` None where the ``law`` has no one.

    ``restitution_of`` is empty for a single degree of freedom given directly, where contact and mode 1 are one.
    """

    restitution_of: str
    coefficient: float | None
    law: str = ""

    @property
    def label(self) -> str:
        """The held coefficient in words, as ``R = 0.72 at the contact``."""
        if self.coefficient is None:
            return f'contact law "{self.law}"'
        return f"{self.symbol} = {ratio(self.coefficient, 'g')} {PLACES.get(self.restitution_of, '')}".rstrip()

    @property
    def symbol(self) -> str:
        """R or R₁."""
        return SYMBOLS.get(self.restitution_of, "R")


def other_choice(held: Held) -> Held | None:
    """The other choice with the same coefficient; None where there is none."""
    if held.coefficient is None or not held.restitution_of:
        return None
    return replace(held, restitution_of="first mode" if held.restitution_of == "contact" else "contact")


def held_of(scene: AnyScene) -> Held:
    """Restitution that a scene holds, whatever the fidelity."""
    law = None if scene.stop is None else scene.stop.law
    return Held(*scene.held) if law is None else Held("", None, law.name)
