"""Tables [wire] of the model, [wires] of the study."""

from dataclasses import dataclass
from typing import ClassVar

from vibeam_models.keys import quantity
from vibeam_models.scene import Effect


@dataclass(frozen=True)
class Wire(Effect):
    """A wire holds the beam at a place."""

    name: ClassVar[str] = "wire"
    stiffness: float = quantity("N/m", "of the wire", "50 N/m", above=0)
    position: float = quantity("m", "distance from the clamp", "60 mm", above=0)

    def apply(self, structure, space, scene):
        row = space.row(self.position)
        return structure.with_(K=structure.K + self.stiffness * row[:, None] * row), space


@dataclass(frozen=True)
class WiresPlan:
    most: float = quantity("N/m", "stiffness of the last wire", "100 N/m", 100.0, above=0)
