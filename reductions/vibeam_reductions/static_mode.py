"""One coordinate: the static deflection under a load at the contact (the paper's φ, eq. 44)."""

from __future__ import annotations

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.structure import Structure
from vibeam_reductions.projection import Reduction, projection


def static_mode(structure: Structure, at: Array | None = None) -> Reduction:
    """The structure in its static deflection under a load on row ``at`` (size,), the contact's by default.

    Scaled so that the output ``"sensor"`` reads 1, or the row ``at`` itself where there is no such output. It keeps all
    of the contact's static flexibility. ValueError where the deflection is zero at that place.
    """
    return projection(structure, static_shape(structure, at))


def static_shape(structure: Structure, at: Array | None = None) -> Array:
    """That deflection, (size, 1)."""
    row = structure.contact if at is None else np.asarray(at, dtype=float)
    shape = structure.deflection(row)
    scale = float(structure.outputs.get("sensor", row) @ shape)
    if abs(scale) <= 1e-12 * np.linalg.norm(shape):
        raise ValueError("static mode: the place it is scaled at does not move")
    return np.asarray((shape / scale)[:, np.newaxis])
