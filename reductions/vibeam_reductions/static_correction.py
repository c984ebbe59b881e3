"""Natural modes with the static correction of every load (modal truncation augmentation)."""

from __future__ import annotations

from vibeam_models.structure import Structure
from vibeam_reductions.loads import loads_of, static_shapes_under
from vibeam_reductions.projection import Reduction, check_count
from vibeam_reductions.residual import modes_and_residuals


def static_correction(structure: Structure, n: int) -> Reduction:
    """The structure in its lowest modes and the residual deflections under contact, drive and constant load, n in all.

    What the mode acceleration method adds to a response afterwards is here a coordinate of its own (Dickens, Nakagawa &
    Wittbrodt, Comput. Struct. 62, 1997). ValueError where n is less than the number of loads or more than the size,
    and for a free body.
    """
    loads = loads_of(structure, outputs=False)
    independent = {name: loads[name] for name in static_shapes_under(structure, loads).names}
    check_count(structure, n, len(independent), f": its loads are {', '.join(independent)}")
    return modes_and_residuals(structure, n, independent)
