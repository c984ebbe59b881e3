"""Contact: a further stop of a system, elsewhere or in another direction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from vibeam_models.arguments import number, read_only, refuse
from vibeam_models.arrays import Array


@dataclass(frozen=True, eq=False)
class Contact:
    """A stop at Σ row_i η_i = ``gap`` (m), ``row`` (n,) positive toward it, with a coefficient of ``restitution``.

    ValueError names every argument that is wrong: a row that is not finite numbers or all zero, a gap that is not
    finite, a restitution outside [0, 1].
    """

    row: Array
    gap: float
    restitution: float = 1.0

    def __post_init__(self) -> None:
        faults: list[str] = []
        row = read_only(self.row)
        if row is None or row.ndim != 1 or not row.size or not np.isfinite(row).all() or not row.any():
            faults.append("row: must be finite numbers, one a mode, not all zero")
        object.__setattr__(self, "row", row)
        object.__setattr__(self, "gap", number("gap", self.gap, faults))
        coefficient = number("restitution", self.restitution, faults, least=0.0, most=1.0)
        object.__setattr__(self, "restitution", coefficient)
        refuse("contact", faults)

    def __eq__(self, other: Any) -> bool:
        if not isinstance(other, Contact):
            return NotImplemented
        same = (self.gap, self.restitution) == (other.gap, other.restitution)
        return same and np.array_equal(self.row, other.row)

    __hash__ = None  # type: ignore[assignment]  # it holds an array
