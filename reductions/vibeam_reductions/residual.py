"""Natural modes and what they leave out of the static deflections under given loads: residual attachment modes."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.structure import Modes, Structure
from vibeam_reductions.loads import StaticShapes, static_shapes_under
from vibeam_reductions.projection import Reduction, projection


def modes_and_residuals(structure: Structure, n: int, loads: Mapping[str, Array]) -> Reduction:
    """The structure in its lowest modes and one residual attachment mode a load, ``n`` in all.

    The residuals are M- and K-orthogonal to the modes, which stay exact. A load that the modes carry wholly has none;
    a further mode is taken in its place.
    """
    count = min(len(loads), n)
    while True:
        modes, residuals = _split(structure, n - count, loads)
        if len(residuals) >= count:
            break
        count = len(residuals)
    stiffness = np.concatenate([modes.omega**2, residuals.stiffness[:count]])
    basis = np.column_stack([modes.shapes, residuals.shapes[:, :count]])
    return projection(structure, basis, K=np.diag(stiffness))


def _split(structure: Structure, count: int, loads: Mapping[str, Array]) -> tuple[Modes, StaticShapes]:
    if not count:
        none = Modes(np.zeros(0), np.zeros((structure.size, 0)))
        return none, static_shapes_under(structure, loads)
    modes = structure.modes(count)
    return modes, static_shapes_under(structure, loads, modes)
