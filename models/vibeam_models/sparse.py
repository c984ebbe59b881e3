"""SparseStructure: a structure of very many coordinates, whose matrices are never made dense."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from vibeam_models.arguments import real_array, refuse
from vibeam_models.arrays import Array
from vibeam_models.beams.beam import Damping
from vibeam_models.sparse_modes import SymmetricFactor, factor, lowest_modes
from vibeam_models.structure import FREE, MATRICES, Modes, Structure, signs

MOST = 1 / 3  # share of all modes up to which Lanczos' method finds them


@dataclass(frozen=True)
class SparseStructure(Structure):
    """As ``Structure``, with scipy's sparse arrays as M, C and K; ``damping``: by modal ratios, beside C.

    What a reduction asks of it (modes, a deflection, its projection) is done by sparse factors. ValueError as there;
    whether the matrices are symmetric is not asked again.
    """

    damping: Damping | None = None

    def _settle(self, names: Collection[str]) -> None:
        faults: list[str] = []
        size = self.M.shape[0]
        for name in names:
            given: Any = getattr(self, name)
            if name in MATRICES:
                self.__dict__[name] = given.tocsc()
                fine = given.shape == (size, size) and bool(np.isfinite(given.data).all())
            else:
                rows = [real_array(row) for row in (given.values() if name == "outputs" else (given,))]
                fine = all(row is not None and row.shape == (size,) and np.isfinite(row).all() for row in rows)
            faults += [] if fine else [f"{name}: must be {size} finite numbers, or {size} × {size}"]
        refuse("structure", faults)

    @cached_property
    def stiffness_factor(self) -> SymmetricFactor:
        """The factors of K."""
        return factor(self.K)

    @cached_property
    def mass_factor(self) -> SymmetricFactor:
        """The factors of M."""
        return factor(self.M)

    def modes(self, count: int | None = None) -> Modes:
        """As ``Structure.modes``; ValueError where so many are asked for that their shapes would be a dense matrix."""
        wanted = self.size if count is None else count
        if f"{wanted} modes" not in self._known:
            self._known[f"{wanted} modes"] = self._lowest(wanted)
        return self._known[f"{wanted} modes"]

    def _lowest(self, count: int) -> Modes:
        if count > MOST * self.size:
            raise ValueError(
                f"structure: the shapes of {count} modes in {self.size} coordinates are "
                f"{8e-9 * count * self.size:.2g} GB: take the lowest few, {int(MOST * self.size)} at most"
            )
        squared, shapes = lowest_modes(self.K, self.M, count, self.stiffness_factor)
        return Modes(np.sqrt(np.maximum(squared, 0.0)), shapes * signs(shapes, self.contact))

    def deflection(self, force: Array) -> Array:
        """As ``Structure.deflection``."""
        if not self.stiffness_factor.regular:
            raise ValueError(FREE)
        return self.stiffness_factor.solve(force)

    def mobility(self, row: Array) -> float:
        """As ``Structure.mobility``."""
        return float(row @ self.mass_factor.solve(row))

    def held(self, rows: Array) -> tuple[Structure, Any]:
        """As ``Structure.held``, sparse."""
        from vibeam_models.elimination import elimination

        basis = elimination(rows)
        M, K = (basis.T @ matrix @ basis for matrix in (self.M, self.K))
        load, static, contact = (row @ basis for row in (self.load, self.static, self.contact))
        return SparseStructure(M, 0 * M, K, load, static, contact), basis

    def congruent(self, name: str, basis: Array) -> Array:
        """As ``Structure.congruent``, C with the damping by modal ratios."""
        from vibeam_models.sparse_damping import modal_damping

        product = basis.T @ (getattr(self, name) @ basis)
        if name == "C" and self.damping is not None:
            product += modal_damping(self, self.damping, basis)
        return np.asarray((product + product.T) / 2)
