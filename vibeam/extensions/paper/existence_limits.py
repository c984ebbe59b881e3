"""Existence limits of impacting motions: by averaging (paper eq. 24, 26), and the exact folds beside them.

At one frequency: Q*, the least stable reach at the fidelity's gap, or Δ_MAX, the largest gap, loose or tight, at its
drive. The exact ones are folds of the orbit with one impact a drive period: Q* its reach where it folds as the drive
grows weaker, Δ_MAX the gap at which it folds.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from vibeam.case.case import Case
from vibeam.extensions.paper.averaging import slow_flow
from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.boundaries import Boundary, boundaries
from vibeam.periodic.orbit_search import orbits
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam_models.arrays import Array

Options = Mapping[str, str | float]
BESIDE = 1e-6  # step off a fold, as a share of the drive: the mean of both roots there is its reach
STRONGER = 1e3  # upper end of the search for the weakest drive with orbits, in multiples of the case's drive


def limits(case: Case, fidelity: str, frequency: Array, quantity: str) -> Array:
    """Limit (points,) of one fidelity at ``frequency`` (points,) Hz, NaN where the motion has none."""
    system, omegas = case.system(fidelity), 2 * np.pi * frequency
    amplitudes = np.broadcast_to(case.amplitude_of(fidelity, omegas), omegas.shape)
    averaged = case.fidelities[fidelity].solver == "averaging"
    found = (_averaged if averaged else _exact)(system, amplitudes, omegas, quantity, case.fidelities[fidelity].options)
    return np.asarray(found, dtype=float)


def _averaged(system: ImpactSystem, amplitudes: Array, omegas: Array, quantity: str, options: Options) -> Array:
    chosen: dict[str, Any] = {key: options[key] for key in ("resonance", "damping") if key in options}
    found = []
    for amplitude, omega in zip(amplitudes, omegas, strict=True):
        flow, unit = slow_flow(system, float(amplitude), **chosen)
        limit = flow.largest_gap if quantity == "largest_gap" else flow.least_stable
        found.append(limit(float(omega) / unit))
    values = np.array(found)
    return np.where(values > 0, values, np.nan)


def _exact(system: ImpactSystem, amplitudes: Array, omegas: Array, quantity: str, options: Options) -> Array:
    periods = int(str(options.get("periods", 1)))
    limit = _gap_at_fold if quantity == "largest_gap" else _reach_at_fold
    drives = zip(amplitudes, omegas, strict=True)
    return np.array([limit(system, float(amplitude), float(omega), periods) for amplitude, omega in drives])


def _gap_at_fold(system: ImpactSystem, amplitude: float, omega: float, periods: int) -> float:
    far = 100 * amplitude * float(np.abs(system.contact @ system.load))
    folds = boundaries(system, amplitude, omega, periods, gap=(-far, far), points=1001, kinds=(Kind.FOLD,))
    return max((abs(fold.gap) for fold in folds if fold.clear), default=float("nan"))


def _reach_at_fold(system: ImpactSystem, amplitude: float, omega: float, periods: int) -> float:
    # the motion scales with drive and gap together, so that the weakest drive may lie anywhere
    for most in (amplitude, STRONGER * amplitude):
        folds = boundaries(system, (most * 1e-4, most), omega, periods, points=2001, kinds=(Kind.FOLD,))
        if folds and folds[0].clear:
            return _reach(system, folds[0], omega)
    return float("nan")


def _reach(system: ImpactSystem, fold: Boundary, omega: float) -> float:
    found = orbits(system, Drive(omega, fold.amplitude * (1 + BESIDE)), fold.periods)
    return float(np.mean([orbit.reach for orbit in found])) if len(found) == 2 else float("nan")
