"""Meshes of the user's own as their files have them; the finite-element mesh of their nodes; rows over its surface."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam_models.arrays import Array

Indices = NDArray[np.integer[Any]]

#: nodes of a cell by the name of its kind, in the order of VTK; its corners are the first 8, or 4
KINDS = {"hexahedron": 8, "hexahedron20": 20, "hexahedron27": 27, "tetra": 4, "tetra10": 10}
TO_SKFEM = [0, 4, 3, 1, 7, 5, 2, 6]  # corners of VTK's hexahedron in the order of scikit-fem's
TET_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
HEX_EDGES = (
    *((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)),
    *((0, 4), (1, 5), (2, 6), (3, 7)),
)  # fmt: skip
HEX_FACES = ((0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7))
IN_PLANE = 1e-6  # share of the body's size, or of a unit vector, that is none
STRAIGHT = 1e-4  # share of an edge's length within which its middle node lies in the middle: texts of 8 digits round


@dataclass(frozen=True, eq=False)
class MeshGroup:
    """A named group of a mesh: cells (k,) by index, faces (k, 3 or 4) by their corner nodes, nodes (k,)."""

    cells: Indices
    faces: tuple[Indices, ...]
    nodes: Indices

    @property
    def on_surface(self) -> bool:
        """Test whether it has faces."""
        return any(map(len, self.faces))


@dataclass(frozen=True, eq=False)
class FileMesh:
    """A mesh as its file has it: ``points`` (n, 3) in the file's unit, ``cells`` (k, nodes) of one of ``KINDS``.

    All points are nodes of cells. ``strays``: how many nodes of a group were none; ``unused``: of the whole file.
    """

    points: Array
    kind: str
    cells: Indices
    groups: Mapping[str, MeshGroup]
    strays: Mapping[str, int] | None = None
    unused: int = 0

    @property
    def corners(self) -> Indices:
        """Corner nodes (k, 8 or 4) of the cells."""
        return self.cells[:, : 4 if self.kind.startswith("tetra") else 8]

    @property
    def edges(self) -> tuple[tuple[int, int], ...]:
        """Corners of each edge of a cell, in the order of its middle nodes."""
        return TET_EDGES if self.kind.startswith("tetra") else HEX_EDGES

    @property
    def middles(self) -> Indices:
        """Middle nodes (k, edges) of the cells; none of the first order."""
        return self.cells[:, self.corners.shape[1] :][:, : len(self.edges)]


@dataclass(frozen=True, eq=False)
class BodyRow:
    """A linear reading of displacements: the sum of ``parts``, each a mean over facets of the body, weighted by area.

    A part: facets (k,), vertices (k,) (where there are no facets, of equal weight), direction (3,), factor.
    """

    parts: tuple[tuple[Indices, Indices, Array, float], ...]


@dataclass(frozen=True, eq=False)
class OwnRig:
    """Drive and readings of a body of one's own: ``rows`` "contact", "sensor", "force", outputs by name.

    ``base``: direction (3,) in which the base moves; None: the force drives.
    """

    rows: Mapping[str, BodyRow]
    base: Array | None


class Numbering:
    """Vertices of scikit-fem's mesh by the nodes of the file, and the other way round."""

    def __init__(self, mesh: FileMesh) -> None:
        self.nodes, self.corners = np.unique(mesh.corners, return_inverse=True)
        self.corners = self.corners.reshape(mesh.corners.shape)
        self.vertices = np.full(len(mesh.points), -1)
        self.vertices[self.nodes] = np.arange(len(self.nodes))

    def of(self, nodes: Indices) -> Indices:
        """Vertices of nodes; those in the middle of edges have none."""
        found = self.vertices[nodes]
        return np.asarray(found[found >= 0])


def finite_element_mesh(mesh: FileMesh) -> Any:
    """MeshHex or MeshTet of scikit-fem in the file's unit; MeshHex2 or MeshTet2 where an edge or a face is curved.

    The middle nodes are given to the edges and faces by their corners, whatever the orders of nodes are. Faces and
    middle of a hexahedron are where the shape functions of 20 nodes have them: −¼ of the corners, +½ of the edges of a
    face, +¼ of those of the cell; the 7 nodes that one of 27 has there are not used.
    """
    from skfem import MeshHex, MeshHex2, MeshTet, MeshTet2

    hexahedra = mesh.kind.startswith("hexahedron")
    numbering = Numbering(mesh)
    columns = numbering.corners[:, TO_SKFEM] if hexahedra else numbering.corners
    linear = (MeshHex if hexahedra else MeshTet)(mesh.points[numbering.nodes].T.copy(), columns.T.copy())
    if mesh.cells.shape[1] == mesh.corners.shape[1] or not _curved(mesh):
        return linear
    made = (MeshHex2 if hexahedra else MeshTet2).from_mesh(linear)
    places = made.doflocs.copy()
    edges = _found(made.edges, [numbering.corners[:, edge] for edge in np.array(mesh.edges)])
    places[:, made.dofs.edge_dofs[0, edges]] = mesh.points[mesh.middles.T].transpose(2, 0, 1)
    if hexahedra:
        faces = _found(made.facets, [numbering.corners[:, face] for face in np.array(HEX_FACES)])
        at = _serendipity(mesh)
        places[:, made.dofs.facet_dofs[0, faces]] = at[:, :6].transpose(2, 1, 0)
        places[:, made.dofs.interior_dofs[0]] = at[:, 6].T
    return replace(made, doflocs=places)


def _curved(mesh: FileMesh) -> bool:
    ends = mesh.points[mesh.corners[:, np.array(mesh.edges)]]
    off = np.linalg.norm(mesh.points[mesh.middles] - ends.mean(axis=2), axis=2)
    return bool(np.any(off > STRAIGHT * np.linalg.norm(ends[:, :, 0] - ends[:, :, 1], axis=2)))


def _serendipity(mesh: FileMesh) -> Array:
    """Places (k, 7, 3) of the middles of the faces and of the cell of hexahedra with 20 nodes."""
    corners, middles = mesh.points[mesh.corners], mesh.points[mesh.middles]
    on = [[index for index, edge in enumerate(HEX_EDGES) if set(edge) <= set(face)] for face in HEX_FACES]
    faces = [
        -corners[:, face].sum(axis=1) / 4 + middles[:, edges].sum(axis=1) / 2
        for face, edges in zip(HEX_FACES, on, strict=True)
    ]
    middle = -corners.sum(axis=1) / 4 + middles.sum(axis=1) / 4
    return np.stack([*faces, middle], axis=1)


def _found(known: Indices, wanted: list[Indices]) -> Indices:
    """Columns of ``known`` (corners, n) that have the corners (k, corners) of each of the ``wanted``; −1: none."""
    rows = np.sort(np.concatenate(wanted), axis=1)
    both = np.concatenate([np.sort(known, axis=0).T, rows])
    _, first, index = np.unique(both, axis=0, return_index=True, return_inverse=True)
    place = first[index.reshape(-1)[known.shape[1] :]]
    return np.asarray(np.where(place < known.shape[1], place, -1)).reshape(len(wanted), -1)


def facets_of(mesh: Any, faces: Indices) -> Indices:
    """Facets (k,) of a mesh with the corner vertices (k, 3 or 4) of ``faces``; −1 where it has none."""
    if not len(faces) or faces.shape[1] != mesh.facets.shape[0]:
        return np.full(len(faces), -1)
    return np.asarray(_found(mesh.facets, [faces])[0])


def surface_within(mesh: Any, vertices: Indices) -> Indices:
    """Facets (k,) of the body's surface whose vertices are all among ``vertices``."""
    among = np.zeros(mesh.p.shape[1], dtype=bool)
    among[vertices] = True
    outside = mesh.boundary_facets()
    return np.asarray(outside[np.all(among[mesh.facets[:, outside]], axis=0)])


def mean_normal(mesh: Any, facets: Indices) -> tuple[Array, float]:
    """Outward unit normal (3,) of facets of the surface on the mean, and the share of their area that looks there."""
    from skfem import FacetBasis

    basis = FacetBasis(mesh, mesh.elem(), facets=np.asarray(facets, dtype=np.int32))
    mean = np.sum(np.asarray(basis.normals) * basis.dx, axis=(1, 2))
    size = float(np.linalg.norm(mean))
    found = mean / size if size else mean
    return np.where(np.abs(found) < IN_PLANE, 0.0, found), size / float(np.sum(basis.dx))


def half_turn(points: Array, nodes: Indices) -> tuple[Array, Array]:
    """Turn (3, 3) and origin (3,) that bring the plane of ``nodes`` to y = 0 and the ``points`` (n, 3) to y ≥ 0.

    x_body = turn (x − origin), by whole axes. ValueError where there is no such plane.
    """
    near = IN_PLANE * float(np.ptp(points, axis=0).max())
    across = int(np.argmin(np.ptp(points[nodes], axis=0)))
    place = float(points[nodes, across].mean())
    away = points[:, across] - place
    if np.ptp(points[nodes, across]) > near:
        raise ValueError("lies in no plane normal to an axis, as the face of one half does")
    if away.min() < -near and away.max() > near:
        raise ValueError("has the body on both sides: mesh one half alone")
    side = 1.0 if away.max() > near else -1.0
    turn, origin = np.zeros((3, 3)), np.zeros(3)
    turn[0, (across + 2) % 3], turn[1, across], turn[2, (across + 1) % 3] = side, side, 1.0
    origin[across] = place
    return turn, origin


def turned(points: Array, turn: Array, origin: Array) -> Array:
    """Points (n, 3) in the axes of a body, those in its plane of symmetry at y = 0 to the bit."""
    made = (points - origin) @ turn.T
    made[np.abs(made[:, 1]) <= IN_PLANE * float(np.ptp(points, axis=0).max()), 1] = 0.0
    return np.asarray(made)
