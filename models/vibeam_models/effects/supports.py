"""Supports of the beam: how its ends are held, further supports, a clamp that yields when it is turned."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, ClassVar

from vibeam_models.beams.beam import Beam, Support, stiffnesses
from vibeam_models.beams.tables import place_faults
from vibeam_models.keys import quantity
from vibeam_models.scene import Effect, OnEitherBeam


@dataclass(frozen=True)
class BeamEnds(Effect):
    """Ends of the beam, at x = 0 and at the full length: how they are held, one of ``beams.beam.PAIRS``."""

    ends: str

    name: ClassVar[str] = "beam.ends"
    shapes_beam: ClassVar[bool] = True

    def carrier(self, beam: Beam) -> Beam:
        """The beam with these ends."""
        return replace(beam, ends=self.ends)


@dataclass(frozen=True)
class FurtherSupport(OnEitherBeam):
    """A support anywhere on the beam, one table for each; without a stiffness it does not yield."""

    position: float = quantity("m", "distance from x = 0", "90 mm", least=0)
    stiffness: float | None = quantity(
        "N/m", "force per deflection; absent = it does not yield", "2000 N/m", None, least=0
    )
    rotational_stiffness: float | None = quantity(
        "N m/rad", "moment per rotation; absent = it turns freely", "5 N m/rad", None, least=0
    )

    name: ClassVar[str] = "support"
    shapes_beam: ClassVar[bool] = True

    @classmethod
    def faults(cls, table: Any, case: Any) -> Iterator[tuple[str, str]]:
        """As ``Effect.faults``: a place beyond the tip, a support that holds nothing."""
        yield from place_faults(table, case)
        if table.stiffness == 0 and not table.rotational_stiffness:
            yield "stiffness", "0 holds nothing: leave it out for a rigid support, or take the support out"

    def carrier(self, beam: Beam) -> Beam:
        """The beam with this support."""
        return replace(beam, supports=(*beam.supports, Support(self.position, *stiffnesses(self))))


@dataclass(frozen=True)
class Clamp(Effect):
    """The clamp yields when it is turned; absent = it does not."""

    stiffness: float = quantity("N m/rad", "moment per rotation of the clamp", "500 N m/rad", above=0)

    name: ClassVar[str] = "clamp"

    @classmethod
    def faults(cls, table: Any, case: Any) -> Iterator[tuple[str, str]]:
        """As ``Effect.faults``: a beam that is not clamped at x = 0."""
        if case.beam.ends is not None and not case.beam.ends.startswith("clamped"):
            yield "", f'goes with a beam clamped at its start, not with ends = "{case.beam.ends}": write [[support]]'

    def carrier(self, beam: Beam) -> Beam:
        """K + k θᵀθ with θ the slope at x = 0, which is free."""
        far = beam.ends.split("-")[1]
        return replace(beam, ends=f"pinned-{far}", supports=(*beam.supports, Support(0.0, 0.0, self.stiffness)))
