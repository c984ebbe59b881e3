"""Constraint modes of a boundary and the modes of the structure with that boundary held (Craig & Bampton 1968)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.structure import Structure
from vibeam_reductions.loads import static_shapes_under
from vibeam_reductions.projection import Reduction, check_count, projection
from vibeam_reductions.ritz import ritz_stiffness


def craig_bampton(structure: Structure, n: int, boundary: Sequence[str] = ("contact", "masses", "sensor")) -> Reduction:
    """The structure in the constraint modes of its ``boundary`` and its lowest fixed-interface modes, n in all.

    ``boundary``: "contact", "masses" (the places of attached masses and moments of inertia), or names of outputs. Rows
    that depend on those before them, as a sensor's at the contact, are left out. The constraint modes span the static
    deflections under forces on the boundary, by which they are given here: they are K-orthogonal to the fixed-interface
    modes (AIAA J. 6, 1968). ValueError where n is below the number of boundary rows or above the size, for an unknown
    output, and for a free body.
    """
    rows = boundary_rows(structure, boundary)
    constraint = static_shapes_under(structure, rows)
    count = len(constraint)
    check_count(structure, n, count, f": its boundary has {count} rows, {', '.join(constraint.names)}")
    shapes, forces = constraint.shapes, constraint.forces
    if n > count:
        held, free = structure.held(np.array([rows[name] for name in constraint.names]))
        modes = held.modes(n - count)
        fixed = np.asarray(free @ modes.shapes)
        shapes, forces = np.column_stack([shapes, fixed]), np.column_stack([forces, structure.K @ fixed])
    return projection(structure, shapes, K=ritz_stiffness(structure, shapes, forces))


def boundary_rows(structure: Structure, boundary: Sequence[str]) -> dict[str, Array]:
    """The rows (size,) of a boundary by name; ValueError for an output that the structure does not have."""
    unknown = [name for name in boundary if name not in ("contact", "masses", "sensor", *structure.outputs)]
    if unknown or not boundary:
        known = ", ".join(("contact", "masses", *structure.outputs))
        raise ValueError(f"boundary: {', '.join(unknown) or 'is empty'}: it is made of {known}")
    rows: dict[str, Array] = {}
    for name in boundary:
        if name == "masses":
            rows |= {f"inertia {i + 1}": row for i, row in enumerate(structure.attached)}
        elif name == "contact":
            rows[name] = structure.contact
        elif name in structure.outputs:
            rows[name] = structure.outputs[name]
    return rows
