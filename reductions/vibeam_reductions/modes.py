"""Natural modes as a basis, alone or with what they leave out of static deflections: residual attachment modes."""

from __future__ import annotations

import numpy as np

from vibeam_models.structure import Structure, in_coordinates
from vibeam_reductions.projection import Reduction, check_count, projection
from vibeam_reductions.static_shapes import static_shapes_under


def modal(structure: Structure, n: int) -> Reduction:
    """The structure in its lowest ``n`` undamped modes, mass-normalised: M = I, K = diag(ω²).

    ValueError unless 1 ≤ n ≤ size.

    >>> import vibeam
    >>> chain = vibeam.Structure(
    ...     M=[[1, 0], [0, 1]], C=[[0, 0], [0, 0]], K=[[2, -1], [-1, 2]], load=[-1, -1], static=[0, 0], contact=[0, 1]
    ... )
    >>> vibeam.modal(chain, 1).structure.K.round(9).tolist()  # ω₁² = 1
    [[1.0]]
    """
    if not 1 <= n <= structure.size:
        raise ValueError(f"modes: {n}, this structure has 1 to {structure.size}")
    modes = structure.modes(n)
    known = {"M": np.eye(n), "C": structure.modal_damping(modes), "K": np.diag(modes.omega**2)}
    return Reduction(modes.shapes, in_coordinates(structure, modes.shapes, **known), structure)


def full(structure: Structure) -> Reduction:
    """The structure in all of its modes: another form, the same motion."""
    return modal(structure, structure.size)


def residual_flexibility(structure: Structure, n: int) -> Reduction:
    """The structure in its lowest n − 1 modes and the residual attachment mode of the contact, with its mass.

    The modes stay exact and the contact's static flexibility is kept whole: the last coordinate has the flexibility
    wK⁻¹wᵀ − Σc²/ω² that the modes leave out, c = wφ. It keeps its own mass ψᵀMψ (Rubin, AIAA J. 13, 1975), so that the
    mobility is finite and a coefficient of restitution has a meaning; MacNeal's form (Comput. Struct. 1, 1971), without
    it, is ``massless_boundary``. ValueError unless 1 ≤ n ≤ size, and for a free body.

    >>> import vibeam
    >>> chain = vibeam.Structure(
    ...     M=[[1, 0], [0, 1]], C=[[0, 0], [0, 0]], K=[[2, -1], [-1, 2]], load=[-1, -1], static=[0, 0], contact=[0, 1]
    ... )
    >>> reduced = vibeam.residual_flexibility(chain, 2)
    >>> reduced.structure.size, round(reduced.flexibility_kept, 9)
    (2, 1.0)
    """
    check_count(structure, n)
    modes = structure.modes(n - 1) if n > 1 else None
    residual = static_shapes_under(structure, {"contact": structure.contact}, modes)
    if not len(residual):  # the modes carry the load wholly: a further one in its place
        return modal(structure, n)
    shapes, squares = residual.shapes, residual.stiffness
    if modes is not None:
        shapes, squares = np.column_stack([modes.shapes, shapes]), np.concatenate([modes.omega**2, squares])
    return projection(structure, shapes, K=np.diag(squares))


def massless_boundary(structure: Structure, n: int) -> Reduction:
    """The structure in its lowest ``n`` modes, and at the contact the flexibility that they leave out, without mass.

    MacNeal's residual flexibility g = wK⁻¹wᵀ − Σc²/ω² has no inertia: the contact's coordinate u = Σcη + g f follows
    the contact force f at once and is eliminated; g is ``contact_flexibility`` of the reduced structure, in series with
    the stop (MacNeal 1971; Monjaraz-Tec, Gross & Krack, Comput. Struct. 260, 2022, arXiv:2111.07693). It takes no
    coordinate and brings no high frequency. It is for a stop that yields: an impulse would move a contact without mass
    at an infinite velocity. ValueError unless 1 ≤ n ≤ size, and for a free body.

    >>> import vibeam
    >>> chain = vibeam.Structure(
    ...     M=[[1, 0], [0, 1]], C=[[0, 0], [0, 0]], K=[[2, -1], [-1, 2]], load=[-1, -1], static=[0, 0], contact=[0, 1]
    ... )
    >>> round(vibeam.massless_boundary(chain, 1).structure.contact_flexibility, 9)  # 2/3 − 1/2
    0.166666667
    """
    kept = modal(structure, n)
    residual = static_shapes_under(structure, {"contact": structure.contact}, structure.modes(n))
    flexibility = float((structure.contact @ residual.shapes) ** 2 @ (1 / residual.stiffness)) if len(residual) else 0.0
    return Reduction(kept.basis, kept.structure.with_(contact_flexibility=flexibility), structure)
