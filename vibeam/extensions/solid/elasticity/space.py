"""BodySpace: a meshed body with its coordinates, its matrices and load in them, and what is carried by it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from vibeam.extensions.solid.elasticity.body import SolidBody
from vibeam.extensions.solid.elasticity.constraints import SolidCoordinates
from vibeam.extensions.solid.elasticity.elasticity import SolidElements
from vibeam.extensions.solid.elasticity.rows import SolidRows, X, Y, Z
from vibeam_models.arrays import Array
from vibeam_models.memory import check_room
from vibeam_models.phases import phase
from vibeam_models.sparse import SparseStructure
from vibeam_models.sparse_factor import congruent_pattern, pattern_of

AN_ENTRY = 330  # bytes at most in use for a pair of nodes of an element, measured at 100 000 coordinates


@dataclass(frozen=True, eq=False)
class BodySpace:
    """Rows on the displacements of a body, and the coordinates y (n,) that its constraints have left: u = Z y."""

    rows: SolidRows
    coordinates: SolidCoordinates

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return int(self.coordinates.basis.shape[1])

    def reduced(self, row: Array) -> Array:
        """Row (n,) on the coordinates of a row (3 k,) on the displacements, or several rows."""
        return np.asarray(row @ self.coordinates.basis)

    def congruent(self, matrix: Any) -> Any:
        """Matrix (n, n), sparse, of one (3 k, 3 k) of the displacements; that of half a body counts twice."""
        return self._congruent(matrix, self.coordinates.basis)

    def _congruent(self, matrix: Any, basis: Any) -> Any:
        return (2.0 if self.rows.body.half else 1.0) * (basis.T.tocsc() @ (matrix @ basis))

    def structure(self, direction: Array, contact: Array, contraction: bool = True) -> SparseStructure:
        """The structure on a base that moves along ``direction`` (3,); ``contact`` (n,): its row.

        ValueError where the memory that is free does not hold its matrices while they are made.
        """
        body, elements = self.rows.body, self.rows.elements
        phase("stiffness and mass", self.size)
        entries = elements.stiff_nodes.shape[0] ** 2 * elements.stiff_nodes.shape[1]
        check_room(f"matrices of {self.size} coordinates", entries * AN_ENTRY, "take a coarser mesh of the solid")
        density = np.array([each.density for each in body.materials])[body.material]
        mass = elements.mass(density)
        load = -(2.0 if body.half else 1.0) * self.reduced(mass @ np.tile(direction, elements.size // 3))
        elastic, inner = elements.stiffness(body.materials, body.material, contraction), self.coordinates.inner
        undamped, stiffness = congruent_pattern(pattern_of(elastic), inner), self._congruent(elastic, inner)
        return SparseStructure(self.congruent(mass), undamped, stiffness, load, np.zeros(self.size), contact)

    def field(self, before: int = 0, after: int = 0) -> SolidField:
        """Displacements of the body in a structure that has so many coordinates ``before`` and ``after`` its own."""
        from scipy.sparse import csc_array, hstack

        count = self.rows.elements.size
        parts = (csc_array((count, before)), self.coordinates.basis, csc_array((count, after)))
        return SolidField(self.rows.body, self.rows.elements, hstack(parts, format="csc"))


@dataclass(frozen=True, eq=False)
class SolidField:
    """Displacements of a ``body``, m, at the nodes ``elements.points``, by the coordinates y (n,) of a whole structure.

    u = ``basis`` y, ``basis`` (3 k, n) sparse, x, y and z of each node in turn.
    """

    body: SolidBody
    elements: SolidElements
    basis: Any


@dataclass(frozen=True)
class RigidMass:
    """A rigid body of ``mass`` kg and moments of inertia (kg m²) about axes through it along y, z and x."""

    mass: float
    about_y: float = 0.0
    about_z: float = 0.0
    about_x: float = 0.0

    def on(self, structure: SparseStructure, part: Array, direction: Array) -> SparseStructure:
        """The structure with this body on a ``part`` (3 or 6, n): rows in the order of ``RigidPart.motions``.

        ``direction`` (3,): in which the base moves. Attached to are displacement along it and slope.
        """
        inertias = (self.mass, self.mass, self.about_y, self.mass, self.about_z, self.about_x)
        moves = (direction[X], direction[Z], 0.0, direction[Y], 0.0, 0.0)
        attached = (*structure.attached, *(part[at] for at in range(len(part)) if moves[at]))
        attached += (part[2],) if self.about_y else ()
        mass, load = structure.M, structure.load
        for row, inertia, moved in zip(part, inertias, moves, strict=False):
            mass = mass + inertia * outer(row) if inertia else mass
            load = load - inertia * moved * row
        return structure.with_(M=mass, load=load, attached=attached)


def outer(row: Array) -> Any:
    """rowᵀ row (n, n), sparse."""
    from scipy.sparse import csc_array

    one = csc_array(row[None])
    return (one.T @ one).tocsc()
