"""Outputs at many points along a beam, of which its deflected shape is made."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.scene import Effect, Scene
from vibeam_models.space import BeamSpace
from vibeam_models.structure import Structure

AN_ELEMENT = 4  # points an element, so that a shape looks as smooth as its cubics are


@dataclass(frozen=True)
class FieldPoints(Effect):
    """Reads deflection and slope at ``positions`` (m) of the beam, and at ``opposite`` of a second one.

    It adds outputs alone, as ``output_names`` names them, and changes no motion. No table of a case.
    """

    positions: tuple[float, ...] = ()
    opposite: tuple[float, ...] = ()

    name: ClassVar[str] = "field points"

    def apply(self, structure: Structure, space: BeamSpace, scene: Scene) -> tuple[Structure, BeamSpace]:
        """An output for each deflection (m) and slope (rad)."""
        outputs = dict(structure.outputs)
        for derivative in (0, 1):
            outputs |= _named("beam", derivative, space.rows(self.positions, derivative))
        for other in scene.named("opposite") if self.opposite else ():
            theirs = other.other_beam(scene)[1]
            before = np.zeros((len(self.opposite), structure.size - theirs.size))
            for derivative in (0, 1):
                outputs |= _named("opposite", derivative, np.hstack((before, theirs.rows(self.opposite, derivative))))
        units = dict.fromkeys(outputs, "m") | dict(structure.units)
        return structure.with_(outputs=outputs, units=units), space


def points_of(space: BeamSpace) -> tuple[float, ...]:
    """Positions (m) of ``AN_ELEMENT`` points an element, and of the far end."""
    nodes = space.nodes
    parts = [np.linspace(a, b, AN_ELEMENT, endpoint=False) for a, b in pairwise(nodes)]
    return tuple(np.concatenate([*parts, nodes[-1:]]).tolist())


def output_names(beam: str, derivative: int, count: int) -> list[str]:
    """Names of the outputs at ``count`` points of ``beam``: deflections (``derivative`` 0) or slopes (1)."""
    return [f"{beam} {('deflection', 'slope')[derivative]} {index}" for index in range(count)]


def _named(beam: str, derivative: int, rows: Array) -> dict[str, Array]:
    return dict(zip(output_names(beam, derivative, len(rows)), rows, strict=True))
