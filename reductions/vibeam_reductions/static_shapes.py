"""Static deflections as a basis: under one load, or under forces on a boundary, whose modes join them.

Dependent deflections are left out.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.structure import Modes, Structure
from vibeam_reductions.projection import Reduction, check_count, projection

DEPENDENT = 1e-9  # share of a deflection's energy beyond the ones before it, below which it is one of these
NOTHING = 1e-12  # share of a load that is left beside modes, below which it is round-off
TWICE = 2  # Gram and Schmidt's orthogonalisation is then complete to round-off


@dataclass(frozen=True)
class StaticShapes:
    """Deflections ``shapes`` (size, k) under combinations ``forces`` (size, k) of the loads ``names``.

    Orthogonal, shapesᵀ @ forces = ``stiffness`` (k,) on the diagonal, and of modal mass 1 each.
    """

    names: tuple[str, ...]
    shapes: Array
    forces: Array
    stiffness: Array

    def __len__(self) -> int:
        return len(self.names)


def static_shapes_under(structure: Structure, loads: Mapping[str, Array], modes: Modes | None = None) -> StaticShapes:
    """The deflections under ``loads``, each made orthogonal to the ones before it and to ``modes``.

    ψ = K⁻¹(f − MΦΦᵀf): what the modes do not carry of the load f. Its force is so rid of the modes before it is solved
    for, since K⁻¹f − Φω⁻²Φᵀf would lose the digits in which the two agree. ValueError for a free body.
    """
    momenta = np.zeros((structure.size, 0)) if modes is None else np.asarray(structure.M @ modes.shapes)
    known = np.zeros((structure.size, 0)) if modes is None else modes.shapes
    names, shapes, forces = [], list[Array](), list[Array]()
    for name, load in loads.items():
        force = _less(load, momenta, known)
        if modes is not None and not _left(structure, force, load):
            continue
        shape = _less(structure.deflection(force), known, momenta)
        energy = float(shape @ force)
        for other, bearing in zip(shapes * TWICE, forces * TWICE, strict=True):  # K-orthogonal
            share = float(shape @ bearing)
            shape, force = shape - share * other, force - share * bearing
        rest = float(shape @ force)
        if rest > DEPENDENT * energy:
            names.append(name)
            shapes.append(shape / np.sqrt(rest))
            forces.append(force / np.sqrt(rest))
    return _of_unit_mass(structure, names, shapes, forces)


def _of_unit_mass(
    structure: Structure, names: Iterable[str], shapes: Iterable[Array], forces: Iterable[Array]
) -> StaticShapes:
    columns, loads = (np.array([*each]).reshape(-1, structure.size).T for each in (shapes, forces))
    masses = np.sum(columns * (structure.M @ columns), axis=0)
    return StaticShapes(tuple(names), columns / np.sqrt(masses), loads / np.sqrt(masses), 1 / masses)


def _less(vector: Array, along: Array, measured: Array) -> Array:
    """The vector less its part along the columns, ``measured`` by their duals."""
    for _ in range(TWICE):
        vector = vector - along @ (measured.T @ vector)
    return vector


def _left(structure: Structure, force: Array, load: Array) -> bool:
    """Test whether more than round-off is left of a load, by f M⁻¹ fᵀ: what it accelerates."""
    return structure.mobility(force) > NOTHING * structure.mobility(load)


def static_mode(structure: Structure, at: Array | None = None) -> Reduction:
    """The structure in its static deflection under a load on row ``at`` (size,), the contact's by default (φ, eq. 44).

    Scaled so that the output ``"sensor"`` reads 1, or the row ``at`` itself where there is no such output. It keeps all
    of the contact's static flexibility. ValueError where the deflection is zero at that place.
    """
    return projection(structure, static_shape(structure, at))


def static_shape(structure: Structure, at: Array | None = None) -> Array:
    """Static deflection of ``static_mode``, (size, 1)."""
    row = structure.contact if at is None else np.asarray(at, dtype=float)
    shape = structure.deflection(row)
    scale = float(structure.outputs.get("sensor", row) @ shape)
    if abs(scale) <= 1e-12 * np.linalg.norm(shape):
        raise ValueError("static mode: the place it is scaled at does not move")
    return np.asarray((shape / scale)[:, np.newaxis])


def craig_bampton(structure: Structure, n: int, boundary: Sequence[str] = ("contact", "masses", "sensor")) -> Reduction:
    """The structure in the constraint modes of its ``boundary`` and its lowest fixed-interface modes, n in all.

    ``boundary``: "contact", "masses" (the places of attached masses and moments of inertia), or names of outputs. Rows
    that depend on those before them, as a sensor's at the contact, are left out. The constraint modes span the static
    deflections under forces on the boundary, by which they are given here: they are K-orthogonal to the fixed-interface
    modes (AIAA J. 6, 1968). ValueError where n is below the number of boundary rows or above the size, for an unknown
    output, and for a free body.

    >>> import vibeam
    >>> chain = vibeam.Structure(
    ...     M=[[1, 0], [0, 1]], C=[[0, 0], [0, 0]], K=[[2, -1], [-1, 2]], load=[-1, -1], static=[0, 0], contact=[0, 1]
    ... )
    >>> reduced = vibeam.craig_bampton(chain, 2, boundary=["contact"]).structure
    >>> (reduced.modes().omega ** 2).round(9).tolist()  # two coordinates are all
    [1.0, 3.0]
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
    return projection(structure, shapes, K=structure.ritz_stiffness(shapes, forces))


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
