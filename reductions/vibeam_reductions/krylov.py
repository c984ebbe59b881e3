"""Moment matching about a frequency: the second-order Krylov space of contact and drive."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.structure import FREE, Structure
from vibeam_reductions.loads import loads_of
from vibeam_reductions.projection import Reduction, check_count, projection
from vibeam_reductions.ritz import ritz_stiffness

EXHAUSTED = 1e-10  # share of a new direction that is left where the space has ended


def krylov(structure: Structure, n: int, frequency: float = 0.0) -> Reduction:
    """The structure in ``n`` directions of the block Krylov space of (K − ω²M)⁻¹M about ``frequency``, Hz.

    It begins with the answers (K − ω²M)⁻¹f to harmonic forces at the contact and by the drive. The undamped transfer
    functions between them then agree at ω in as many derivatives by ω² as there are n directions over the number of
    forces, twice for the contact to itself (Bai & Su, SIAM J. Sci. Comput. 26, 2005; the damping is small, so that the
    space is made without it). M-orthonormal. ValueError where the space has fewer directions (modes that neither
    contact nor drive sees are not in it), at a natural frequency, and for a free body about 0.
    """
    check_count(structure, n)
    omega2, solve = (2 * np.pi * frequency) ** 2, _solver(structure, frequency)
    pending = deque(row for name, row in loads_of(structure, outputs=False).items())
    shapes, momenta, forces = (np.zeros((structure.size, n)) for _ in range(3))
    found = 0
    while found < n and pending:
        load = pending.popleft()
        shape = solve(load)
        force = load + omega2 * (structure.M @ shape)  # K times the shape, without the loss of that product
        size = _norm(structure, shape)
        for _ in range(2):
            along = momenta[:, :found].T @ shape
            shape, force = shape - shapes[:, :found] @ along, force - forces[:, :found] @ along
        rest = _norm(structure, shape)
        if rest > EXHAUSTED * size:
            shapes[:, found], forces[:, found] = shape / rest, force / rest
            momenta[:, found] = structure.M @ shapes[:, found]
            pending.append(momenta[:, found])
            found += 1
    if found < n:
        raise ValueError(f"modes: {n}, the Krylov space of contact and drive has 1 to {found} directions")
    return projection(structure, shapes, K=ritz_stiffness(structure, shapes, forces))


def _norm(structure: Structure, shape: Array) -> float:
    return float(np.sqrt(shape @ (structure.M @ shape)))


def _solver(structure: Structure, frequency: float) -> Callable[[Array], Array]:
    """(K − ω²M)⁻¹ as a function; the static deflection where ω is 0."""
    if frequency == 0:
        return structure.deflection
    matrix: Any = structure.K - (2 * np.pi * frequency) ** 2 * structure.M
    dynamic = structure.with_(K=matrix)
    try:
        dynamic.deflection(structure.contact)
    except ValueError as error:
        if str(error) != FREE:
            raise
        raise ValueError(f"frequency: {frequency:g} Hz is a natural frequency: take another") from None
    return dynamic.deflection
