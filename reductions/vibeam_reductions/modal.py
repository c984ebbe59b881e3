"""The lowest natural modes."""

from __future__ import annotations

import numpy as np

from vibeam_models.structure import Structure, in_coordinates
from vibeam_reductions.projection import Reduction


def modal(structure: Structure, n: int) -> Reduction:
    """The structure in its lowest ``n`` undamped modes, mass-normalised: M = I, K = diag(ω²).

    ValueError unless 1 ≤ n ≤ size.
    """
    if not 1 <= n <= structure.size:
        raise ValueError(f"modes: {n}, this structure has 1 to {structure.size}")
    modes = structure.modes(n)
    exact = in_coordinates(structure, modes.shapes, M=np.eye(n), K=np.diag(modes.omega**2))
    return Reduction(modes.shapes, exact, structure)


def full(structure: Structure) -> Reduction:
    """The structure in all of its modes: another form, the same motion."""
    return modal(structure, structure.size)
