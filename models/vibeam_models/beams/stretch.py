"""Stretch: part of a beam whose section is constant or tapers linearly; Plate: what is bonded to it there."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.beams.shapes import Shape


@dataclass(frozen=True)
class Material:
    """``youngs_modulus`` in Pa, ``density`` in kg/m³, Poisson's ratio (None: not known)."""

    youngs_modulus: float
    density: float
    poissons_ratio: float | None = None

    @property
    def shear_modulus(self) -> float:
        """G = E/2(1 + ν) in Pa; ValueError without Poisson's ratio."""
        if self.poissons_ratio is None:
            raise ValueError("beam: shear needs Poisson's ratio")
        return self.youngs_modulus / (2 * (1 + self.poissons_ratio))


@dataclass(frozen=True)
class Plate:
    """A plate bonded along ``start`` … ``end`` m: (b × t) in m, on one side or on both.

    ``stiffens``: it bends with the beam as one composite section; else it only weighs.
    """

    start: float
    end: float
    width: float
    thickness: float
    youngs_modulus: float
    density: float
    sides: int = 1
    stiffens: bool = True

    @property
    def mass_per_length(self) -> float:
        """kg/m, of all sides."""
        return self.sides * self.density * self.width * self.thickness

    def rigidity(self, height: Any, axial: Any) -> Any:
        """Addition to EI (N m²) of a beam of ``height`` m with EA = ``axial`` N, their strains linear across both.

        Parallel axes about the common neutral axis: with e = (h + t)/2 from the beam's axis to the plate's, one plate
        adds E'I' + EA E'A'/(EA + E'A') e², one on each side 2(E'I' + E'A' e²).
        """
        own = self.youngs_modulus * self.width * self.thickness
        offset = ((height + self.thickness) / 2) ** 2
        shared = own if self.sides == 2 else axial * own / (axial + own)
        return self.sides * (own * self.thickness**2 / 12 + shared * offset)


@dataclass(frozen=True)
class Stretch:
    """``start`` … ``end`` m of a beam: its section ``shape``, that at its end where it tapers (``far``), its material.

    ``added``: mass per length that does not stiffen, kg/m. ``plates`` cover all of it.
    """

    start: float
    end: float
    shape: Shape
    material: Material
    far: Shape | None = None
    added: float = 0.0
    plates: tuple[Plate, ...] = ()

    def section(self, x: Array) -> Shape:
        """The section at ``x`` (any shape) m."""
        if self.far is None:
            return self.shape
        return self.shape.between(self.far, (x - self.start) / (self.end - self.start))

    def bending_stiffness(self, x: Array) -> Array:
        """EI at ``x`` m, N m²: with its plates."""
        section, modulus = self.section(x), self.material.youngs_modulus
        own = section.second_moment_times(modulus)
        stiff = [plate for plate in self.plates if plate.stiffens]
        return _at(x, own + sum(plate.rigidity(section.height, section.area_times(modulus)) for plate in stiff))

    def mass_per_length(self, x: Array) -> Array:
        """ρA at ``x`` m with all that is added, kg/m."""
        own = self.section(x).area_times(self.material.density)
        return _at(x, own + self.added + sum(plate.mass_per_length for plate in self.plates))

    def shear_stiffness(self, x: Array) -> Array:
        """κGA at ``x`` m, N; ValueError where the shape or Poisson's ratio does not say it."""
        area = self.section(x).sheared_area(self.material.poissons_ratio or 0.0)
        if area is None:
            raise ValueError(f'beam: shear needs the shear_area of shape = "{self.shape.name}"')
        return _at(x, self.material.shear_modulus * area)

    def rotary_inertia(self, x: Array) -> Array:
        """ρI at ``x`` m, kg m: of the beam's own section."""
        return _at(x, self.section(x).second_moment_times(self.material.density))

    def massless(self) -> Stretch:
        """The same without mass."""
        plates = tuple(replace(plate, density=0.0) for plate in self.plates)
        return replace(self, material=replace(self.material, density=0.0), added=0.0, plates=plates)

    def between(self, start: float, end: float) -> Stretch:
        """The part from ``start`` to ``end`` m."""
        if self.far is None:
            return replace(self, start=start, end=end)
        ends = [self.section(np.array(x)) for x in (start, end)]
        return replace(self, start=start, end=end, shape=ends[0], far=ends[1])


def _at(x: Array, value: Any) -> Array:
    return np.broadcast_to(np.asarray(value, dtype=float), np.shape(x))
