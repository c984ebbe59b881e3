"""Quantities of a response over frequency: the stored ones, and the reach of the output, which follows from them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.case.fidelity import gap_drift

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.system.impact_system import ImpactSystem
    from vibeam.system.response import FrequencyResponse

Array = NDArray[np.float64]


def values_of(case: Case, fidelity: str, response: FrequencyResponse, quantity: str) -> Array:
    """Quantity (points,) of a fidelity's response; ``output_reach``: Q = Δ − min of the sweep's output, Δ its gap."""
    if quantity == "output_reach":
        return gap_of_output(case, fidelity, response.omega) - response.minimum
    return np.asarray(getattr(response, quantity), dtype=float)


def gap_of_output(case: Case, fidelity: str, omega: Array) -> Array:
    """Displacement (points,) of the sweep's output where the beam, pushed slowly, just touches the stop, at ``omega``.

    At the sensor this is the paper's ΔG, the measured grazing amplitude.
    """
    system, drift = case.system(fidelity), gap_drift(case.scene_of(fidelity), omega)
    added = np.zeros(len(omega)) if drift is None else drift
    return touching(system, case.sweep.output, system.gap + added)


def touching(system: ImpactSystem, output: str, gap: Array) -> Array:
    """Displacement of an output at static contact with a stop at ``gap``, under a force at the contact."""
    row, softness = system.output(output), _softness(system)
    place, ratio = (float(row @ softness @ each) for each in (system.static, system.contact))
    contact = float(system.contact @ softness @ system.static)
    return np.asarray(place + ratio / float(system.contact @ softness @ system.contact) * (gap - contact))


def _softness(system: ImpactSystem) -> Array:
    """Static displacements for unit forces on the modes; a mode without stiffness counts as far softer than all."""
    stiff = system.omega**2
    least = 1e-12 * float(stiff.max())
    return np.diag(1 / np.maximum(stiff, least))
