"""Free-interface modes and a contact without mass (MacNeal 1971; Monjaraz-Tec, Gross & Krack 2022)."""

from __future__ import annotations

from vibeam_models.structure import Structure
from vibeam_reductions.loads import static_shapes_under
from vibeam_reductions.modal import modal
from vibeam_reductions.projection import Reduction


def massless_boundary(structure: Structure, n: int) -> Reduction:
    """The structure in its lowest ``n`` modes, and at the contact the flexibility that they leave out, without mass.

    MacNeal's residual flexibility g = wK⁻¹wᵀ − Σc²/ω² has no inertia: the contact's coordinate u = Σcη + g f follows
    the contact force f at once and is eliminated; g is ``contact_flexibility`` of the reduced structure, in series with
    the stop (Monjaraz-Tec, Gross & Krack, Comput. Struct. 260, 2022,
    arXiv:2111.07693). It takes no coordinate and brings no high
    frequency. It is for a stop that yields: an impulse would move a contact without mass at an infinite velocity.
    ValueError unless 1 ≤ n ≤ size, and for a free body.
    """
    kept = modal(structure, n)
    residual = static_shapes_under(structure, {"contact": structure.contact}, structure.modes(n))
    flexibility = float((structure.contact @ residual.shapes) ** 2 @ (1 / residual.stiffness)) if len(residual) else 0.0
    return Reduction(kept.basis, kept.structure.with_(contact_flexibility=flexibility), structure)
