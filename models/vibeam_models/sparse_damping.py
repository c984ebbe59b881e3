"""Damping said by modal ratios of a structure whose modes are not all known: C = M f(M⁻¹K), projected on a basis.

As matrices, 2ζω of every mode alike is f(ω²) = 2ζω, ratios in proportion to the frequency C = (2ζ₁/ω₁) K, Rayleigh's
C = αM + DK, a list the first of these for its last ratio and a correction for each mode before that. f(M⁻¹K) b is found
in the Krylov space of (K + s M)⁻¹ M and b, where M⁻¹K is a small tridiagonal matrix (N. J. Higham, Functions of
Matrices, SIAM 2008, §13.2).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.beams.beam import Damping
from vibeam_models.sparse_modes import SymmetricFactor, factor

if TYPE_CHECKING:
    from vibeam_models.sparse import SparseStructure

STEPS = 300  # of Lanczos' method at most
EVERY = 10  # of them the result is looked at
SETTLED = 1e-9  # its change from one look to the next at which it ends
EXHAUSTED = 1e-10  # share of a vector that is left where the Krylov space is complete


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
        shift = float(next((w for w in structure.modes(min(12, structure.size // 4)).omega if w > 0), 1.0)) ** 2
        inverse = factor(structure.K + shift * structure.M)
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
