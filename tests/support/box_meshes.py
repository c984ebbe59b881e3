"""Meshes of two boxes side by side along x, of every kind of cells, for tests of files and bodies."""

import numpy as np

from vibeam.extensions.solid.elasticity.own_mesh import HEX_EDGES, HEX_FACES, TET_EDGES

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)
SIZE = np.array([30.0, 20.0, 10.0])
SIX_TETRAHEDRA = [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)]
BEND = 0.1  # of the shear of `bent`


def nodes_of(kind: str) -> tuple[np.ndarray, list[list[int]]]:
    """Nodes and cells of two boxes side by side along x, in the order of VTK; straight."""
    points: list[tuple[float, ...]] = []

    def node(place: np.ndarray) -> int:
        key = tuple(np.round(place * SIZE, 9))
        if key not in points:
            points.append(key)
        return points.index(key)

    cells = []
    for shift in (0.0, 1.0):
        corners = CORNERS + np.array([shift, 0, 0])
        for each in [range(8)] if kind.startswith("hexa") else SIX_TETRAHEDRA:
            own = corners[list(each)]
            places = [*own]
            edges = HEX_EDGES if kind.startswith("hexa") else TET_EDGES
            if kind not in ("hexahedron", "tetra"):
                places += [own[list(edge)].mean(axis=0) for edge in edges]
            if kind == "hexahedron27":
                places += [*(own[list(face)].mean(axis=0) for face in HEX_FACES), own.mean(axis=0)]
            cells.append([node(place) for place in places])
    return np.array(points), cells


def bent(points: np.ndarray) -> np.ndarray:
    """Nodes sheared by z + c x²: what elements of the second order can be, and no volume changes."""
    return np.column_stack((points[:, :2], points[:, 2] + BEND * points[:, 0] ** 2 / SIZE[0]))


def end_face(points: np.ndarray, kind: str, x: int = 2) -> tuple[str, list[list[int]]]:
    """The face at ``x`` of the two boxes, by its corners."""
    at = {tuple(point): index for index, point in enumerate(points)}
    corners = [at[tuple(np.array(each) * SIZE)] for each in ((x, 0, 0), (x, 1, 0), (x, 1, 1), (x, 0, 1))]
    if kind.startswith("hexa"):
        return "quad", [corners]
    return "triangle", [[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]]
