"""The clamp yields when it is turned: its rotation is one more coordinate, held by a spring."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

from vibeam_models.beams.beam import Support
from vibeam_models.keys import quantity
from vibeam_models.scene import Effect

if TYPE_CHECKING:
    from vibeam_models.beams.beam import Beam


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
        support = Support(0.0, 0.0, self.stiffness)
        return replace(beam, ends=f"pinned-{far}", supports=(*beam.supports, support))
