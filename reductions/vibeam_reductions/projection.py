"""The one projection behind every reduction: x = Φ q, with ΦᵀMΦ, ΦᵀCΦ, ΦᵀKΦ, Φᵀload, wΦ."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np

from vibeam_models.arrays import Array, ValueRecord
from vibeam_models.structure import Structure, in_coordinates


@dataclass(frozen=True, eq=False, repr=False)
class Reduction(ValueRecord):
    """A structure made smaller: ``basis`` Φ (full size, n), the reduced ``structure`` and the ``full`` one."""

    basis: Array
    structure: Structure
    full: Structure

    def expand(self, q: Array) -> Array:
        """Coordinates Φq of the full structure, (full size,) or (full size, k), from ``q`` (n,) or (n, k)."""
        return np.asarray(self.basis @ q)

    @property
    def flexibility_kept(self) -> float:
        """Share in [0, 1] of the contact's static flexibility w K⁻¹ wᵀ: the rest is lost under a steady force."""
        kept = self.structure.flexibility(self.structure.contact) + self.structure.contact_flexibility
        return kept / self.full.flexibility(self.full.contact)

    @property
    def mobility_kept(self) -> float:
        """Share in [0, 1] of the contact's mobility w M⁻¹ wᵀ: the rest is lost in the answer to an impulse.

        ∞ where the reduction leaves the contact without mass.
        """
        if self.structure.contact_flexibility:
            return inf
        return self.structure.mobility(self.structure.contact) / self.full.mobility(self.full.contact)


def projection(structure: Structure, basis: Array, **known: Array) -> Reduction:
    """``structure`` in the span of ``basis`` (size, n); ValueError for a wrong shape or dependent columns.

    ``known``: reduced matrices that are known better than by their product. ΦᵀKΦ of smooth shapes on a fine mesh loses
    as many digits as ω²max has above ω₁².
    """
    basis = np.asarray(basis, dtype=float)
    if basis.ndim != 2 or len(basis) != structure.size:
        raise ValueError(f"basis: shape {basis.shape}, must be ({structure.size}, n)")
    if not 0 < np.linalg.matrix_rank(basis / np.linalg.norm(basis, axis=0)) == basis.shape[1]:
        raise ValueError(f"basis: its {basis.shape[1]} columns are not independent")
    return Reduction(basis, in_coordinates(structure, basis, **known), structure)


def check_count(structure: Structure, n: int, least: int = 1, why: str = "") -> None:
    """ValueError unless ``least`` ≤ n ≤ size; ``why``: what needs so many."""
    if not least <= n <= structure.size:
        raise ValueError(f"modes: {n}, this structure has {least} to {structure.size}{why}")
