"""Inertia concentrated in one coordinate: a point mass on a deflection, a rotary inertia on a slope."""

from __future__ import annotations

import numpy as np

from vibeam_models.structure import Array, Structure


def with_inertia(structure: Structure, row: Array, inertia: float, translation: float) -> Structure:
    """The structure with ``inertia`` (kg, or kg m² on a slope) on the coordinate row·x, ``row`` (n,).

    ``translation``: what the coordinate reads when the base moves by 1 m: 1 for a deflection, 0 for a slope.
    """
    mass = structure.M + inertia * np.outer(row, row)
    return structure.with_(M=mass, load=structure.load - inertia * translation * row)
