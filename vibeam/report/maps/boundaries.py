"""Exact boundaries of motions with one impact a period in the plane of a map."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.case.grid_keys import FREQUENCY, GAP, LEVELS
from vibeam.casefile.case_model import narrowed
from vibeam.maps.boundaries import boundaries_over
from vibeam.maps.variation import Settings, varied
from vibeam.orbits.bifurcation_functions import Kind

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

    They are known over the drive frequency and either the level of the drive or the gap, on a platform too.
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
    own = at()
    low, high = (at((GAP, value)).system(fidelity).gap for value in (min(upward.values), max(upward.values)))
    gaps, slope = np.linspace(low, high, len(_grid(upward.values))), np.ptp(upward.values) / (high - low)
    if not np.all(own.amplitude_of(fidelity, omega)):
        return [], "no exact boundaries: a drive above 0 is needed"
    found = boundaries_over(system, "gap", omega, gaps, low, lambda at_: np.asarray(own.amplitude_of(fidelity, at_)))
    return [
        DrawnBoundary(each.kind, each.frequency, min(upward.values) + slope * (each.value - low)) for each in found
    ], ""


def _over_level(
    unit: Case, fidelity: str, system: ImpactSystem, omega: Array, levels: Array
) -> tuple[list[DrawnBoundary], str]:
    """Boundaries over frequency and a level of the drive, ``unit``: the case with a level of 1."""
    known = levels[levels > 0]
    if len(known) < 2 or not np.all(unit.amplitude_of(fidelity, omega)):
        return [], "no exact boundaries: a range of drives above 0 is needed"
    rows = np.linspace(known[0], known[-1], len(_grid(levels)))
    found = boundaries_over(
        system, "amplitude", omega, rows, system.gap, lambda at: np.asarray(unit.amplitude_of(fidelity, at))
    )
    return [DrawnBoundary(each.kind, each.frequency, each.value) for each in found], ""


def _grid(values: Sequence[float] | Array) -> Array:
    """Even grid over the range of an axis, ascending."""
    return np.linspace(min(values), max(values), min(max(len(values), FEWEST), MOST))
