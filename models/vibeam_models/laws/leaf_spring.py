"""Declaration of a leaf spring as the stop: a massless cantilever whose tip is met."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

from vibeam_models.keys import declared, quantity
from vibeam_models.laws import ContactLaw
from vibeam_models.laws.compliant import LinearStop
from vibeam_models.laws.keys import RESTITUTION
from vibeam_models.laws.linear import Linear


@dataclass(frozen=True)
class LeafSpring(ContactLaw):
    """The linear stop of stiffness 3EI/l³ = E b t³/4l³, static: its own modes must lie far above the drive."""

    leaf_length: float = quantity("m", "of law leaf spring: free length", "57 mm", above=0, written=False)
    leaf_width: float = quantity("m", "of law leaf spring", "40 mm", above=0, written=False)
    leaf_thickness: float = quantity("m", "of law leaf spring, along the motion", "1 mm", above=0, written=False)
    leaf_modulus: float = quantity("Pa", "of law leaf spring: modulus of elasticity", "210 GPa", above=0, written=False)
    damping: float | None = declared(Linear.__dataclass_fields__["damping"].metadata["key"], None)
    restitution: float | None = declared(RESTITUTION, None)

    name: ClassVar[str] = "leaf spring"
    compliant: ClassVar[bool] = True

    @classmethod
    def faults(cls, stop: Any) -> Iterator[tuple[str, str]]:
        """As those of the linear stop."""
        yield from Linear.faults(stop)

    @property
    def stiffness(self) -> float:
        """E b t³/4l³ in N/m."""
        return self.leaf_modulus * self.leaf_width * self.leaf_thickness**3 / (4 * self.leaf_length**3)

    def contact(self, mobility: float) -> LinearStop:
        """As that of the linear stop."""
        return Linear(self.stiffness, self.damping, self.restitution).contact(mobility)
