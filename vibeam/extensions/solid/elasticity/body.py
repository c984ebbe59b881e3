"""SolidBody: a meshed body of three-dimensional elasticity, with its materials and the named parts of its surface."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from vibeam.extensions.solid.elasticity.elasticity import SolidElements
from vibeam_models.arrays import Array, Flags, Index
from vibeam_models.beams.stretch import Material


@dataclass(frozen=True, eq=False)
class BodyMass:
    """A mass on a group of facets or, where there are none, of vertices: ``mass`` kg, ``inertia`` kg m² about y through
    its centroid; ``rigid``: the group moves as a rigid body, else the mass moves with the group's mean."""

    name: str
    facets: Index
    vertices: Index
    mass: float
    inertia: float = 0.0
    rigid: bool = True


@dataclass(frozen=True, eq=False)
class SolidBody:
    """A body in m: x along the beam, z the direction of motion, positive toward the stop, y across.

    ``mesh``: MeshHex, MeshHex2, MeshTet or MeshTet2 of scikit-fem, of the second order where the body is curved.
    ``material`` (elements,): index in ``materials``. ``half``: y ≥ 0 of a body symmetric in y, whose energies count
    twice. ``patches``: facets (k,) of the mesh by name, ``points``: vertices (k,) by name where a group has no facets.
    ``beam`` (elements,): those of the beam itself, neither plate nor block; None: all. ``masses``: on groups of a mesh
    of one's own, whose axes are x_file = turn.T @ x + origin.
    """

    mesh: Any
    material: Index
    materials: tuple[Material, ...]
    half: bool
    patches: Mapping[str, Index]
    points: Mapping[str, Index] = field(default_factory=dict)
    beam: Flags | None = None
    masses: tuple[BodyMass, ...] = ()
    turn: Array = field(default_factory=lambda: np.eye(3))
    origin: Array = field(default_factory=lambda: np.zeros(3))

    @property
    def mass(self) -> float:
        """kg of the whole body, without ``masses``."""
        density = np.array([each.density for each in self.materials])[self.material]
        return float((2 if self.half else 1) * density @ SolidElements(self.mesh).volumes().sum(axis=1))
