"""Contact stiffness from shape, size and materials of two bodies: sphere, cylinder or flat punch on a flat body.

To the contact both bodies are half-spaces (Johnson, *Contact Mechanics*, Cambridge 1985, chapters 3 and 4), so that it
must be small beside the radius and the thickness of the strip. With E* of both,

    1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂
    sphere       F = 4/3 E* √R d^{3/2}              Hertz; the contact's radius is a = √(R d)
    flat punch   F = 2 E* a d                       of radius a, rigid beside the body that it meets
    cylinder     F = E* l^{8/9} (d/1.36)^{10/9}     Palmgren, *Ball and Roller Bearing Engineering*, 1959

A line contact has no approach of its own, for it grows as the logarithm of the distance at which it is measured.
Palmgren's measured relation of bearing rollers knows no radius; it gives 3.84·10⁻⁵ Q^0.9/l^0.8 for steel in N and mm.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from math import sqrt
from typing import Any, ClassVar

from vibeam_models.keys import quantity, word

SPHERE, CYLINDER, PUNCH = "sphere", "cylinder", "flat punch"
EXPONENTS = {SPHERE: 1.5, CYLINDER: 10 / 9, PUNCH: 1.0}
SIZES = {SPHERE: "radius", CYLINDER: "length", PUNCH: "radius"}  # key of the size that each shape has
EXAMPLES = {"radius": '"5 mm"', "length": '"10 mm"'}


def contact_modulus(one: tuple[float, float], other: tuple[float, float]) -> float:
    """E* in Pa of two bodies, each by its modulus of elasticity in Pa and its Poisson's ratio."""
    return 1 / sum((1 - ratio**2) / modulus for modulus, ratio in (one, other))


def contact_stiffness(shape: str, size: float, modulus: float) -> float:
    """Force over d^p, N/m^p, of a ``shape`` by its ``size`` (m: radius, or length of a cylinder) and E* in Pa."""
    if shape == CYLINDER:
        return float(modulus * size ** (8 / 9) / 1.36 ** (10 / 9))
    return 2 * modulus * size if shape == PUNCH else 4 / 3 * modulus * sqrt(size)


@dataclass(frozen=True, kw_only=True)
class ElasticBodies:
    """Two elastic bodies as keys of a law, in place of its stiffness; ``shapes``: those whose force has its form."""

    shape: str | None = word(
        tuple(SIZES), "of the stop where it is met; absent = sphere; law linear needs flat punch", "sphere", None
    )
    radius: float | None = quantity("m", "of its sphere or flat punch; in place of a stiffness", "5 mm", None, above=0)
    length: float | None = quantity(
        "m",
        "contact length of its cylinder; in place of a stiffness",
        "10 mm",
        None,
        above=0,
    )
    youngs_modulus: float = quantity("Pa", "modulus of elasticity of the stop", "210 GPa", above=0)
    poissons_ratio: float = quantity("", "of the stop", 0.3, least=0, most=0.5)
    counterbody_youngs_modulus: float | None = quantity(
        "Pa", "of what meets the stop; absent = the beam's", "70 GPa", None, above=0
    )
    counterbody_poissons_ratio: float | None = quantity(
        "", "of what meets the stop; absent = the beam's", 0.33, None, least=0, most=0.5
    )

    shapes: ClassVar[tuple[str, ...]] = (SPHERE, CYLINDER)
    form: ClassVar[str] = " by shape and materials"
    of_beam: ClassVar[Mapping[str, str]] = {
        f"counterbody_{name}": name for name in ("youngs_modulus", "poissons_ratio")
    }

    @property
    def body_shape(self) -> str:
        """Shape of the stop."""
        return self.shape or SPHERE

    @property
    def contact_modulus(self) -> float:
        """E* in Pa; ValueError where the body that meets the stop is not known."""
        met = self.counterbody_youngs_modulus, self.counterbody_poissons_ratio
        if met[0] is None or met[1] is None:
            raise ValueError("stop: give counterbody_youngs_modulus and counterbody_poissons_ratio")
        return contact_modulus((self.youngs_modulus, self.poissons_ratio), (met[0], met[1]))

    @property
    def body_stiffness(self) -> float:
        """Force over d^p, N/m^p; ValueError without its size or the body that meets it, or with another law's shape."""
        size = getattr(self, SIZES[self.body_shape])
        if self.body_shape not in self.shapes:
            raise ValueError(f"stop: the force of a {self.body_shape} has another form than this law's")
        if size is None:
            raise ValueError(f"stop: a {self.body_shape} needs its {SIZES[self.body_shape]}")
        return contact_stiffness(self.body_shape, size, self.contact_modulus)

    @classmethod
    def faults(cls, stop: Any) -> Iterator[tuple[str, str]]:
        """(key, message): a shape whose force has another form, its size missing, that of another shape."""
        shape = stop.shape or SPHERE
        if stop.shape is None and SPHERE not in cls.shapes:
            yield "shape", f'missing: write shape = "{cls.shapes[0]}"'
            return
        if shape not in cls.shapes:
            other = '"linear"' if shape == PUNCH else '"hertz", or "hunt-crossley" with a loss'
            yield "shape", f"the force of a {shape} grows as d^{EXPONENTS[shape]:.3g}: write law = {other}"
            return
        size = SIZES[shape]
        if getattr(stop, size) is None:
            yield size, f"missing (of the {shape}): write {size} = {EXAMPLES[size]}"
        for other in {*SIZES.values()} - {size}:
            if getattr(stop, other) is not None:
                yield other, f"does not go with a {shape}: take it out"


KEYS = tuple(each.name for each in fields(ElasticBodies))


def by_bodies(stop: Any) -> bool:
    """Test whether a stop says its shape or its materials; ``stop`` has its values as attributes."""
    return any(getattr(stop, name, None) is not None for name in KEYS)
