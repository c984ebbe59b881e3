"""SparseStructure: a structure of very many coordinates, whose matrices are never made dense, and its modal damping.

Damping ratios say C = M f(M⁻¹K) of matrices: 2ζω of every mode alike is f(ω²) = 2ζω, ratios in proportion to the
frequency C = (2ζ₁/ω₁) K, Rayleigh's C = αM + DK, a list the first of these for its last ratio and a correction for each
mode before that. f(M⁻¹K) b is found in the Krylov space of (K + s M)⁻¹ M and b, where M⁻¹K is a small tridiagonal
matrix (N. J. Higham, Functions of Matrices, SIAM 2008, §13.2).
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from vibeam_models.arguments import real_array, refuse
from vibeam_models.arrays import Array
from vibeam_models.beams.beam import Damping
from vibeam_models.sparse_factor import Symbolic, SymmetricFactor, factor, pattern_of, symbolic
from vibeam_models.sparse_modes import lowest_modes
from vibeam_models.sparse_ordering import is_net
from vibeam_models.structure import FIELDS, FREE, MATRICES, Modes, Structure, elimination, signs

MOST = 1 / 3  # share of all modes up to which Lanczos' method finds them
STEPS = 300  # of Lanczos' method at most
FLEXIBLE = 1e-3  # share of the twelfth natural frequency from which one is not a rigid motion's
EVERY = 10  # of them the result is looked at
SETTLED = 1e-9  # its change from one look to the next at which it ends
FACTORED = ("fronts", "stiffness_factor", "mass_factor")  # what is known of M and K
EXHAUSTED = 1e-10  # share of a vector that is left where the Krylov space is complete


@dataclass(frozen=True, eq=False, repr=False)
class SparseStructure(Structure):
    """As ``Structure``, with scipy's sparse arrays as M, C and K; ``damping``: by modal ratios, beside C.

    What a reduction asks of it (modes, a deflection, its projection) is done by sparse factors. ValueError as there;
    whether the matrices are symmetric is not asked again. Equal to itself alone.
    """

    damping: Damping | None = None
    __eq__, __hash__ = object.__eq__, object.__hash__  # of so many entries none is compared

    def _settle(self, names: Collection[str]) -> None:
        faults: list[str] = []
        size = self.M.shape[0]
        for name in FACTORED if {"M", "K"} & set(names) else ():  # of the structure that this one is made from
            self.__dict__.pop(name, None)
        for name in (each for each in FIELDS if each in names):
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
    def fronts(self) -> Symbolic | None:
        """Fronts of K and M together; None of a net."""
        pattern = pattern_of(self.K, self.M)
        return None if is_net(pattern) else symbolic(pattern)

    @cached_property
    def stiffness_factor(self) -> SymmetricFactor:
        """The factors of K."""
        return factor(self.K, self.fronts)

    @cached_property
    def mass_factor(self) -> SymmetricFactor:
        """The factors of M."""
        return factor(self.M, self.fronts)

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
        basis = elimination(rows)
        M, K = (basis.T @ matrix @ basis for matrix in (self.M, self.K))
        load, static, contact = (row @ basis for row in (self.load, self.static, self.contact))
        return SparseStructure(M, 0 * M, K, load, static, contact), basis

    def ritz_stiffness(self, basis: Array, forces: Array) -> Array:
        """As ``Structure.ritz_stiffness``, each entry from the force of the softer of its two shapes."""
        product = basis.T @ forces
        stiffness = np.diag(product)
        lower = np.where(stiffness[None, :] <= stiffness[:, None], product, product.T)
        return np.asarray((lower + lower.T) / 2)

    def congruent(self, name: str, basis: Array) -> Array:
        """As ``Structure.congruent``, C with the damping by modal ratios."""
        product = basis.T @ (getattr(self, name) @ basis)
        if name == "C" and self.damping is not None:
            product += modal_damping(self, self.damping, basis)
        return np.asarray((product + product.T) / 2)


def modal_damping(structure: SparseStructure, damping: Damping, basis: Array) -> Array:
    """BᵀCB (n, n) for the ``basis`` B (size, n); ValueError for ratios that would make a mode's negative."""
    K, M, ratios = structure.K, structure.M, damping.ratios
    if damping.kind in ("constant", "list"):
        found = 2 * ratios[-1] * _square_root(structure, basis)
        for number, ratio in enumerate(ratios[:-1]):
            modes = structure.modes(len(ratios))
            along = modes.shapes[:, number] @ (M @ basis)
            found = found + 2 * (ratio - ratios[-1]) * modes.omega[number] * np.outer(along, along)
        return found
    inertia, elastic = _rayleigh(structure, damping)
    return inertia * (basis.T @ (M @ basis)) + elastic * (basis.T @ (K @ basis))


def _rayleigh(structure: SparseStructure, damping: Damping) -> tuple[float, float]:
    """α and D of C = αM + DK."""
    omega = structure.modes(2).omega
    if damping.kind == "stiffness":
        return 0.0, 2 * damping.ratios[0] / float(omega[0])
    alpha, elastic = np.linalg.solve(0.5 * np.column_stack([1 / omega, omega]), np.array(damping.ratios))
    if elastic < 0:
        raise ValueError(f"damping 'rayleigh' of {damping.ratios} makes the highest modes negative")
    return float(alpha), float(elastic)


def _square_root(structure: SparseStructure, basis: Array) -> Array:
    """Bᵀ M (M⁻¹K)^½ B."""
    shift, inverse = 0.0, structure.stiffness_factor
    if not inverse.regular:
        omega = structure.modes(min(12, structure.size // 4)).omega
        shift = float(next((w for w in omega if w > FLEXIBLE * omega[-1]), 1.0)) ** 2
        inverse = factor(structure.K + shift * structure.M, structure.fronts)
    inertia = structure.M @ basis
    columns = [_applied(structure, shift, inverse, column) for column in basis.T]
    found = inertia.T @ np.column_stack(columns)
    return np.asarray((found + found.T) / 2)


def _applied(structure: SparseStructure, shift: float, inverse: SymmetricFactor, b: Array) -> Array:
    """(M⁻¹K)^½ b by Lanczos' method in the inner product of M, each vector made orthogonal to all before it."""
    size = float(np.sqrt(b @ (structure.M @ b)))
    vectors, inertias = (np.empty((STEPS + 1, len(b))) for _ in range(2))
    vectors[0], inertias[0] = b / size, structure.M @ b / size
    diagonal: list[float] = []
    beside: list[float] = []
    before = now = np.zeros(0)
    for step in range(STEPS):
        new = inverse.solve(inertias[step])
        scale = float(np.linalg.norm(new))
        diagonal.append(float(new @ inertias[step]))
        for _ in range(2):
            new = new - (inertias[: step + 1] @ new) @ vectors[: step + 1]
        complete = float(np.linalg.norm(new)) <= EXHAUSTED * scale
        if complete or step % EVERY == EVERY - 1:
            before, now = now, _root_of_tridiagonal(diagonal, beside, shift)
            change = np.linalg.norm(now - np.pad(before, (0, len(now) - len(before))))
            if complete or change <= SETTLED * np.linalg.norm(now):
                break
        inertia = structure.M @ new
        rest = float(np.sqrt(new @ inertia))
        beside.append(rest)
        vectors[step + 1], inertias[step + 1] = new / rest, inertia / rest
    return np.asarray(size * (now @ vectors[: len(now)]))


def _root_of_tridiagonal(diagonal: list[float], beside: list[float], shift: float) -> Array:
    """g(T) e₁ with g(μ) = (1/μ − s)^½."""
    from scipy.linalg import eigh_tridiagonal

    mu, vectors = eigh_tridiagonal(diagonal, beside[: len(diagonal) - 1])
    root = np.sqrt(np.maximum(1 / np.maximum(mu, np.finfo(float).tiny) - shift, 0.0))
    return np.asarray(vectors @ (root * vectors[0]))
