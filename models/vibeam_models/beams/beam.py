"""Beam: what carries mass, stop and sensor, as frozen data in SI units."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.beams.shapes import Shape
from vibeam_models.beams.stretch import Material, Plate, Stretch
from vibeam_models.beams.support import CANTILEVER, Support, end_supports

POINTS, WEIGHTS = np.polynomial.legendre.leggauss(8)  # exact for every linear taper


@dataclass(frozen=True)
class Damping:
    """Damping of the beam by modal ratios.

    ``kind``: ``"constant"`` (every mode has ratios[0]), ``"stiffness"`` (C = D K, mode 1 has ratios[0]: the paper's),
    ``"rayleigh"`` (C = αM + DK, modes 1 and 2 have ratios[0] and ratios[1]) or ``"list"`` (mode i has ratios[i], every
    further mode the last one).
    """

    kind: Literal["constant", "stiffness", "rayleigh", "list"]
    ratios: tuple[float, ...]


@dataclass(frozen=True)
class Beam:
    """A beam along x: lengths in m, modulus in Pa, density in kg/m³; its own section where no other is named.

    ``added_mass_per_length``: what it carries all along without being stiffened, kg/m. ``ends``: at x = 0 and at its
    length, one of ``PAIRS``. ``supports``: further ones. ``sections``: stretches with another section, which do not
    overlap. ``plates``: bonded to it. ``poissons_ratio``: needed where ``shear`` is to be seen: Timoshenko's beam.
    """

    length: float
    shape: Shape
    youngs_modulus: float
    density: float
    damping: Damping
    elements: int = 36
    added_mass_per_length: float = 0.0
    ends: str = CANTILEVER
    poissons_ratio: float | None = None
    shear: bool = False
    sections: tuple[Stretch, ...] = ()
    plates: tuple[Plate, ...] = ()
    supports: tuple[Support, ...] = ()

    @property
    def material(self) -> Material:
        """Its own material."""
        return Material(self.youngs_modulus, self.density, self.poissons_ratio)

    @property
    def is_uniform(self) -> bool:
        """Whether its own section is all there is of it."""
        return not (self.sections or self.plates)

    @property
    def is_uniform_cantilever(self) -> bool:
        """Whether the closed forms of a uniform cantilever hold."""
        return self.is_uniform and self.ends == CANTILEVER and not self.supports and not self.shear

    @property
    def bending_stiffness(self) -> float:
        """EI of its own section, N m²."""
        return float(self.shape.second_moment_times(self.youngs_modulus))

    @property
    def mass_per_length(self) -> float:
        """ρA of its own section with what is added all along, kg/m."""
        return float(self.shape.area_times(self.density) + self.added_mass_per_length)

    @property
    def held(self) -> tuple[Support, ...]:
        """Supports at the ends, and all others."""
        return (*end_supports(self.ends, self.length), *self.supports)

    @property
    def mass(self) -> float:
        """kg: of the beam with what belongs to it."""
        return self.mass_per_length * self.length if self.is_uniform else float(self.mass_beyond(np.array(0.0)))

    def mass_beyond(self, x: Array) -> Array:
        """Mass (shape of ``x``) of the beam beyond ``x`` m, kg."""
        if self.is_uniform:
            return np.asarray(self.mass_per_length * (self.length - x))
        total = np.zeros(np.shape(x))
        for piece in self.stretches:
            start = np.clip(x, piece.start, piece.end)
            half = (piece.end - start) / 2
            places = start[..., None] + half[..., None] * (1 + POINTS)
            total = total + half * (piece.mass_per_length(places) @ WEIGHTS)
        return total

    @property
    def breaks(self) -> tuple[float, ...]:
        """Places (m) where the section or the support changes, ascending, its ends among them."""
        parts: tuple[Stretch | Plate, ...] = (*self.sections, *self.plates)
        places = {0.0, self.length, *(x for part in parts for x in (part.start, part.end))}
        return tuple(sorted(places | {each.position for each in self.supports}))

    @property
    def stretches(self) -> tuple[Stretch, ...]:
        """The whole beam as stretches between its breaks."""
        return tuple(self._stretch(start, end) for start, end in pairwise(self.breaks))

    def _stretch(self, start: float, end: float) -> Stretch:
        middle = (start + end) / 2
        own = Stretch(start, end, self.shape, self.material, added=self.added_mass_per_length)
        there = next((each for each in self.sections if each.start <= middle <= each.end), own)
        plates = tuple(each for each in self.plates if each.start <= middle <= each.end)
        return replace(there.between(start, end), plates=plates)

    def along(self, quantity: Callable[[Stretch, Array], Array], x: Array) -> Array:
        """A quantity of a stretch (``Stretch.bending_stiffness``, say) at ``x`` (any shape) m, inside stretches."""
        found = np.zeros(np.shape(x))
        for piece in self.stretches:
            here = (x >= piece.start) & (x <= piece.end)
            found[here] = quantity(piece, x[here])
        return found

    def massless(self) -> Beam:
        """The same without mass of its own."""
        return replace(
            self,
            density=0.0,
            added_mass_per_length=0.0,
            sections=tuple(each.massless() for each in self.sections),
            plates=tuple(replace(each, density=0.0) for each in self.plates),
        )
