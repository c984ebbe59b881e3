"""Shape of a solid: nodes and quadratic cells of the whole body, and their displacements by its coordinates.

Cells are those of VTK, a triquadratic hexahedron (27 nodes) and a quadratic tetrahedron (10), in VTK's order of nodes
(W. Schroeder, K. Martin, B. Lorensen, The Visualization Toolkit, 2006, §8.1): corners, middles of edges, of faces, of
the cell. A half body is mirrored at y = 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from vibeam.case.beam_field import with_points
from vibeam.case.fidelity import Fidelity, parameters_of, system_of
from vibeam.case.reduced_structure import static_at_contact
from vibeam.extensions.solid.elasticity.own_mesh import HEX_EDGES, HEX_FACES, TET_EDGES
from vibeam_models.arrays import Array, Flags, Index
from vibeam_models.beam import structure_of
from vibeam_models.given import GivenScene
from vibeam_models.scene import AnyScene, Scene
from vibeam_reductions.declaration import REDUCTIONS

if TYPE_CHECKING:
    from vibeam.extensions.solid.elasticity.space import SolidField
    from vibeam.system.impact_system import ImpactSystem


class VtkCell(NamedTuple):
    """Kind of cell: places of the corners in the reference element; corners that each node is in the middle of.

    ``faces``: nodes of each, corners and then middles of its edges and its own, seen from outside.
    """

    corners: Array
    nodes: tuple[tuple[int, ...], ...]
    faces: tuple[tuple[int, ...], ...]

    def order(self, places: Array, mirrored: bool) -> list[int]:
        """Numbers of a scikit-fem element's nodes, at ``places`` (nodes, 3), in VTK's order; of its mirror image."""
        corners = self.corners[:, [1, 0, 2]] if mirrored else self.corners
        wanted = [corners[list(each)].mean(axis=0) for each in self.nodes]
        return [int(np.argmin(np.abs(places - place).sum(axis=1))) for place in wanted]


_HEX_CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
_TET_FACES = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))
_TET_CORNERS = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))


def _face(corners: Sequence[int], edges: Sequence[tuple[int, int]], faces: Sequence[Sequence[int]]) -> tuple[int, ...]:
    """Nodes of a face: its corners, the middles of its edges and, where the cell has one, its own."""
    count = max(max(each) for each in edges) + 1
    around = [{one, other} for one, other in zip(corners, (*corners[1:], corners[0]), strict=True)]
    middles = [count + [set(edge) for edge in edges].index(each) for each in around]
    own = [count + len(edges) + faces.index(corners)] if faces else []
    return (*corners, *middles, *own)


KINDS = {
    27: VtkCell(
        np.array(_HEX_CORNERS, dtype=float),
        (*((corner,) for corner in range(8)), *HEX_EDGES, *HEX_FACES, tuple(range(8))),
        tuple(_face(each, HEX_EDGES, HEX_FACES) for each in HEX_FACES),
    ),
    10: VtkCell(
        np.array(_TET_CORNERS, dtype=float), (*((corner,) for corner in range(4)), *TET_EDGES),
        tuple(_face(each, TET_EDGES, ()) for each in _TET_FACES),
    ),
}  # fmt: skip
#: triangles that a face is drawn by, of its nodes: of nine, around the middle; of six
TRIANGLES = {
    9: ((0, 4, 8), (4, 1, 8), (1, 5, 8), (5, 2, 8), (2, 6, 8), (6, 3, 8), (3, 7, 8), (7, 0, 8)),
    6: ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
}


@dataclass(frozen=True, eq=False)
class SolidShape:
    """Nodes (k, 3) m of a whole body at rest, ``cells`` (c, 27 or 10) in VTK's order.

    ``basis`` (3 j, n): displacements of the j nodes of what is meshed by n coordinates. ``source`` (k,): which of them
    each node is, or is the image of where it is ``mirrored``. ``turn`` (3, 3): to other axes.
    """

    points: Array
    cells: Index
    basis: Any
    source: Index
    mirrored: Flags
    turn: Array = field(default_factory=lambda: np.eye(3))

    @classmethod
    def of(cls, moved: SolidField) -> SolidShape:
        """Shape of a body by the coordinates of its structure, of a half body with its other half."""
        elements, basis, half = moved.elements, moved.basis, moved.body.half
        kind, places = KINDS[len(elements.nodes)], np.asarray(elements.element.doflocs)
        middle = places.mean(axis=0)[:, None]
        turned = np.linalg.det(elements.jacobian(middle)[:, 0]) < 0
        plain, swapped = (elements.nodes[kind.order(places, each)].T for each in (False, True))
        points, count = elements.points.T, len(elements.points.T)
        cells, source = np.where(turned[:, None], swapped, plain), np.arange(count)
        if not half:
            return cls(points, cells, basis, source, np.zeros(count, dtype=bool))
        off = np.abs(points[:, 1]) > 1e-9 * np.ptp(points[:, 0])
        image = source.copy()
        image[off] = count + np.arange(int(off.sum()))
        other = image[np.where(turned[:, None], plain, swapped)]
        whole, mirrored = np.concatenate([source, source[off]]), np.arange(count + int(off.sum())) >= count
        signs = np.where(mirrored[:, None], [1.0, -1.0, 1.0], 1.0)
        return cls(points[whole] * signs, np.concatenate([cells, other]), basis, whole, mirrored)

    @property
    def kind(self) -> VtkCell:
        """Kind of its cells."""
        return KINDS[self.cells.shape[1]]

    def by(self, shapes: Array) -> SolidShape:
        """The same by m other coordinates: ``shapes`` (n, m) has what these are."""
        return replace(self, basis=self.basis @ shapes)

    def displacement(self, coordinates: Array) -> Array:
        """Displacements (k, 3), or (m, k, 3), m, by ``coordinates`` (n,), or (n, m)."""
        moved = np.asarray(self.basis @ coordinates)
        found = np.moveaxis(moved.reshape(-1, 3, *coordinates.shape[1:]), (0, 1), (-2, -1))[..., self.source, :]
        found[..., self.mirrored, 1] *= -1
        return np.asarray(found @ self.turn)

    @property
    def surface(self) -> SolidShape:
        """The outer surface alone: its nodes, with the same triangles."""
        nodes, places = np.unique(self.triangles, return_inverse=True)
        found = replace(self, points=self.points[nodes], source=self.source[nodes], mirrored=self.mirrored[nodes])
        vars(found)["triangles"] = places.reshape(-1, 3)
        return found

    @cached_property
    def triangles(self) -> Index:
        """Nodes (t, 3) of the triangles that its outer surface is drawn by, seen from outside."""
        faces = self.cells[:, np.array(self.kind.faces)].reshape(-1, len(self.kind.faces[0]))
        corners = np.sort(faces[:, : 4 if faces.shape[1] == 9 else 3], axis=1)
        _, first, count = np.unique(corners, axis=0, return_index=True, return_counts=True)
        outer = faces[np.sort(first[count == 1])]
        return np.asarray(outer[:, np.array(TRIANGLES[faces.shape[1]])].reshape(-1, 3))


def solid_shapes(scene: AnyScene) -> dict[str, SolidShape]:
    """Shapes of a scene's bodies by the coordinates of its structure, ``"beam"`` and an ``"opposite"`` one.

    The opposite body stands where it meets the stop, off by the gap. A mesh of one's own is ``"mesh"``, in the axes of
    its file. ValueError where the scene is no solid.
    """
    if not scene.in_three_dimensions:
        raise ValueError('no solid to draw: a fidelity with model = "solid" has one')
    from vibeam.extensions.solid.elasticity.structure import solid_fields

    rig: Any = scene
    if isinstance(scene, GivenScene):
        return {"mesh": _own_shape(scene)}
    found = {name: SolidShape.of(field) for name, field in solid_fields(rig).items()}
    for other in rig.named("opposite"):
        along = rig.stop.position - other.position - other.arm
        across = rig.stop.gap + found["beam"].points[:, 2].max() - found["opposite"].points[:, 2].min()
        points = found["opposite"].points + np.array([along, 0.0, across])
        found["opposite"] = replace(found["opposite"], points=points)
    return found


def _own_shape(scene: GivenScene) -> SolidShape:
    from vibeam.extensions.solid.elasticity.own_structure import own_space

    assert scene.given.body is not None
    body = scene.given.body()
    found = SolidShape.of(own_space(body).field())
    return replace(found, points=found.points @ body.turn + body.origin, turn=body.turn)


def solid_system(scene: AnyScene, fidelity: Fidelity) -> tuple[ImpactSystem, Any, dict[str, SolidShape]]:
    """System of a fidelity, the scene, with points along its beam if it has one, its shapes by the system's modes."""
    shapes, pointed = solid_shapes(scene), with_points(scene) if isinstance(scene, Scene) else scene
    rig: Any = pointed
    structure = structure_of(rig)
    made = REDUCTIONS[fidelity.reduction].make(structure, fidelity.modes, **parameters_of(rig, fidelity))
    small = made.structure
    own = {f"coordinate {number}": row for number, row in enumerate(np.eye(small.size))}
    told = small.with_(outputs={**small.outputs, **own}, units={**small.units, **dict.fromkeys(own, "m")})
    system = system_of(rig, told, static_at_contact(structure))
    by = made.basis @ np.stack([system.output(name) for name in own])
    return system, pointed, {name: shape.by(by) for name, shape in shapes.items()}
