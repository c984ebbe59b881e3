"""Contact time of a stop that yields: half a period of the mode in contact that holds most of the stop's energy."""

from __future__ import annotations

import numpy as np

from vibeam.studies.reduce.transfer import ModalForm
from vibeam_models.laws.compliant import LinearStop


def contact_time(form: ModalForm, law: LinearStop) -> float:
    """Contact time in s of a linear stop on a structure, without the stop's damping.

    With the spring k at the contact row c the modes are those of diag(ω²) + k cᵀc; the share of mode i's energy that
    is in the spring is k (cφ_i)²/ω_i². T = π/ω of the one with the largest share.
    """
    c = form.row(form.structure.contact)
    squared, shapes = np.linalg.eigh(np.diag(form.omega**2) + law.stiffness * np.outer(c, c))
    shares = law.stiffness * (c @ shapes) ** 2 / squared
    return float(np.pi / np.sqrt(squared[np.argmax(shares)]))
