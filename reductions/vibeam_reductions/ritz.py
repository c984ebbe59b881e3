"""Reduced stiffness of a basis without the loss of the product ΦᵀKΦ."""

from __future__ import annotations

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.sparse import SparseStructure
from vibeam_models.structure import Structure


def ritz_stiffness(structure: Structure, basis: Array, forces: Array) -> Array:
    """ΦᵀKΦ (n, n) of a ``basis`` Φ (size, n) whose ``forces`` KΦ (size, n) are known.

    As a product it is exact to the round-off of the highest ω², which leaves nothing of the first mode's on a fine
    mesh. Where all natural modes are at hand it is ηᵀω²η with η = modesᵀMΦ, in which an error of a high mode's share
    counts squared; of a sparse structure each entry is taken from the force of the softer of its two shapes.
    """
    if isinstance(structure, SparseStructure):
        return _by_softer(basis, forces)
    modes = structure.modes()
    shares = modes.omega[:, None] * (modes.shapes.T @ (structure.M @ basis))
    product = shares.T @ shares
    return np.asarray((product + product.T) / 2)


def _by_softer(shapes: Array, forces: Array) -> Array:
    product = shapes.T @ forces
    stiffness = np.diag(product)
    lower = np.where(stiffness[None, :] <= stiffness[:, None], product, product.T)
    return np.asarray((lower + lower.T) / 2)
