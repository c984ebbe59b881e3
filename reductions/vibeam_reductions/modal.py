"""The lowest natural modes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vibeam_models.structure import Structure
from vibeam_reductions.projection import Reduction, projection


def modal(structure: Structure, n: int) -> Reduction:
    """The structure in its lowest ``n`` undamped modes, mass-normalised: M = I, K = diag(ω²).

    ValueError unless 1 ≤ n ≤ size.
    """
    if not 1 <= n <= structure.size:
        raise ValueError(f"modes: {n}, this structure has 1 to {structure.size}")
    modes = structure.modes(n)
    reduction = projection(structure, modes.shapes)
    exact = reduction.structure.with_(M=np.eye(n), K=np.diag(modes.omega**2))  # free of the projection's round-off
    return replace(reduction, structure=exact)


def full(structure: Structure) -> Reduction:
    """The structure in all of its modes: another form, the same motion."""
    return modal(structure, structure.size)
