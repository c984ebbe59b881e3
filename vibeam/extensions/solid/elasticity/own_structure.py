"""Structure of a body on a mesh of the user's own: held groups, masses on groups, rows over its surface."""

from __future__ import annotations

from typing import Any

import numpy as np

from vibeam.extensions.solid.elasticity.body import BodyMass, SolidBody
from vibeam.extensions.solid.elasticity.constraints import RigidPart, SolidCoordinates
from vibeam.extensions.solid.elasticity.elasticity import SolidElements
from vibeam.extensions.solid.elasticity.own_mesh import BodyRow, OwnRig
from vibeam.extensions.solid.elasticity.rows import SolidRows, X, Y, Z
from vibeam.extensions.solid.elasticity.space import BodySpace, RigidMass
from vibeam_models.arrays import Array, Flags
from vibeam_models.sparse import SparseStructure


def body_structure(body: SolidBody, rig: OwnRig) -> SparseStructure:
    """The undamped structure of a body, as ``rig`` drives and reads it; outputs in m.

    The group "clamp" is held in all directions. The load is −M r of a base that moves along ``rig.base``, or minus the
    row "force". ValueError where a rigid group is held in part, or shares nodes with another.
    """
    space = own_space(body)
    rows = {name: space.reduced(_row(space.rows, each)) for name, each in rig.rows.items()}
    direction = np.zeros(3) if rig.base is None else rig.base
    structure = space.structure(direction, rows.pop("contact"))
    parts = iter(space.coordinates.parts)
    for mass in body.masses:
        part = next(parts) if mass.rigid else _mean(space, mass)
        structure = RigidMass(mass.mass, *(mass.inertia,) * 3).on(structure, part, direction)
    force = rows.pop("force", None)
    load = structure.load if force is None else -force
    return structure.with_(load=load, outputs=rows, units=dict.fromkeys(rows, "m"))


def own_space(body: SolidBody) -> BodySpace:
    """Coordinates of a body with its held groups and rigid ones; nothing is assembled yet."""
    rows = SolidRows(body, elements := SolidElements(body.mesh))
    held = np.tile(_nodes(elements, body.patches.get("clamp"), body.points.get("clamp")), (3, 1))
    rigid = [_rigid(rows, each) for each in body.masses if each.rigid]
    return BodySpace(rows, SolidCoordinates.of(elements.points, body.half, held, rigid))


def _rigid(rows: SolidRows, mass: BodyMass) -> RigidPart:
    """The nodes that a rigid mass holds together, about the mean place of its facets, or of its vertices."""
    points = rows.elements.points.T.ravel()
    centre = np.array([_over(rows, mass.facets, mass.vertices, component) @ points for component in range(3)])
    nodes = _nodes(rows.elements, mass.facets, mass.vertices)
    return RigidPart(f"mass {mass.name}", nodes, centre * [1, not rows.body.half, 1])


def _nodes(elements: SolidElements, facets: Any, vertices: Any) -> Flags:
    """Test of each node (k,) of the field whether it lies on these facets, or between these vertices."""
    found = elements.among(np.zeros(0, int) if vertices is None else vertices)
    if facets is not None and len(facets):
        found[elements.dofs.get_facet_dofs(np.asarray(facets, dtype=np.int32)).flatten()] = True
    return found


def _over(rows: SolidRows, facets: Any, vertices: Any, component: int) -> Array:
    return rows.facets(facets, component) if len(facets) else rows.vertices(vertices, component)


def _row(rows: SolidRows, reading: BodyRow) -> Array:
    found = np.zeros(rows.elements.size)
    for facets, vertices, direction, factor in reading.parts:
        for component in np.flatnonzero(direction):
            found += factor * direction[component] * _over(rows, facets, vertices, int(component))
    return found


def _mean(space: BodySpace, mass: BodyMass) -> Array:
    """Mean displacements (2 or 4, n) of a group with a mass, in the order of rigid motions, without turns."""
    x, y, z = (space.reduced(_over(space.rows, mass.facets, mass.vertices, each)) for each in (X, Y, Z))
    none = 0 * x
    return np.stack([x, z, none] if space.rows.body.half else [x, z, none, y, none, none])
