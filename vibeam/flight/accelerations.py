"""Accelerations and jerks along a motion, from its states: with the force of the stop that holds or pushes."""

from __future__ import annotations

import numpy as np

from vibeam.flight.derivatives import FREE, HELD, PUSHED, Derivatives, stop_of
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.time_derivative import TimeDerivative
from vibeam_models.arrays import Array
from vibeam_models.laws.compliant import HuntCrossley


def derivative_along(
    system: ImpactSystem, drive: Drive, trace: Array, times: Array, poses: Array, wanted: TimeDerivative, more: int = 0
) -> Array:
    """The output ``wanted`` (m,), or its rate (``more`` 1), at ``times`` (m,) with their ``poses`` (m, 2, n).

    At an event the value after it. ValueError for the rate of an acceleration in a contact that is integrated.
    """
    order = wanted.order + more
    if order == 1:
        return np.asarray(poses[:, 1] @ wanted.row)
    which = np.maximum(np.searchsorted(trace[:, layout.START], times, side="right") - 1, 0)
    clocks = trace[which, layout.AT_CLOCK] + times - trace[which, layout.START]
    found = _modal(system, drive, trace[which], clocks, poses, order) @ wanted.row
    return np.asarray(found + _of_base(drive, clocks, order, wanted.base))


def _of_base(drive: Drive, clocks: Array, order: int, share: float) -> Array:
    """The derivative of B sin φ of ``order`` 2 or 3, times ``share``."""
    turn = (np.sin if order == 2 else np.cos)(drive.omega * clocks)
    return np.asarray(-share * drive.amplitude * drive.omega**order * turn)


def _modal(system: ImpactSystem, drive: Drive, rows: Array, clocks: Array, poses: Array, order: int) -> Array:
    """η'' or η''' (m, n) at states in the segments ``rows`` (m, columns) of a trace."""
    sides = (
        rows[:, regime_layout.AT_SIDE].astype(np.int64)
        if rows.shape[1] > layout.TRACE_COLUMNS
        else np.zeros(len(rows), dtype=np.int64)
    )
    found = np.empty((len(rows), system.size))
    for kind, side in {(float(kind), int(side)) for kind, side in zip(rows[:, layout.WHAT], sides, strict=True)}:
        here = (rows[:, layout.WHAT] == kind) & (sides == side)
        found[here] = _in_regime(system, drive, kind, side, poses[here], clocks[here], order)
    return found


def _in_regime(
    system: ImpactSystem, drive: Drive, kind: float, side: int, poses: Array, clocks: Array, order: int
) -> Array:
    if kind == regime_layout.CONTACT and isinstance(system.law, HuntCrossley):
        if order > 2:
            raise ValueError(f"the jerk in a contact that is integrated, {system.law.name!r}, is not read")
        row, gap = stop_of(system, side)
        deep, rate = np.maximum(poses[:, 0] @ row - gap, 0.0), poses[:, 1] @ row
        force = system.law.stiffness * deep**system.law.exponent * (1 + system.law.damping * rate)
        free = Derivatives(system, drive, FREE, side, poses, clocks).known[order].value
        return np.asarray(free - np.maximum(force, 0.0)[:, None] * row)
    regime = HELD if kind == layout.RESTING else PUSHED if kind == regime_layout.CONTACT else FREE
    return Derivatives(system, drive, regime, side, poses, clocks).known[order].value
