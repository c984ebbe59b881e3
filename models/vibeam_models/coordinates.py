"""A change of coordinates: the one congruence behind every constraint and every projection."""

from __future__ import annotations

from vibeam_models.structure import Array, Structure


def in_coordinates(structure: Structure, basis: Array) -> Structure:
    """The structure in coordinates y with x = basis @ y, ``basis`` (n, fewer): BᵀMB, Bᵀload, w B …"""
    return structure.with_(
        M=_congruent(structure.M, basis),
        C=_congruent(structure.C, basis),
        K=_congruent(structure.K, basis),
        load=structure.load @ basis,
        static=structure.static @ basis,
        contact=structure.contact @ basis,
        outputs={name: row @ basis for name, row in structure.outputs.items()},
    )


def _congruent(matrix: Array, basis: Array) -> Array:
    product = basis.T @ matrix @ basis
    return (product + product.T) / 2
