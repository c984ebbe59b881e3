"""Subspaces that hold the motion: Krylov's of contact and drive, or those of a flight by orthogonal decomposition."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.structure import FREE, Modes, Structure
from vibeam_reductions.projection import Reduction, check_count, projection
from vibeam_reductions.static_shapes import loads_of

SPANNED = 1e-13  # singular value, as a share of the largest, below which a direction is round-off


@dataclass(frozen=True, eq=False)
class Snapshots:
    """States of a motion at some instants: ``displacement`` and ``velocity`` (modes, instants) of all natural modes."""

    displacement: Array
    velocity: Array


def pod(structure: Structure, n: int, snapshots: Snapshots, inner_product: str = "mass") -> Reduction:
    """The structure in the ``n`` directions that hold most of the ``snapshots``.

    Displacements and velocities are weighed alike: each are divided by their root mean square, in the inner product of
    M ("mass") or K ("energy"), so that neither the slow modes that displacements show nor the fast ones that velocities
    show are left out (Kerschen, Golinval, Vakakis & Bergman, Nonlinear Dynamics 41, 2005, for the decomposition).
    ValueError where n is more than what they span, and for a sparse structure, whose modes are not all known.
    """
    check_count(structure, n)
    modes = structure.modes()
    weights = _weights(modes, inner_product)
    parts = [weights * (each / _size(weights * each)) for each in (snapshots.displacement, snapshots.velocity)]
    directions, values, _ = np.linalg.svd(np.column_stack(parts), full_matrices=False)
    spanned = int(np.count_nonzero(values > SPANNED * values[0]))
    if n > spanned:
        raise ValueError(f"modes: {n}, the flight spans 1 to {spanned} directions: write more periods")
    shares = directions[:, :n] / weights
    stiffness = shares.T @ (modes.omega[:, None] ** 2 * shares)
    return projection(structure, modes.shapes @ shares, M=shares.T @ shares, K=(stiffness + stiffness.T) / 2)


def _weights(modes: Modes, inner_product: str) -> Array:
    """Square roots (modes, 1) of modal mass, or stiffness."""
    if inner_product == "mass":
        return np.ones((len(modes.omega), 1))
    if modes.omega[0] <= 0:
        raise ValueError('inner_product: "energy" has no meaning for a free body: write "mass"')
    return modes.omega[:, None]


def _size(part: Array) -> float:
    size = float(np.linalg.norm(part))
    if size == 0:
        raise ValueError("pod: the flight stands still: give it another frequency, or more periods")
    return size


EXHAUSTED = 1e-10  # share of a new direction that is left where the space has ended


def krylov(structure: Structure, n: int, frequency: float = 0.0) -> Reduction:
    """The structure in ``n`` directions of the block Krylov space of (K − ω²M)⁻¹M about ``frequency``, Hz.

    It begins with the answers (K − ω²M)⁻¹f to harmonic forces at the contact and by the drive. The undamped transfer
    functions between them then agree at ω in as many derivatives by ω² as there are n directions over the number of
    forces, twice for the contact to itself (Bai & Su, SIAM J. Sci. Comput. 26, 2005; the damping is small, so that the
    space is made without it). M-orthonormal. ValueError where the space has fewer directions (modes that neither
    contact nor drive sees are not in it), at a natural frequency, and for a free body about 0.

    >>> import vibeam
    >>> chain = vibeam.Structure(
    ...     M=[[1, 0], [0, 1]], C=[[0, 0], [0, 0]], K=[[2, -1], [-1, 2]], load=[-1, -1], static=[0, 0], contact=[0, 1]
    ... )
    >>> round(vibeam.krylov(chain, 1).flexibility_kept, 9)  # matched at rest
    1.0
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
    return projection(structure, shapes, K=structure.ritz_stiffness(shapes, forces))


def _norm(structure: Structure, shape: Array) -> float:
    return float(np.sqrt(shape @ (structure.M @ shape)))


def _solver(structure: Structure, frequency: float) -> Callable[[Array], Array]:
    """(K − ω²M)⁻¹ as a function; the static deflection where ω is 0."""
    if frequency == 0:
        return structure.deflection
    matrix: Any = structure.K - (2 * np.pi * frequency) ** 2 * structure.M
    dynamic = structure.with_(K=matrix)
    try:
        dynamic.solved(structure.contact)
    except ValueError as error:
        if str(error) != FREE:
            raise
        raise ValueError(f"frequency: {frequency:g} Hz is a natural frequency: take another") from None
    return dynamic.solved
