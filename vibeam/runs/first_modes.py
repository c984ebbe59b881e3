"""First modes of a system with the contact open and closed, and its gap at rest."""

from __future__ import annotations

from math import nan, pi
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from vibeam.system.impact_system import ImpactSystem

MOST = 32  # modes that the closed contact is made of


def open_frequencies(system: ImpactSystem) -> tuple[float, float, float]:
    """Frequencies of the first two modes in Hz (NaN: there is none), damping ratio of the first."""
    order = np.argsort(system.omega)[:2]
    first, second = [float(each) / (2 * pi) for each in system.omega[order]] + [nan] * (2 - len(order))
    return first, second, float(system.zeta[order[0]])


def closed_frequency(system: ImpactSystem) -> float:
    """Frequency of the first mode in Hz with the contact held at rest; NaN of one mode, which that leaves no motion.

    The modes are those of Ω² in the coordinates that are orthogonal to the contact's row.
    """
    order = np.argsort(system.omega)[:MOST]
    rates, contact = system.omega[order], system.contact[order]
    held = np.isfinite(rates)
    rates, contact = rates[held], contact[held]
    if len(rates) < 2 or not contact.any():
        return nan
    free = np.linalg.qr(contact[:, None], mode="complete")[0][:, 1:]
    lowest = np.linalg.eigvalsh(free.T @ (rates[:, None] ** 2 * free))[0]
    return float(np.sqrt(max(lowest, 0.0)) / (2 * pi))


def gap_at_rest(system: ImpactSystem) -> float:
    """Gap that is left where the static loads have bent the open system, in m (or the unit of the motion)."""
    held = system.omega > 0
    return float(system.gap - system.contact[held] @ (system.static[held] / system.omega[held] ** 2))
