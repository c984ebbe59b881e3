"""Outputs: what sensors along a beam read, each a row on its coordinates and an order of derivative in time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vibeam_models.beams.beam import Beam
from vibeam_models.keys import flag, word
from vibeam_models.keys import quantity as number

if TYPE_CHECKING:
    from vibeam_models.arrays import Array
    from vibeam_models.space import BeamSpace


@dataclass(frozen=True)
class OutputQuantity:
    """Quantity that an output is of the deflection w(x, t): so many derivatives along the beam and in time.

    ``name``: as ``quantity`` of a case has it; ``unit``: SI, as results files have it, and that of its rate.
    """

    name: str
    along: int
    rate: int
    unit: str
    unit_of_rate: str


DISPLACEMENT = OutputQuantity("displacement", 0, 0, "m", "m s-1")

OUTPUT_QUANTITIES: Mapping[str, OutputQuantity] = {
    each.name: each
    for each in (
        DISPLACEMENT,
        OutputQuantity("velocity", 0, 1, "m s-1", "m s-2"),
        OutputQuantity("acceleration", 0, 2, "m s-2", "m s-3"),
        OutputQuantity("slope", 1, 0, "rad", "rad s-1"),
        OutputQuantity("strain", 2, 0, "1", "s-1"),
    )
}


@dataclass(frozen=True)
class Output:
    """A sensor ``position`` m from the first end of a beam.

    ``quantity``: one of ``OUTPUT_QUANTITIES``. ``distance`` (m): of a strain gauge from the neutral axis; positive on
    the face that a bend toward the stop stretches, strain = distance · w″; None: half the section's height.
    ``absolute``: of an acceleration, with the base's added, as an accelerometer reads; everything else is relative to
    the base, as the beam's coordinates are.
    """

    name: str
    position: float = number("m", "from x = 0, in [0, length]", "5 mm", least=0)
    quantity: str = word(
        tuple(OUTPUT_QUANTITIES),
        "displacement, its rate or acceleration, the slope, or the strain: distance times curvature",
        "strain", DISPLACEMENT.name,
    )  # fmt: skip
    distance: float | None = number(
        "m", "of a strain gauge from the neutral axis, positive on the face that a bend toward the stop stretches; "
        "absent = half the section's height", "0.517 mm", None,
    )  # fmt: skip
    absolute: bool = flag(
        "of an acceleration: with the base's added, as an accelerometer reads; absent = true", True, False
    )

    @property
    def kind(self) -> OutputQuantity:
        """Quantity that it reads."""
        return OUTPUT_QUANTITIES[self.quantity]

    def row(self, space: BeamSpace, beam: Beam) -> Array:
        """Row (size,) on the coordinates of ``space``, before any derivative in time.

        ValueError for a strain whose distance is neither given nor known of ``beam`` there.
        """
        row = space.row(self.position, self.kind.along)
        return row * self._distance(beam) if self.quantity == "strain" else row

    def _distance(self, beam: Beam) -> float:
        found = surface_distance(beam, self.position) if self.distance is None else self.distance
        if found is None:
            raise ValueError(f"output {self.name}: no distance from the neutral axis is given, nor known there")
        return found


def surface_distance(beam: Beam, x: float) -> float | None:
    """Distance in m of the surface from the neutral axis at ``x`` m; None where the section does not say it.

    Half the height of a section, which all shapes that know it have two axes of symmetry of; None beneath a bonded
    plate that stiffens. Where two stretches meet it is that of the later one.
    """
    height, stiffened = beam.height_at(x), any(plate.stiffens for plate in beam.stretch_at(x).plates)
    return None if np.isnan(height) or stiffened else height / 2
