"""The subspace that holds a flight of the full model, by orthogonal decomposition."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.structure import Modes, Structure
from vibeam_reductions.projection import Reduction, check_count, projection

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
