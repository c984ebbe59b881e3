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
        from vibeam_models.eigen import natural_modes

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
