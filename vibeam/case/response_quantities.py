"""Quantities of a response over frequency: the stored ones, and the reach of the output, which follows from them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.fidelity import gap_drift
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.system.impact_system import ImpactSystem
    from vibeam.system.response import FrequencyResponse


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
    row, pushed = system.output(output), static_shape(system, system.contact)
    sagged = static_shape(system, system.static)
    force = (gap - float(system.contact @ sagged)) / float(system.contact @ pushed)
    return np.asarray(float(row @ sagged) + float(row @ pushed) * force)


def static_shape(system: ImpactSystem, force: Array) -> Array:
    """Static displacements (n,) of the modes under forces (n,); one without stiffness counts as far softer than all."""
    stiffness = system.omega**2
    return np.asarray(force / np.maximum(stiffness, 1e-12 * (float(stiffness.max()) or 1.0)))
