"""A reduction that a program brings itself, run from a case file."""

from __future__ import annotations

import numpy as np
import pytest
from stand_in import RIG

import vibeam
from vibeam.casefile.read import load
from vibeam_models.structure import Structure
from vibeam_reductions.declaration import REDUCTIONS
from vibeam_reductions.projection import Reduction, projection


def tip_loaded(structure: Structure, n: int) -> Reduction:
    """Static deflection under a load at the tip, and the n − 1 that inertia makes of it one after another."""
    shapes = [np.linalg.solve(structure.K, structure.outputs["tip"])]
    for _ in range(n - 1):
        shapes.append(np.linalg.solve(structure.K, structure.M @ shapes[-1]))
    return projection(structure, np.linalg.qr(np.transpose(shapes))[0])


def test_a_registered_reduction_runs_from_a_case_file() -> None:
    declared = vibeam.ReductionDeclaration("tip_loaded", tip_loaded, "loads at the tip", counts=True)
    vibeam.register_reduction(declared)
    try:
        case = load(RIG, {"fidelity.own": {"reduction": "tip_loaded", "modes": 3}})
        own, beam = case.system("own"), case.system("beam")
        assert own.omega[0] == pytest.approx(beam.omega[0], rel=1e-6)
        with pytest.raises(vibeam.CaseError, match='reduction = "tip_loaded" needs how many'):
            load(RIG, {"fidelity.own": {"reduction": "tip_loaded"}})
    finally:
        REDUCTIONS.remove("tip_loaded")
    with pytest.raises(vibeam.CaseError, match="'tip_loaded' is not one of"):
        load(RIG, {"fidelity.own": {"reduction": "tip_loaded", "modes": 3}})
