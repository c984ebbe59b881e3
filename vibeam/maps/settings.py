"""System and drive at any value of one axis, between the points of a grid too: what a branch is followed along."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.case.grid_keys import FREQUENCY
from vibeam.system.impact_system import Drive, ImpactSystem

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.maps.points import GridPoints
    from vibeam.orbits.train_branch import Setting

Array = NDArray[np.float64]

STRAIGHT = 1e-12  # share by which numbers of the points may be off a straight line over the axis


def setting_along(case: Case, fidelity: str, key: str, values: Array, points: GridPoints) -> Setting | None:
    """System and drive over the ``values`` of an axis whose ``points`` are given.

    Over the frequency as the case says; over any other key by straight lines through the numbers of the points. None
    where these are not straight, where the key changes the modes, for modes without stiffness, and on an axis of one
    value.
    """
    system = points.systems[0]
    if len(points.systems) > 1 or np.any(system.omega == 0) or np.ptp(values) == 0:
        return None
    if key == FREQUENCY:
        held = points.system_at(0)
        return lambda value: (held, Drive(2 * np.pi * value, _amplitude(case, fidelity, value)))
    restitution = np.full(values.shape, system.restitution) if points.restitution is None else points.restitution[0]
    rows = np.array([points.omega[0], points.amplitude[0], points.gap[0], restitution])
    if np.any(np.abs(_between(rows, values, values) - rows) > STRAIGHT * np.abs(rows).max(axis=1, keepdims=True)):
        return None

    def setting(value: float) -> tuple[ImpactSystem, Drive]:
        omega, amplitude, gap, rebound = _between(rows, values, np.array([value]))[:, 0].tolist()
        return replace(system, gap=gap, restitution=rebound), Drive(omega, amplitude)

    return setting


def _between(rows: Array, values: Array, wanted: Array) -> Array:
    """Straight lines from the first to the last value, (rows, wanted)."""
    share = (wanted - values[0]) / (values[-1] - values[0])
    return np.asarray(rows[:, :1] * (1 - share) + rows[:, -1:] * share)


def _amplitude(case: Case, fidelity: str, frequency: float) -> float:
    return float(np.broadcast_to(case.amplitude_of(fidelity, 2 * np.pi * np.array([frequency])), 1)[0])
