"""Exact boundaries of motions with one impact a period in the plane of a map."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.case.grid_keys import FREQUENCY, GAP, LEVELS
from vibeam.maps.variation import Settings, narrowed, varied
from vibeam.orbits.bifurcation_functions import Kind
from vibeam.orbits.orbit_map import orbit_map

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.plans import AxisPlan
    from vibeam.system.impact_system import ImpactSystem

Array = NDArray[np.float64]

FEWEST, MOST = 41, 81  # points of the grid along each axis, on which boundaries are looked for


@dataclass(frozen=True)
class DrawnBoundary:
    """Part of a boundary with an admissible motion: values of the last axis and of the one above, SI."""

    kind: Kind
    across: Array
    upward: Array


def boundaries_of(
    case: Case, fidelity: str, axes: Sequence[AxisPlan], outer: Settings
) -> tuple[list[DrawnBoundary], str]:
    """Boundaries over the last two of ``axes``, the others as in ``outer``; or why there are none.

    They are known over the drive frequency and either the level of the drive or the gap. A level enters as the base's
    amplitude B(Ω) = level · B₁(Ω): boundaries are found over B and put at B/B₁(Ω), so that they are exact on a platform
    too.
    """
    upward, across = axes[-2:]
    if across.key != FREQUENCY or upward.key not in (GAP, *LEVELS):
        return [], "no exact boundaries: they are known over frequency and drive or gap"
    text = narrowed(case, fidelity)

    def at(*settings: tuple[str, float]) -> Case:
        return varied(text, str(case.path), fidelity, (*outer, *settings))

    system = at().system(fidelity)
    if system.beyond_plain:
        return [], f"no exact boundaries of {fidelity}: no closed form knows {' or '.join(system.beyond_plain)}"
    omega = 2 * np.pi * _grid(across.values)
    if upward.key != GAP:
        return _over_level(at((upward.key, 1.0)), fidelity, system, omega, np.sort(upward.values))
    amplitude = at().amplitude_of(fidelity, omega)
    if np.ndim(amplitude):
        return [], "no exact boundaries over the gap: the amplitude of the base depends on the frequency"
    gaps = [at((GAP, value)).system(fidelity).gap for value in (min(upward.values), max(upward.values))]
    found = orbit_map(system, omega, float(amplitude), gap=np.linspace(gaps[0], gaps[1], len(_grid(upward.values))))
    slope = (max(upward.values) - min(upward.values)) / (gaps[1] - gaps[0])
    return [
        DrawnBoundary(
            curve.kind, curve.omega[part] / (2 * np.pi), min(upward.values) + slope * (curve.gap[part] - gaps[0])
        )
        for curve in found.curves
        for part in _clear(curve.clear)
    ], ""


def _over_level(
    unit: Case, fidelity: str, system: ImpactSystem, omega: Array, levels: Array
) -> tuple[list[DrawnBoundary], str]:
    """Boundaries over frequency and a level of the drive, ``unit``: the case with a level of 1."""
    one = np.broadcast_to(unit.amplitude_of(fidelity, omega), omega.shape)
    known = levels[levels > 0]
    if len(known) < 2 or not np.all(one > 0):
        return [], "no exact boundaries: a range of drives above 0 is needed"
    amplitude = np.linspace(known[0] * one.min(), known[-1] * one.max(), len(_grid(levels)))
    found = []
    for curve in orbit_map(system, omega, amplitude, gap=system.gap).curves:
        level = curve.amplitude / np.broadcast_to(unit.amplitude_of(fidelity, curve.omega), curve.omega.shape)
        found += [
            DrawnBoundary(curve.kind, curve.omega[part] / (2 * np.pi), level[part]) for part in _clear(curve.clear)
        ]
    return found, ""


def _grid(values: Sequence[float] | Array) -> Array:
    """Even grid over the range of an axis, ascending."""
    return np.linspace(min(values), max(values), min(max(len(values), FEWEST), MOST))


def _clear(clear: NDArray[np.bool_]) -> list[NDArray[np.int64]]:
    """Stretches of a curve whose motion keeps clear of the stop between impacts."""
    parts = np.split(np.arange(len(clear)), np.flatnonzero(np.diff(clear)) + 1)
    return [part for part in parts if clear[part[0]]]
