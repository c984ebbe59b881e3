"""Static deflection of a bare beam under one load, 1 at a second place: in closed form, or by finite elements."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from vibeam_models.beams.beam import Beam

if TYPE_CHECKING:
    from vibeam_models.arrays import Array
    from vibeam_models.space import BeamSpace
    from vibeam_models.structure import Structure


def static_shape_of(beam: Beam, load_at: float, unit_at: float) -> CantileverShape | FiniteElementShape:
    """φ under a load at ``load_at``, 1 at ``unit_at`` (m): eq. 44 for a uniform cantilever, else by finite elements."""
    kind = CantileverShape if beam.is_uniform_cantilever else FiniteElementShape
    return kind(beam, load_at, unit_at)


@dataclass(frozen=True)
class CantileverShape:
    """Closed form of a uniform cantilever (eq. 44)."""

    beam: Beam
    load_at: float
    unit_at: float

    def at(self, x: float) -> float:
        """φ(x)."""
        return _deflection(x, self.load_at) / _deflection(self.unit_at, self.load_at)

    def slope(self, x: float) -> float:
        """φ'(x) in 1/m."""
        reached = min(x, self.load_at)
        return 3 * reached * (2 * self.load_at - reached) / _deflection(self.unit_at, self.load_at)

    @property
    def stiffness(self) -> float:
        """K_S = 3EI φ(L_m)²/L_m³ (eq. 45)."""
        return 3 * self.beam.bending_stiffness * self.at(self.load_at) ** 2 / self.load_at**3

    def beam_mass(self, carrier: Beam) -> float:
        """∫ρAφ² dx of ``carrier`` in kg: what the beam's own mass adds to M_S."""
        a, rest = self.load_at, self.beam.length - self.load_at
        bent = 33 * a**7 / 35
        straight = a**4 * (4 * a**2 * rest + 6 * a * rest**2 + 3 * rest**3)
        return carrier.mass_per_length * (bent + straight) / _deflection(self.unit_at, self.load_at) ** 2


@dataclass(frozen=True)
class FiniteElementShape:
    """Any beam; the load at a node, so that a piecewise uniform beam's is exact to round-off.

    Within a thousandth of the length of a break the load has no node: its elements would be all round-off.
    """

    beam: Beam
    load_at: float
    unit_at: float

    @property
    def _inserted(self) -> tuple[float, ...]:
        from vibeam_models.space import NEAR

        clear = all(abs(self.load_at - x) >= NEAR * self.beam.length for x in self.beam.breaks)
        return (self.load_at,) if clear else ()

    @cached_property
    def _solved(self) -> tuple[Structure, BeamSpace, Array]:
        from vibeam_models.space import bare_beam

        structure, space = bare_beam(self.beam, self._inserted)
        return structure, space, structure.deflection(space.row(self.load_at))

    def slope(self, x: float) -> float:
        """φ'(x) in 1/m."""
        return self.at(x, 1)

    def at(self, x: float, derivative: int = 0) -> float:
        """φ(x), or φ'(x) in 1/m."""
        _, space, deflection = self._solved
        return float(space.row(x, derivative) @ deflection / (space.row(self.unit_at) @ deflection))

    @property
    def stiffness(self) -> float:
        """K_S = φ(L_m)²/flexibility at the load, N/m."""
        _, space, deflection = self._solved
        return float(self.at(self.load_at) ** 2 / (space.row(self.load_at) @ deflection))

    def beam_mass(self, carrier: Beam) -> float:
        """∫ρAφ² dx of ``carrier`` in kg: what the beam's own mass adds to M_S."""
        from vibeam_models.space import bare_beam

        _, space, deflection = self._solved
        unit = deflection / (space.row(self.unit_at) @ deflection)
        return float(unit @ bare_beam(carrier, self._inserted)[0].M @ unit)


def _deflection(x: float, load_at: float) -> float:
    """6EI/P times the deflection at x: x²(3a − x) up to the load at a, a²(3x − a) beyond."""
    return x**2 * (3 * load_at - x) if x <= load_at else load_at**2 * (3 * x - load_at)
