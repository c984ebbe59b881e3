"""Structure: a linear structure of n coordinates, whatever made it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam_models.arguments import real_array, refuse

Array = NDArray[np.float64]

SYMMETRIC = 1e-9  # share of a matrix's largest entry by which two entries may differ

STIFF = 1e-9  # share of the largest ω² by which another may be negative and still be round-off


@dataclass(frozen=True)
class Modes:
    """Mass-normalised natural modes: ``omega`` (n,) rad/s ascending, ``shapes`` (size, n) with ΦᵀMΦ = I."""

    omega: Array
    shapes: Array

    @property
    def frequency(self) -> Array:
        """Natural frequencies (n,) in Hz."""
        return self.omega / (2 * np.pi)


@dataclass(frozen=True)
class Structure:
    """M ẍ + C ẋ + K x = load · b̈(t) + static, with x relative to the base whose displacement is b(t).

    A finite-element beam and its one-mode model are both a Structure: whatever accepts the one accepts the other.

    - ``M``, ``C``, ``K``: mass, damping, stiffness (n, n), symmetric;
    - ``load``: (n,) force per unit base acceleration, −M r;
    - ``static``: (n,) constant force, zero unless an effect brings one;
    - ``contact``: (n,) row w; the contact displacement is w·x, positive toward the stop;
    - ``outputs``: name → (n,) row; ``units``: name → unit of that output, metres where it is not named.

    Lists are kept as arrays of floats. ValueError names every field whose shape is wrong, that is not finite, or, of
    the matrices, not symmetric. An example with own matrices is in ``vibeam.ImpactSystem.from_structure``.
    """

    M: Array
    C: Array
    K: Array
    load: Array
    static: Array
    contact: Array
    outputs: Mapping[str, Array] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        faults: list[str] = []
        matrices = {name: real_array(getattr(self, name)) for name in ("M", "C", "K")}
        size = next((len(each) for each in matrices.values() if each is not None and each.ndim == 2), 0)
        rows = {name: real_array(getattr(self, name)) for name in ("load", "static", "contact")}
        outputs = {name: real_array(row) for name, row in self.outputs.items()}
        for name, matrix in matrices.items():
            _check(name, matrix, (size, size), faults)
        for name, row in (rows | {f"outputs[{name!r}]": row for name, row in outputs.items()}).items():
            _check(name, row, (size,), faults)
        refuse("structure", faults)
        for name, value in (matrices | rows | {"outputs": outputs}).items():
            object.__setattr__(self, name, value)

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return int(self.M.shape[0])

    def with_(self, **changes: Any) -> Structure:
        """The same structure but for the named fields."""
        return replace(self, **changes)

    def modes(self, count: int | None = None) -> Modes:
        """The lowest ``count`` undamped modes (all where it is None), each with a positive contact or tip value.

        ValueError where ``M`` is not positive definite or ``K`` not positive semidefinite.
        """

        try:
            squared, shapes = natural_modes(self.K, self.M)
        except np.linalg.LinAlgError:
            raise ValueError("structure: M: must be positive definite: every coordinate needs a mass") from None
        if squared[0] < -STIFF * abs(squared[-1]):
            raise ValueError("structure: K: must be positive semidefinite: a direction has negative stiffness")
        squared, shapes = squared[:count], shapes[:, :count]
        signs = np.where(self.contact @ shapes < 0, -1.0, 1.0)
        return Modes(np.sqrt(np.maximum(squared, 0.0)), shapes * signs)


def _check(name: str, value: Array | None, shape: tuple[int, ...], faults: list[str]) -> None:
    if value is None or value.shape != shape or not value.size or not np.isfinite(value).all():
        faults.append(f"{name}: must be {' × '.join(map(str, shape)) if shape[0] else 'n × n'} finite numbers")
    elif value.ndim == 2 and np.max(np.abs(value - value.T)) > SYMMETRIC * np.max(np.abs(value)):
        faults.append(f"{name}: must be symmetric")


def in_coordinates(structure: Structure, basis: Array) -> Structure:
    """The structure in coordinates y with x = basis @ y, ``basis`` (n, fewer): BᵀMB, Bᵀload, w B …"""
    return structure.with_(
        M=_congruent(structure.M, basis),
        C=_congruent(structure.C, basis),
        K=_congruent(structure.K, basis),
        load=structure.load @ basis,
        static=structure.static @ basis,
        contact=structure.contact @ basis,
        outputs={name: row @ basis for name, row in structure.outputs.items()},
    )


def _congruent(matrix: Array, basis: Array) -> Array:
    product = basis.T @ matrix @ basis
    return (product + product.T) / 2


def natural_modes(K: Array, M: Array) -> tuple[Array, Array]:
    """ω² (n,) ascending and shapes (n, n) with ΦᵀMΦ = I; ``M`` positive definite, ``K`` positive semidefinite.

    Solved as it stands, the problem is exact to 10⁻¹⁶ of the *highest* ω², which leaves little or nothing of the first
    mode on a fine or light beam; so the modes below the geometric middle come from M φ = ω⁻² K φ. Where ``K`` is
    singular, a free body, they stay as they are.
    """
    from scipy.linalg import LinAlgError, eigh

    squared, shapes = eigh(K, M)
    try:
        inverse, flexible = eigh(M, K)
    except LinAlgError:
        return squared, shapes
    inverse, flexible = inverse[::-1], flexible[:, ::-1]
    low = int(np.count_nonzero(inverse > 1 / np.sqrt(squared[-1] / inverse[0])))
    squared[:low] = 1 / inverse[:low]
    shapes[:, :low] = flexible[:, :low] / np.sqrt(inverse[:low])
    return squared, shapes


def with_inertia(structure: Structure, row: Array, inertia: float, translation: float) -> Structure:
    """The structure with ``inertia`` (kg, or kg m² on a slope) on the coordinate row·x, ``row`` (n,).

    ``translation``: what the coordinate reads when the base moves by 1 m: 1 for a deflection, 0 for a slope.
    """
    mass = structure.M + inertia * np.outer(row, row)
    return structure.with_(M=mass, load=structure.load - inertia * translation * row)
