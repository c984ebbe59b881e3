"""Faults of a mesh: its cells, its bodies and where they meet, its size; nodes of two bodies made one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from vibeam.extensions.solid.elasticity.elasticity import SolidElements
from vibeam.extensions.solid.elasticity.own_mesh import FileMesh, Indices, MeshGroup, Numbering, finite_element_mesh
from vibeam_models.arrays import Array

FLAT = 1e-10  # volume of a cell as a share of its size cubed below which it has none
ASTRAY = 0.5  # share of an edge's length by which its middle node may lie off the middle
SAME = 1e-7  # share of the mesh's size within which two nodes lie on each other
LARGEST, SMALLEST = 50.0, 1e-3  # longest side in m beyond which a mesh must say its extent
USUAL = (5e-3, 5.0)  # that of a rig, for the unit that is meant
UNITS = {"mm": 1e-3, "m": 1.0, "cm": 1e-2, "in": 25.4e-3, "µm": 1e-6}
AGREES = 0.02


def cell_faults(mesh: FileMesh) -> Iterator[str]:
    """Complaints about cells of a mesh in m: a node twice, middle nodes astray, no volume, inverted."""
    twice = np.flatnonzero(np.any(np.diff(np.sort(mesh.corners, axis=1), axis=1) == 0, axis=1))
    if len(twice):
        yield f"{_cells(mesh, twice, 'degenerate, with a corner named twice')}: mesh without collapsed cells"
        return
    ends = mesh.points[mesh.corners[:, np.array(mesh.edges)[: mesh.middles.shape[1]]]] if mesh.middles.size else None
    if ends is not None:
        off = np.linalg.norm(mesh.points[mesh.middles] - ends.mean(axis=2), axis=2)
        astray = np.flatnonzero(np.any(off > ASTRAY * np.linalg.norm(ends[:, :, 0] - ends[:, :, 1], axis=2), axis=1))
        if len(astray):
            said = "the order of nodes is not the format's: write the file by another program, or of the first order"
            yield f"{_cells(mesh, astray, 'with middle nodes far off their edges')}: {said}"
            return
    signed, least, size = _volumes(mesh)
    empty = np.abs(signed) <= FLAT * size**3
    if np.any(empty):
        yield f"{_cells(mesh, np.flatnonzero(empty), 'degenerate, without volume')}: mesh again there"
    mostly = 1.0 if np.count_nonzero(signed > 0) * 2 >= len(signed) else -1.0  # all left-handed: mirrored numbering
    inverted = np.flatnonzero(((mostly * signed < 0) | (least <= 0)) & ~empty)
    if len(inverted):
        cure = "mesh again there (Gmsh: Mesh.Optimize, for curved cells Mesh.HighOrderOptimize)"
        yield f"{_cells(mesh, inverted, 'inverted or folded')}: {cure}"


def _volumes(mesh: FileMesh) -> tuple[Array, Array, Array]:
    """Volume (k,) of the cells, signed, the least of their Jacobians in its sign, and the size of each."""
    elements = SolidElements(finite_element_mesh(mesh))
    points, weights = elements.quadrature
    jacobian = -np.linalg.det(elements.jacobian(points))  # scikit-fem's is negative in right-handed hexahedra
    signed = jacobian @ weights
    least = (jacobian * np.sign(signed)[:, None]).min(axis=1)
    corners = mesh.points[mesh.corners]
    if mesh.corners.shape[1] == 4:  # scikit-fem sorts their nodes, which loses the sign
        sides = corners[:, 1:] - corners[:, :1]
        signed = np.abs(signed) * np.sign(np.linalg.det(sides))
    return signed, least, np.linalg.norm(np.ptp(corners, axis=1), axis=1)


def _cells(mesh: FileMesh, cells: Indices, wrong: str) -> str:
    """Wrong cells in words: how many, the first, its group and place."""
    first = f"{group_of(mesh, cells[:1])} at {place_of(mesh.points[mesh.corners[cells[0]]].mean(axis=0))}"
    if len(cells) == 1:
        return f"1 of {len(mesh.cells)} cells is {wrong},{first}"
    return f"{len(cells)} of {len(mesh.cells)} cells are {wrong}, the first{first}"


def group_of(mesh: FileMesh, cells: Indices) -> str:
    """The smallest group that has all of these cells, ``" of group 'block'"``; empty where none has."""
    known = [(len(each.cells), name) for name, each in mesh.groups.items() if np.isin(cells, each.cells).all()]
    return f" of group '{min(known)[1]}'" if known else ""


def place_of(point: Array) -> str:
    """A place in m as shown in a message, in mm."""
    return f"({', '.join(f'{1e3 * each:.4g}' for each in np.round(point, 9) + 0.0)}) mm"


def size_faults(mesh: FileMesh, unit: float, extent: float | None) -> Iterator[tuple[str, str]]:
    """A complaint, with its key, where a mesh is no rig's size, or not as long as the ``extent`` m that is said."""
    longest = float(np.ptp(mesh.points, axis=0).max())
    if extent is None and SMALLEST <= longest <= LARGEST:
        return
    if extent is not None and abs(longest - extent) <= AGREES * extent:
        return
    low, high = USUAL if extent is None else ((1 - AGREES) * extent, (1 + AGREES) * extent)
    meant = next((name for name, unit_in in UNITS.items() if low <= longest / unit * unit_in <= high), None)
    cure = f'is mesh_unit = "{meant}" meant?' if meant else "one of mesh_unit and extent is wrong" if extent else ""
    if extent is not None:
        yield "extent", f"is {extent:g} m, and the mesh is {longest:.4g} m long: {cure}"
    else:
        yield "mesh_unit", f'the mesh is {longest:.4g} m long: {cure} Where it is, write extent = "{longest:.4g} m"'


def bodies_of(mesh: FileMesh) -> Indices:
    """Body (nodes,) that each node is of, from 0: cells with a node in common are one."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count, nodes = len(mesh.points), mesh.cells.ravel()
    first = np.repeat(mesh.cells[:, 0], mesh.cells.shape[1])
    return np.asarray(connected_components(coo_array((np.ones(len(nodes)), (first, nodes)), (count, count)), False)[1])


def coincident(mesh: FileMesh, tolerance: float, free: Indices) -> Indices:
    """Pairs (k, 2) of nodes not farther from each other than ``tolerance`` m, not both of them ``free`` to be so."""
    from scipy.spatial import cKDTree

    pairs = cKDTree(mesh.points).query_pairs(tolerance, output_type="ndarray").reshape(-1, 2)
    return np.asarray(pairs[~np.isin(pairs, free).all(axis=1)], dtype=np.int64)


def merged(mesh: FileMesh, tolerance: float, free: Indices) -> FileMesh:
    """The mesh with nodes nearer than ``tolerance`` m made one, but those that are ``free``.

    ValueError where there are none, where cells would collapse, and where the faces that touch do not match.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    ends = mesh.points[mesh.corners[:, np.array(mesh.edges)]]
    shortest = float(np.linalg.norm(ends[:, :, 0] - ends[:, :, 1], axis=2).min())
    if tolerance >= shortest / 4:
        raise ValueError(f"{tolerance:g} m is no small part of the shortest edge, {shortest:.3g} m: write less")
    pairs = coincident(mesh, tolerance, free)
    if not len(pairs):
        raise ValueError(f"no two nodes of the mesh are nearer than {tolerance:g} m: leave it out, or write more")
    count = len(mesh.points)
    _, new = connected_components(coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), (count, count)), False)
    groups = {
        name: MeshGroup(group.cells, tuple(new[faces] for faces in group.faces), np.unique(new[group.nodes]))
        for name, group in mesh.groups.items()
    }
    made = replace(mesh, points=mesh.points[np.unique(new, return_index=True)[1]], cells=new[mesh.cells], groups=groups)
    body, joined = finite_element_mesh(made), Numbering(made).of(np.unique(new[pairs]))
    whole = np.isin(body.facets, joined).all(axis=0)
    if not np.any(whole) or np.any(body.f2t[1, whole] < 0):
        place = place_of(mesh.points[pairs[0, 0]])
        raise ValueError(f"the faces that touch at {place} do not match node by node: mesh the bodies together")
    return made


def on_line(points: Array) -> bool:
    """Test whether points (n, 3) lie on a line, or are one, so that what is held there can turn."""
    apart = points - points.mean(axis=0)
    return int(np.linalg.matrix_rank(apart, tol=SAME * max(1.0, float(np.abs(points).max())))) < 2


def body_faults(mesh: FileMesh, held: Indices, free: Indices, half: bool) -> Iterator[tuple[str, str]]:
    """Complaints about bodies that do not hang together, or can turn, with their keys.

    ``held``: nodes of the clamp; ``free``: those of a contact between two bodies, which may lie on each other; a
    ``half`` is held by its plane of symmetry too.
    """
    bodies = bodies_of(mesh)
    count = int(bodies.max()) + 1
    pairs = coincident(mesh, SAME * float(np.ptp(mesh.points, axis=0).max()), free)
    cure = 'mesh them together (Gmsh: fragments; Abaqus: merge the instances), or write merge = "1 µm"'
    loose = [body for body in range(count) if len(held) and body not in bodies[held]]
    for body in range(count):
        own = np.flatnonzero(bodies[mesh.cells[:, 0]] == body)
        at = place_of(mesh.points[bodies == body].mean(axis=0))
        name = f"a body of {len(own)} cells{group_of(mesh, own)} at {at}"
        on = pairs[(bodies[pairs] == body).sum(axis=1) == 1]
        if body not in loose:
            if len(held) and not half and on_line(mesh.points[held[bodies[held] == body]]):
                yield "clamp", f"holds {name} on a line or in a point alone, about which it turns: hold a face"
        elif len(on):
            lies = f"{len(on)} of its nodes lie on nodes of another body without being the same: {cure}"
            yield "clamp", f"does not hold {name}, which touches no other: {lies}"
        else:
            yield "clamp", f"does not hold {name}, {_gap(mesh, bodies, body)}: join them, or clamp it"
    rest = pairs[~np.isin(bodies[pairs], loose).any(axis=1)]
    if len(rest):
        said = f"{len(rest)} pairs of its nodes lie on each other without being the same, the first at"
        yield "mesh", f"{said} {place_of(mesh.points[rest[0, 0]])}: {cure}; a slit needs a width"


def _gap(mesh: FileMesh, bodies: Indices, body: int) -> str:
    from scipy.spatial import cKDTree

    own, others = mesh.points[bodies == body], mesh.points[bodies != body]
    if not len(others):
        return "the only one"
    distance, _ = cKDTree(others).query(own)
    return f"whose nodes are {1e3 * float(distance.min()):.3g} mm off any other"
