"""SparseStructure: a structure of very many coordinates, whose matrices are never made dense, and its modal damping.

Damping ratios say C = M f(M⁻¹K) of matrices: 2ζω of every mode alike is f(ω²) = 2ζω, ratios in proportion to the
frequency C = (2ζ₁/ω₁) K, Rayleigh's C = αM + DK, a list the first of these for its last ratio and a correction for each
mode before that. BᵀM f(M⁻¹K) B is found in the Krylov space of (K + s M)⁻¹ M and B, where M⁻¹K is a small matrix: by
Gauss' quadrature, with an error the square of that of f(M⁻¹K) B (G. Golub & G. Meurant, Matrices, Moments and
Quadrature, Princeton 2010, ch. 7).
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from vibeam_models.arguments import real_array, refuse
from vibeam_models.arrays import Array
from vibeam_models.beams.beam import Damping
from vibeam_models.phases import LARGE, phase
from vibeam_models.sparse_factor import Symbolic, SymmetricFactor, congruent_pattern, factor, pattern_of, symbolic
from vibeam_models.sparse_modes import krylov_spaces, lowest_modes
from vibeam_models.sparse_ordering import is_net
from vibeam_models.structure import FIELDS, FREE, MATRICES, Modes, Structure, elimination

MOST = 1 / 3  # share of all modes up to which Lanczos' method finds them
NOTHING = 1e-9  # share of a vector that is left beside the rigid-body modes, below which it is one of them
SETTLED, ROUGHLY = 1e-9, 1e-6  # change in one step of Lanczos' method, a share of the damping, at which it ends
LIKE = 10  # modes are found by as many, so that fidelities which take a few more or fewer share them
ENOUGH, EXACT = 400, 1e-10  # steps of conjugate gradients with M, and the residual, a share, at which they end


@dataclass(frozen=True, eq=False, repr=False)
class SparseStructure(Structure):
    """As ``Structure``, with scipy's sparse arrays as M, C and K; ``damping``: by modal ratios, beside C.

    What a reduction asks of it (modes, a deflection, its projection) is done by sparse factors. ValueError as there;
    whether the matrices are symmetric is not asked again. Equal to itself alone.
    """

    damping: Damping | None = None
    _found: dict[str | int, Any] = field(default_factory=dict, init=False, repr=False)
    __eq__, __hash__ = object.__eq__, object.__hash__  # of so many entries none is compared

    def _settle(self, names: Collection[str]) -> None:
        faults: list[str] = []
        size = self.M.shape[0]
        if {"M", "K"} & set(names):
            self.__dict__["_found"] = {}  # not that of the structure which this one is made from
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

    def _once(self, name: str | int, make: Callable[[], Any]) -> Any:
        """Property of M and K, found once for all structures that share these and differ in their rows."""
        if name not in self._found:
            self._found[name] = make()
        return self._found[name]

    @property
    def fronts(self) -> Symbolic | None:
        """Fronts of K and M together; None of a net."""
        fronts: Symbolic | None = self._once("fronts", self._ordered)
        return fronts

    def _ordered(self) -> Symbolic | None:
        phase("ordering", self.size)
        pattern = pattern_of(self.K, self.M, self.C)  # with entries that are 0 by chance: nodes stay alike
        return None if is_net(pattern) else symbolic(pattern)

    @property
    def stiffness_factor(self) -> SymmetricFactor:
        """The factors of K."""
        found: SymmetricFactor = self._once("K", self._factored)
        return found

    def _factored(self) -> SymmetricFactor:
        fronts = self.fronts
        phase("factoring", self.size)
        return factor(self.K, fronts)

    def modes(self, count: int | None = None) -> Modes:
        """As ``Structure.modes``; ValueError where so many are asked for that their shapes would be a dense matrix."""
        wanted = self.size if count is None else count
        most = int(MOST * self.size)
        if wanted > most:
            raise ValueError(
                f"structure: the shapes of {wanted} modes in {self.size} coordinates are "
                f"{8e-9 * wanted * self.size:.2g} GB: take the lowest few, {most} at most"
            )
        known = [count for count in self._found if isinstance(count, int) and count >= wanted]
        found = min(known, default=min(-(-wanted // LIKE) * LIKE, most))
        squared, shapes = self._once(found, lambda: self._lowest(found))
        every = self._modes(squared, shapes)
        return Modes(every.omega[:wanted], every.shapes[:, :wanted])

    def _lowest(self, count: int) -> tuple[Array, Array]:
        inverse = self.stiffness_factor
        phase(f"{count} modes", self.size)
        return lowest_modes(self.K, self.M, count, inverse)

    @property
    def rigid(self) -> Array:
        """Rigid-body modes (size, k), which modal ratios do not count."""
        if self.stiffness_factor.regular:
            return np.zeros((self.size, 0))
        modes = self.modes(min(LIKE, int(MOST * self.size)))
        return modes.shapes[:, modes.omega == 0]

    def deflection(self, force: Array) -> Array:
        """As ``Structure.deflection``."""
        return self.solved(force)

    def solved(self, force: Array) -> Array:
        """As ``Structure.solved``."""
        if not self.stiffness_factor.regular:
            raise ValueError(FREE)
        return self.stiffness_factor.solve(force)

    def mobility(self, row: Array) -> float:
        """As ``Structure.mobility``."""
        return float(row @ self._accelerated(np.asarray(row, dtype=float)))

    def _accelerated(self, force: Array) -> Array:
        """M⁻¹ force, by conjugate gradients: the mass of a fine mesh is as well conditioned as that of a coarse one.

        By its factors where that is not so (A. J. Wathen, IMA J. Numer. Anal. 7, 1987).
        """
        from scipy.sparse import diags_array
        from scipy.sparse.linalg import cg

        diagonal = self.M.diagonal()
        if diagonal.min() > 0:
            found, fault = cg(self.M, force, rtol=EXACT, maxiter=ENOUGH, M=diags_array(1 / diagonal))
            if not fault:
                return np.asarray(found)
        return np.asarray(self._once("M", lambda: factor(self.M)).solve(force))

    def held(self, rows: Array) -> tuple[Structure, Any]:
        """As ``Structure.held``, sparse."""
        basis = elimination(rows)
        M, K = (basis.T @ matrix @ basis for matrix in (self.M, self.K))
        load, static, contact = (row @ basis for row in (self.load, self.static, self.contact))
        entries = congruent_pattern(pattern_of(self.K, self.M, self.C), basis)
        return SparseStructure(M, entries, K, load, static, contact), basis

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
    rigid = structure.rigid
    elastic = basis - rigid @ (rigid.T @ (M @ basis))
    basis = np.where(np.linalg.norm(elastic, axis=0) > NOTHING * np.linalg.norm(basis, axis=0), elastic, 0.0)
    if damping.kind in ("constant", "list"):
        found = 2 * ratios[-1] * _square_root(structure, basis)
        for number, ratio in enumerate(ratios[:-1], rigid.shape[1]):
            modes = structure.modes(rigid.shape[1] + len(ratios))
            along = modes.shapes[:, number] @ (M @ basis)
            found = found + 2 * (ratio - ratios[-1]) * modes.omega[number] * np.outer(along, along)
        return found
    inertia, stiff = _rayleigh(structure, damping)
    return inertia * (basis.T @ (M @ basis)) + stiff * (basis.T @ (K @ basis))


def _rayleigh(structure: SparseStructure, damping: Damping) -> tuple[float, float]:
    """α and D of C = αM + DK."""
    free = structure.rigid.shape[1]
    omega = structure.modes(free + 2).omega[free:]
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
        shift = float(next((w for w in omega if w > 0), 1.0)) ** 2
        inverse = factor(structure.K + shift * structure.M, structure.fronts)
    found = np.zeros((basis.shape[1],) * 2)
    settled = SETTLED if structure.size < LARGE else ROUGHLY  # beyond what any damping is known to
    for space in krylov_spaces(structure.M, inverse, basis, basis[:, :0]):
        values, vectors = np.linalg.eigh(space.projected)
        root = np.sqrt(np.maximum(1 / np.maximum(values, np.finfo(float).tiny) - shift, 0.0))
        along = vectors[: len(space.start)].T @ space.start
        before, found = found, along.T @ (root[:, None] * along)
        sizes = np.sqrt(np.diag(found))
        if (np.abs(found - before) <= settled * np.outer(sizes, sizes)).all():
            break
    return np.asarray((found + found.T) / 2)
