"""Consistent systems of units, by name: those of a case's numbers without one, and of other programs' matrices."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal

from vibeam.exchange.units import LENGTH, MASS, TIME


@dataclass(frozen=True)
class UnitSystem:
    """A system by its units of ``length`` in m, ``force`` in N and ``time`` in s; that of mass follows.

    Coordinates stay in their own unit, so that translations and rotations need not be told apart: only energies, and
    the rows that read a displacement, become those of SI.
    """

    length: float = 1.0
    force: float = 1.0
    time: float = 1.0

    @property
    def stiffness(self) -> float:
        """Factor of K: J for one unit of energy."""
        return self.force * self.length

    @property
    def damping(self) -> float:
        """Factor of C: J s."""
        return self.stiffness * self.time

    @property
    def mass(self) -> float:
        """Factor of M: J s²."""
        return self.damping * self.time

    def size(self, dimension: Mapping[str, float]) -> Decimal:
        """SI units in one of the system's, of a quantity of that dimension; volts and radians are in all of them."""
        length, force, time = (Decimal(repr(each)) for each in (self.length, self.force, self.time))
        base = {MASS: force * time**2 / length, LENGTH: length, TIME: time}
        size = Decimal(1)
        for name, unit in base.items():
            size *= unit ** Decimal(repr(dimension.get(name, 0.0)))
        return size


POUND = 4.4482216152605  # N, exactly
SI = UnitSystem()

UNIT_SYSTEMS = {
    "SI": SI,
    "mm N s t": UnitSystem(length=1e-3),
    "mm mN s kg": UnitSystem(length=1e-3, force=1e-3),
    "mm kN ms kg": UnitSystem(length=1e-3, force=1e3, time=1e-3),
    "µm µN s kg": UnitSystem(length=1e-6, force=1e-6),
    "in lbf s": UnitSystem(length=0.0254, force=POUND),
    "ft lbf s": UnitSystem(length=0.3048, force=POUND),
}
