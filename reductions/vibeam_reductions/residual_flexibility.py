"""Free-interface modes and the residual attachment mode of the contact (MacNeal 1971, Rubin 1975)."""

from __future__ import annotations

from vibeam_models.structure import Structure
from vibeam_reductions.projection import Reduction, check_count
from vibeam_reductions.residual import modes_and_residuals


def residual_flexibility(structure: Structure, n: int) -> Reduction:
    """The structure in its lowest n − 1 modes and the residual attachment mode of the contact, with its mass.

    The modes stay exact and the contact's static flexibility is kept whole: the last coordinate has the flexibility
    wK⁻¹wᵀ − Σc²/ω² that the modes leave out, c = wφ. It keeps its own mass ψᵀMψ (Rubin, AIAA J. 13, 1975), so that the
    mobility is finite and a coefficient of restitution has a meaning; MacNeal's form (Comput. Struct. 1, 1971), without
    it, is ``massless_boundary``. ValueError unless 1 ≤ n ≤ size, and for a free body.
    """
    check_count(structure, n)
    return modes_and_residuals(structure, n, {"contact": structure.contact})
