"""Sections of the beam: a stretch of another, a bonded plate, mass carried all along, shear of them all."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal

from vibeam_models.beams.beam import Beam
from vibeam_models.beams.shapes import SHAPES
from vibeam_models.beams.stretch import Material, Plate, Stretch
from vibeam_models.beams.tables import beam_of, dimension, dimension_faults, shape_of, stretch_faults
from vibeam_models.keys import Key, declared, keys_of, quantity, word
from vibeam_models.scene import Effect, OnEitherBeam


@dataclass(frozen=True)
class Section(OnEitherBeam):
    """A stretch with another section or material, one table for each; what is absent is as in [beam]."""

    start: float = quantity("m", "where it begins, from x = 0", "0 mm", least=0)
    end: float = quantity("m", "where it ends", "60 mm", above=0)
    shape: str | None = word(tuple(SHAPES), "shape of the section", "tube", None)
    width: float | None = dimension("rectangle", "width")
    thickness: float | None = dimension("rectangle", "thickness")
    diameter: float | None = dimension("round", "diameter")
    outer_diameter: float | None = dimension("tube", "outer_diameter")
    wall: float | None = dimension("tube", "wall")
    web: float | None = dimension("I", "web")
    flange: float | None = dimension("I", "flange")
    area: float | None = dimension("general", "area")
    second_moment: float | None = dimension("general", "second_moment")
    shear_area: float | None = dimension("general", "shear_area")
    end_width: float | None = dimension("rectangle", "width", "end")
    end_thickness: float | None = dimension("rectangle", "thickness", "end")
    end_diameter: float | None = dimension("round", "diameter", "end")
    end_outer_diameter: float | None = dimension("tube", "outer_diameter", "end")
    end_wall: float | None = dimension("tube", "wall", "end")
    youngs_modulus: float | None = quantity("Pa", "modulus of elasticity", "70 GPa", None, above=0)
    density: float | None = quantity("kg/m^3", "mass per volume", "2700 kg/m^3", None, above=0)
    added_mass_per_length: float | None = quantity(
        "kg/m", "carried along without stiffening: a fluid, a cladding", "0.1 kg/m", None, least=0
    )

    name: ClassVar[str] = "section"
    shapes_beam: ClassVar[bool] = True

    @classmethod
    def faults(cls, table: Any, case: Any) -> Iterator[tuple[str, str]]:
        """As ``Effect.faults``: a stretch off the beam or over another, dimensions missing or of other shapes."""
        yield from stretch_faults(table, case)
        yield from _overlap(table, case)
        if (carrier := beam_of(table, case)) is not None:
            yield from dimension_faults(table, carrier)

    def carrier(self, beam: Beam) -> Beam:
        """The beam with this stretch."""
        material = Material(
            self.youngs_modulus or beam.youngs_modulus, self.density or beam.density, beam.poissons_ratio
        )
        near = shape_of(self, beam.shape)
        ends = {name: getattr(self, f"end_{name}", None) for name in keys_of(type(near))}
        tapered = {name: value for name, value in ends.items() if value is not None}
        far = replace(near, **tapered) if tapered else None
        added = beam.added_mass_per_length if self.added_mass_per_length is None else self.added_mass_per_length
        return replace(beam, sections=(*beam.sections, Stretch(self.start, self.end, near, material, far, added)))


def _overlap(table: Any, case: Any) -> Iterator[tuple[str, str]]:
    for other in case.section:
        if other is table:
            return
        places = (table.start, table.end, other.start, other.end)
        if other.on == table.on and None not in places and table.start < other.end and other.start < table.end:
            yield "start", f"the stretch overlaps that from {other.start:g} m to {other.end:g} m: let them meet"


@dataclass(frozen=True)
class BondedPlate(OnEitherBeam):
    """A plate bonded along a stretch of the beam, one table for each."""

    start: float = quantity("m", "where it begins, from x = 0", "90 mm", least=0)
    end: float = quantity("m", "where it ends", "130 mm", above=0)
    width: float = quantity("m", "width of the plate", "20 mm", above=0)
    thickness: float = quantity("m", "thickness of the plate", "1 mm", above=0)
    mass: float | None = quantity("kg", "of the plate, or of both; or say its density", "40 g", None, above=0)
    density: float | None = quantity("kg/m^3", "instead of its mass", "7850 kg/m^3", None, above=0)
    youngs_modulus: float | None = quantity("Pa", "modulus of elasticity; absent = the beam's", "70 GPa", None, above=0)
    sides: Literal["one", "both"] = word(("one", "both"), "where it is", "one", "one")
    stiffens: bool = declared(
        Key("it bends with the beam as one section; false: it only weighs", True, flag=True), True
    )

    name: ClassVar[str] = "plate"
    shapes_beam: ClassVar[bool] = True

    @classmethod
    def faults(cls, table: Any, case: Any) -> Iterator[tuple[str, str]]:
        """As ``Effect.faults``: a stretch off the beam, weight said twice or not at all, a section without a height."""
        yield from stretch_faults(table, case)
        if table.mass is not None and table.density is not None:
            yield "mass", "density says it already: keep one of the two"
        elif table.mass is None and table.density is None:
            yield "mass", 'missing (or density): write mass = "40 g"'
        shape = getattr(beam_of(table, case), "shape", None)
        if table.stiffens and "general" in (shape, *(each.shape for each in case.section)):
            yield "stiffens", 'shape = "general" has no height to bond it at: write stiffens = false'
        if case.beam.massless:
            yield "", "weighs along the beam, which beam.massless neglects: take one of the two out"

    def carrier(self, beam: Beam) -> Beam:
        """The beam with this plate."""
        sides = 2 if self.sides == "both" else 1
        volume = sides * self.width * self.thickness * (self.end - self.start)
        density = (self.mass or 0.0) / volume if self.density is None else self.density
        modulus = self.youngs_modulus or beam.youngs_modulus
        plate = Plate(self.start, self.end, self.width, self.thickness, modulus, density, sides, self.stiffens)
        return replace(beam, plates=(*beam.plates, plate))


@dataclass(frozen=True)
class AddedMassPerLength(Effect):
    """Mass carried all along without stiffening, kg/m: a fluid, a cladding."""

    added_mass_per_length: float

    name: ClassVar[str] = "beam.added_mass_per_length"
    shapes_beam: ClassVar[bool] = True

    def carrier(self, beam: Beam) -> Beam:
        """The beam with this mass."""
        return replace(beam, added_mass_per_length=self.added_mass_per_length)


@dataclass(frozen=True)
class Theory(Effect):
    """Timoshenko's beam: shear deformation and the rotary inertia of the section."""

    theory: str

    name: ClassVar[str] = "beam.theory"
    modes_per_element: ClassVar[int] = 3
    shapes_beam: ClassVar[bool] = True

    @classmethod
    def faults(cls, table: Any, case: Any) -> Iterator[tuple[str, str]]:
        """As ``Effect.faults``: no Poisson's ratio, a section that does not say its shear area."""
        if table.poissons_ratio is None:
            yield "poissons_ratio", f'missing (theory = "{table.theory}" needs it): write poissons_ratio = 0.3'
        if table.shape == "general" and table.shear_area is None:
            yield "shear_area", f'missing (theory = "{table.theory}" needs it): write shear_area = "16 mm^2"'

    def carrier(self, beam: Beam) -> Beam:
        """The beam with shear."""
        return replace(beam, shear=True)
