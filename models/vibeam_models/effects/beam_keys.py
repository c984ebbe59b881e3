"""Keys of [beam] that change the beam itself: its ends, mass that it carries all along, its theory."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

from vibeam_models.beams.tables import rigid_body_faults
from vibeam_models.scene import Effect

if TYPE_CHECKING:
    from vibeam_models.beams.beam import Beam


@dataclass(frozen=True)
class BeamEnds(Effect):
    """Ends of the beam, at x = 0 and at the full length: how they are held, one of ``beams.beam.PAIRS``."""

    ends: str

    name: ClassVar[str] = "beam.ends"
    shapes_beam: ClassVar[bool] = True

    @classmethod
    def faults(cls, table: Any, case: Any) -> Iterator[tuple[str, str]]:
        """As ``Effect.faults``: a beam that nothing holds."""
        yield from rigid_body_faults(table.ends, case.beam.length, case, "beam")

    def carrier(self, beam: Beam) -> Beam:
        """The beam with these ends."""
        return replace(beam, ends=self.ends)


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
