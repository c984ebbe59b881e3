"""The one projection behind every reduction: x = Φ q, with ΦᵀMΦ, ΦᵀCΦ, ΦᵀKΦ, Φᵀload, wΦ."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vibeam_models.structure import Array, Structure, in_coordinates


@dataclass(frozen=True)
class Reduction:
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
        return self.structure.flexibility(self.structure.contact) / self.full.flexibility(self.full.contact)

    @property
    def mobility_kept(self) -> float:
        """Share in [0, 1] of the contact's mobility w M⁻¹ wᵀ: the rest is lost in the answer to an impulse."""
        return self.structure.mobility(self.structure.contact) / self.full.mobility(self.full.contact)


def projection(structure: Structure, basis: Array) -> Reduction:
    """``structure`` in the span of ``basis`` (size, n); ValueError for a wrong shape or dependent columns."""
    basis = np.asarray(basis, dtype=float)
    if basis.ndim != 2 or len(basis) != structure.size:
        raise ValueError(f"basis: shape {basis.shape}, must be ({structure.size}, n)")
    if not 0 < np.linalg.matrix_rank(basis / np.linalg.norm(basis, axis=0)) == basis.shape[1]:
        raise ValueError(f"basis: its {basis.shape[1]} columns are not independent")
    return Reduction(basis, in_coordinates(structure, basis), structure)
