"""The static mode enriched: static deflections under loads at the contact, of the drive, on masses, at sensors."""

from __future__ import annotations

import numpy as np

from vibeam_models.structure import Structure
from vibeam_reductions.loads import loads_of, static_shapes_under
from vibeam_reductions.projection import Reduction, projection


def static_shapes(structure: Structure, n: int) -> Reduction:
    """The structure in its static deflections under the first ``n`` independent loads.

    In this order: a force at the contact, the drive's load, the constant one, forces and moments where a mass or a
    moment of inertia is attached, forces at the outputs. ValueError where there are fewer, and for a free body.
    """
    found = static_shapes_under(structure, loads_of(structure))
    if not 1 <= n <= len(found):
        raise ValueError(f"modes: {n}, this structure has 1 to {len(found)} static shapes: {', '.join(found.names)}")
    return projection(structure, found.shapes[:, :n], K=np.diag(found.stiffness[:n]))
