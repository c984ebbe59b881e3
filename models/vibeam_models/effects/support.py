"""A further support of the beam, rigid or by springs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

from vibeam_models.beams.beam import Support, stiffnesses
from vibeam_models.beams.tables import place_faults
from vibeam_models.keys import quantity
from vibeam_models.scene import OnEitherBeam

if TYPE_CHECKING:
    from vibeam_models.beams.beam import Beam


@dataclass(frozen=True)
class FurtherSupport(OnEitherBeam):
    """A support anywhere on the beam, one table for each; without a stiffness it does not yield."""

    position: float = quantity("m", "distance from x = 0", "90 mm", least=0)
    stiffness: float | None = quantity(
        "N/m", "force per deflection; absent = it does not yield", "2000 N/m", None, least=0, written=False
    )
    rotational_stiffness: float | None = quantity(
        "N m/rad", "moment per rotation; absent = it turns freely", "5 N m/rad", None, least=0, written=False
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
