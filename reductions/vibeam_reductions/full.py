"""Nothing left out: all modes."""

from __future__ import annotations

from vibeam_models.structure import Structure
from vibeam_reductions.modal import modal
from vibeam_reductions.projection import Reduction


def full(structure: Structure) -> Reduction:
    """The structure in all of its modes: another form, the same motion."""
    return modal(structure, structure.size)
