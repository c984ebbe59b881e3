"""FileContent of a mesh as any format has them, and the one mesh of volume that they make."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from vibeam.exchange.files import COORDINATES, FormatError
from vibeam.extensions.solid.elasticity.own_mesh import KINDS, FileMesh, Indices, MeshGroup
from vibeam_models.arrays import Array

FAR = 1e30  # beyond which products of coordinates overflow
SOLIDS = ("hexahedron", "tetra", "wedge", "pyramid")  # kinds of cells of volume begin with one of these
CALLED = {"wedge": "wedges", "pyramid": "pyramids", "tetra": "tetrahedra", "hexahedron": "hexahedra"}


@dataclass(eq=False)
class FileContent:
    """Content of a file: ``points`` (n, 3), ``blocks`` of cells of a kind each (k, nodes), and its groups by name.

    ``members``: cells of a group as {block: indices}; ``faces``: faces by their corners; ``nodes``: nodes.
    """

    points: Array
    blocks: list[tuple[str, Indices]]
    members: dict[str, dict[int, Indices]] = field(default_factory=dict)
    faces: dict[str, list[Indices]] = field(default_factory=dict)
    nodes: dict[str, Indices] = field(default_factory=dict)

    def join(self, name: str, block: int, indices: Indices) -> None:
        """Add cells of a block to a group."""
        if len(indices):
            own = self.members.setdefault(name, {})
            own[block] = np.union1d(own.get(block, np.empty(0, int)), indices)


def by_value(values: Indices) -> Iterator[tuple[int, Indices]]:
    """Each value of an array of whole numbers, and the indices at which it stands."""
    order = np.argsort(values, kind="stable")
    found, starts = np.unique(values[order], return_index=True)
    return zip(found.tolist(), np.split(order, starts[1:]), strict=False)  # of nothing there is one empty part


def mesh_of(content: FileContent) -> FileMesh:
    """The mesh of volume: one kind of cells, each once, nodes that cells use, groups of these."""
    kind = _kind(content.blocks)
    blocks = {index: data for index, (name, data) in enumerate(content.blocks) if name == kind}
    if len(content.points) > COORDINATES:
        raise FormatError(f"has {len(content.points)} nodes; a mesh may have {COORDINATES} at most: mesh coarser")
    for _, data in content.blocks:
        if data.size and (data.min() < 0 or data.max() >= len(content.points)):
            raise FormatError("a cell names a node that is not there: the file is damaged")
    together = np.concatenate(list(blocks.values()))
    bad = np.flatnonzero(~np.all(np.abs(content.points) < FAR, axis=1))
    if len(bad):
        said = f"of its nodes have coordinates that are no finite numbers, or beyond {FAR:g}"
        raise FormatError(f"{len(bad)} {said}, the first node {bad[0] + 1}")
    # Gmsh writes a cell again for every group that it is in
    _, first, again = np.unique(np.sort(together, axis=1), axis=0, return_index=True, return_inverse=True)
    order = np.argsort(np.argsort(first))
    cell = order[again.reshape(-1)]
    starts = dict(zip(blocks, np.cumsum([0, *map(len, blocks.values())]), strict=False))
    cells = together[np.sort(first)]
    used, renumbered = np.unique(cells, return_inverse=True)
    nodes = np.full(len(content.points), -1)
    nodes[used] = np.arange(len(used))
    groups, strays = {}, {}
    for name in dict.fromkeys([*content.members, *content.faces, *content.nodes]):
        groups[name], strays[name] = _group(content, name, {at: cell[start:] for at, start in starts.items()}, nodes)
    unused = len(content.points) - len(used)
    return FileMesh(content.points[used], kind, renumbered.reshape(cells.shape), groups, strays, unused)


def _kind(blocks: list[tuple[str, Indices]]) -> str:
    counts: dict[str, int] = {}
    for name, data in blocks:
        counts[name] = counts.get(name, 0) + len(data)
    solids = {name: count for name, count in counts.items() if name.startswith(SOLIDS) and count}
    if not solids:
        others = ", ".join(f"{count} {name}" for name, count in counts.items()) or "no cells at all"
        raise FormatError(f"holds no cells of volume ({others}): mesh the volume, and save it with its surfaces")
    if len(solids) > 1 or next(iter(solids)) not in KINDS:
        said = ", ".join(f"{count} {_called(name)}" for name, count in solids.items())
        raise FormatError(
            f"holds {said}: only hexahedra alone or tetrahedra alone are taken, of 8, 20, 27 or 4, 10 nodes, all alike"
        )
    return next(iter(solids))


def _called(name: str) -> str:
    stem = next(each for each in SOLIDS if name.startswith(each))
    nodes = name.removeprefix(stem)
    return CALLED[stem] + (f" of {nodes} nodes" if nodes else "")


def _group(content: FileContent, name: str, cell: Mapping[int, Indices], nodes: Indices) -> tuple[MeshGroup, int]:
    """A group in the numbers of the mesh, and how many of its nodes no cell uses."""
    cells, faces, points = [], list(content.faces.get(name, [])), [content.nodes.get(name, np.empty(0, int))]
    for block, indices in content.members.get(name, {}).items():
        kind, data = content.blocks[block]
        if block in cell:
            cells.append(cell[block][indices])
        elif kind.startswith(("triangle", "quad")):
            faces.append(data[indices][:, : 3 if kind.startswith("triangle") else 4])
        else:
            points.append(data[indices].ravel())
    named = nodes[np.unique(np.concatenate(points)).astype(int)]
    made = MeshGroup(
        np.unique(np.concatenate([np.empty(0, int), *cells])),
        tuple(nodes[each] for each in faces),
        named[named >= 0],
    )
    return made, int(np.count_nonzero(named < 0))
