"""Static deflections under given loads, beside known modes or alone; dependent ones are left out."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.structure import Modes, Structure

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


def loads_of(structure: Structure, outputs: bool = True) -> dict[str, Array]:
    """Loads that a structure knows: at the contact, of the drive, constant, on masses, at outputs, in this order.

    Rows (size,) by name; none that is zero. ``outputs``: with those on masses and at outputs.
    """
    named = {"contact": structure.contact, "drive": structure.load, "constant": structure.static}
    if outputs:
        named |= {f"inertia {i + 1}": row for i, row in enumerate(structure.attached)}
        named |= dict(structure.outputs)
    return {name: row for name, row in named.items() if np.any(row)}


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
    """Whether more than round-off is left of a load, by f M⁻¹ fᵀ: what it accelerates."""
    return structure.mobility(force) > NOTHING * structure.mobility(load)
