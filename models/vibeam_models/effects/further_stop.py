"""A further stop beside the beam: elsewhere along it, or on its other side."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from vibeam_models.keys import quantity, word
from vibeam_models.laws import CONSTANT
from vibeam_models.scene import Effect, Scene

if TYPE_CHECKING:
    from vibeam_models.space import BeamSpace
    from vibeam_models.structure import Structure


@dataclass(frozen=True)
class FurtherStop(Effect):
    """A rigid stop beside that of [stop], one table for each; Newton's law in turn where several are struck at once."""

    position: float = quantity("m", "of the contact, from x = 0", "170 mm", above=0)
    gap: float = quantity("m", "gap at rest, at this contact; negative = the beam is pressed against it", "0.1 mm")
    restitution: float = quantity("", "coefficient of restitution of this contact", 0.7, least=0, most=1)
    side: Literal["above", "below"] = word(
        ("above", "below"), "above: the side that [stop] is on; below: the other one", "below", "above"
    )

    name: ClassVar[str] = "further_stop"

    @classmethod
    def faults(cls, table: Any, case: Any) -> Iterator[tuple[str, str]]:
        """As ``Effect.faults``: a place beyond the tip, a law of [stop] that goes with one stop alone."""
        length = case.beam.length
        if None not in (table.position, length) and table.position > length:
            yield "position", f"{table.position:g} m is beyond the tip: beam.length is {length:g} m"
        if (case.stop.law or CONSTANT) != CONSTANT:
            yield "", f'does not go with stop.law = "{case.stop.law}": several stops have a restitution each'

    @property
    def output(self) -> str:
        """Name of the output that is the displacement toward it."""
        return f"toward the stop {self.side} at {1000 * self.position:g} mm"

    def apply(self, structure: Structure, space: BeamSpace, scene: Scene) -> tuple[Structure, BeamSpace]:
        """An output more: the displacement toward this stop."""
        row = space.row(self.position) * (1.0 if self.side == "above" else -1.0)
        outputs, units = {**structure.outputs, self.output: row}, {**structure.units, self.output: "m"}
        return structure.with_(outputs=outputs, units=units), space
