"""A plate bonded to the beam: it weighs, and stiffens unless a case says not."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from vibeam_models.beams.stretch import Plate
from vibeam_models.beams.tables import NO_OPPOSITE, beam_of, stretch_faults
from vibeam_models.keys import Key, declared, quantity, word
from vibeam_models.scene import OnEitherBeam

if TYPE_CHECKING:
    from vibeam_models.beams.beam import Beam


@dataclass(frozen=True)
class BondedPlate(OnEitherBeam):
    """A plate bonded along a stretch of the beam, one table for each."""

    start: float = quantity("m", "where it begins, from x = 0", "90 mm", least=0)
    end: float = quantity("m", "where it ends", "130 mm", above=0)
    width: float = quantity("m", "width of the plate", "20 mm", above=0)
    thickness: float = quantity("m", "thickness of the plate", "1 mm", above=0)
    mass: float | None = quantity("kg", "of the plate, or of both; or say its density", "40 g", None, above=0)
    density: float | None = quantity("kg/m^3", "instead of its mass", "7850 kg/m^3", None, above=0, written=False)
    youngs_modulus: float | None = quantity(
        "Pa", "modulus of elasticity; absent = the beam's", "70 GPa", None, above=0, written=False
    )
    sides: Literal["one", "both"] = word(("one", "both"), "where it is", "one", "one")
    stiffens: bool = declared(
        Key("it bends with the beam as one section; false: it only weighs", True, flag=True), True
    )

    name: ClassVar[str] = "plate"
    shapes_beam: ClassVar[bool] = True

    @classmethod
    def faults(cls, table: Any, case: Any) -> Iterator[tuple[str, str]]:
        """As ``Effect.faults``: a stretch off the beam, weight said twice or not at all, a section without a height."""
        carrier = beam_of(table, case)
        if carrier is None:
            yield NO_OPPOSITE
            return
        yield from stretch_faults(table, carrier)
        if table.mass is not None and table.density is not None:
            yield "mass", "density says it already: keep one of the two"
        elif table.mass is None and table.density is None:
            yield "mass", 'missing (or density): write mass = "40 g"'
        if table.stiffens and "general" in (carrier.shape, *(each.shape for each in case.section)):
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
