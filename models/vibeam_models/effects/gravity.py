"""Weight along the beam changes its stiffness; weight across it is a constant load."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.beams.beam import CANTILEVER, Beam
from vibeam_models.beams.tables import is_free
from vibeam_models.keys import quantity, word
from vibeam_models.scene import Effect, Scene
from vibeam_models.space import BeamSpace
from vibeam_models.structure import Structure

POINTS, WEIGHTS = np.polynomial.legendre.leggauss(3)  # exact to degree 5: N linear, w′² of degree 4


@dataclass(frozen=True)
class Gravity(Effect):
    """Weight along the beam stiffens or softens it, weight across bends it; absent = no weight.

    The gap is counted from the straight beam.
    """

    direction: Literal["hanging", "standing", "transverse"] = word(
        ("hanging", "standing", "transverse"),
        "the clamp is above, or below; or the axis is level and the weight draws toward the stop",
        "hanging",
    )
    acceleration: float = quantity(
        "m/s^2", "of free fall; negative, for transverse alone: away from the stop", "9.80665 m/s^2", 9.80665
    )

    name: ClassVar[str] = "gravity"

    @classmethod
    def faults(cls, table: Any, case: Any) -> Iterator[tuple[str, str]]:
        """As ``Effect.faults``: a negative weight along the beam; a beam that it makes fall, with no gap at rest."""
        if table.direction in ("hanging", "standing") and table.acceleration is not None and table.acceleration < 0:
            other = "standing" if table.direction == "hanging" else "hanging"
            yield "acceleration", f'is negative: for the other way up write direction = "{other}"'
        hung = table.direction == "hanging" and not (case.beam.ends or CANTILEVER).startswith("free")
        if not hung and (is_free(case, "beam") or is_free(case, "opposite")):
            cure = "take [gravity] out, hold an end, or add [[support]]"
            yield "direction", f"nothing holds a beam against its weight, it falls and has no static gap: {cure}"

    def apply(self, structure: Structure, space: BeamSpace, scene: Scene) -> tuple[Structure, BeamSpace]:
        """As ``AxialGravity.apply``; across the axis static + g M r: as a base that is accelerated away for ever."""
        if self.direction == "transverse":
            return structure.with_(static=structure.static - self.acceleration * structure.load), space
        downward = 1 if self.direction == "hanging" else -1
        return AxialGravity(downward * self.acceleration, scene.carrier, scene.weights).apply(structure, space)


@dataclass(frozen=True)
class AxialGravity:
    """``acceleration`` m/s² along the axis, positive away from the clamp (a hanging beam, in tension).

    ``weights``: (kg, m) of every mass on ``beam``. A standing beam (negative) is in compression.
    """

    acceleration: float
    beam: Beam
    weights: tuple[tuple[float, float], ...]

    def apply(self, structure: Structure, space: BeamSpace) -> tuple[Structure, BeamSpace]:
        """K + ∫ N w′² dx with the axial force N(x) of all that lies beyond x, tension positive.

        Every mass is taken on the beam's axis. ValueError where a standing beam buckles.
        """
        stiffness = structure.K + self.geometric_stiffness(space)
        if self.acceleration < 0:
            self._check(structure.K, stiffness)
        return structure.with_(K=stiffness), space

    def geometric_stiffness(self, space: BeamSpace) -> Array:
        """∫ N w′² dx (size, size), exact on every piece between nodes and masses."""
        ends = np.unique([*space.nodes, *(position for _, position in self.weights)])
        middle, half = (ends[1:] + ends[:-1]) / 2, np.diff(ends) / 2
        places = (middle[:, None] + half[:, None] * POINTS).ravel()
        shares = (half[:, None] * WEIGHTS).ravel() * self.axial_force(places)
        slopes = space.rows(places, 1)
        return np.asarray(slopes.T @ (shares[:, None] * slopes))

    def axial_force(self, x: Array) -> Array:
        """N (k,) in N at ``x`` (k,) m."""
        carried = self.beam.mass_beyond(x)
        for mass, position in self.weights:
            carried = carried + mass * (x < position)
        return np.asarray(self.acceleration * carried)

    def _check(self, elastic: Array, stiffness: Array) -> None:
        from scipy.linalg import eigvalsh

        least = float(eigvalsh(stiffness, elastic, subset_by_index=(0, 0))[0])
        if least <= 0:
            bearable = -self.acceleration / (1 - least)
            raise ValueError(
                f"gravity: the standing beam buckles under its weight: it bears {bearable:.4g} m/s², "
                f"not {-self.acceleration:.4g} m/s²; take a stiffer beam, a smaller mass, or hang it"
            )
