"""Structure: a linear structure of n coordinates, whatever made it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


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
    """

    M: Array
    C: Array
    K: Array
    load: Array
    static: Array
    contact: Array
    outputs: Mapping[str, Array] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return int(self.M.shape[0])

    def with_(self, **changes: Any) -> Structure:
        """The same structure but for the named fields."""
        return replace(self, **changes)

    def modes(self, count: int | None = None) -> Modes:
        """The lowest ``count`` undamped modes (all where it is None), each with a positive contact or tip value."""
        from vibeam_models.eigen import natural_modes

        squared, shapes = natural_modes(self.K, self.M)
        squared, shapes = squared[:count], shapes[:, :count]
        signs = np.where(self.contact @ shapes < 0, -1.0, 1.0)
        return Modes(np.sqrt(np.maximum(squared, 0.0)), shapes * signs)
