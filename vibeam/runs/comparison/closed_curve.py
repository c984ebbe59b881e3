"""Amplitude of a model's closed-form motions at a few frequencies of a sweep, and its largest over all of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vibeam.flight.solver import FlightSolver
from vibeam.runs.accuracy.candidates import Candidate
from vibeam.runs.accuracy.closed_forms import KINDS, ClosedForms
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, Index

POINTS = 16  # frequencies evaluated at once, evenly spread


@dataclass(frozen=True, eq=False)
class ClosedCurve:
    """Amplitudes (points, kinds) at the frequencies ``which`` of the grid, NaN where there is no stable motion.

    The kinds are those of ``closed_forms``: one impact a drive period, harder or softer, or none, clear of the stop in
    between. ``peak``: the largest over the whole grid, NaN without any.
    """

    which: Index
    amplitude: Array
    peak: float


def closed_curve(system: ImpactSystem, omega: Array, base: Array, output: str) -> ClosedCurve:
    """Closed-form motions of a plain system over ``omega`` (rad/s, ascending), under base motion ``base`` (m)."""
    flight, which = FlightSolver(system, float(omega[0])), _spread(0, len(omega) - 1)
    found = amplitudes(flight, omega[which], base[which], output, KINDS)
    if not np.isfinite(found).any():
        return ClosedCurve(which, found, np.nan)
    kind = int(np.nanargmax(found)) % len(KINDS)
    low, high, height = 0, len(omega) - 1, float(np.nanmax(found))
    near, values = which, found[:, kind]
    while len(near) < high - low + 1:  # the neighbours of the highest, until they are next to it on the grid
        top = int(np.nanargmax(values))
        low, high = int(near[max(top - 1, 0)]), int(near[min(top + 1, len(near) - 1)])
        near = _spread(low, high)
        values = amplitudes(flight, omega[near], base[near], output, (kind,))[:, kind]
        height = max(height, float(np.nanmax(values)))
    return ClosedCurve(which, found, height)


def _spread(low: int, high: int) -> Index:
    return np.unique(np.linspace(low, high, min(POINTS, high - low + 1)).round().astype(int))


def amplitudes(flight: FlightSolver, omega: Array, base: Array, output: str, kinds: Sequence[int]) -> Array:
    """Amplitude of the stable closed-form motions (points, kinds); NaN where there is none, or it was not asked for."""
    known = ClosedForms(flight.system, omega, base)
    orbit = Candidate("", "orbit", known, ("amplitude",), output, flight)
    every, found = np.arange(len(omega)), np.full((len(omega), len(KINDS)), np.nan)
    for kind in kinds:
        if known.exists[:, kind].any():
            found[:, kind] = orbit.evaluate(every, kind).response.amplitude
    return found
