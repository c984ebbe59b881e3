"""Readout of motions under a record: accelerations and jerks at given times."""

from __future__ import annotations

import numpy as np

from vibeam.flight.contacts.readout import derivatives_in
from vibeam.flight.kernels import layout
from vibeam.flight.record.solver import RecordSolver
from vibeam.system.rows import TimeDerivative
from vibeam_models.arrays import Array


def derivative_under(
    solver: RecordSolver, trace: Array, times: Array, poses: Array, wanted: TimeDerivative, more: int
) -> Array:
    """The output ``wanted`` (m,), or its rate (``more`` 1), at ``times`` (m,) with their ``poses`` (m, 2, n).

    At an event the value after it. ValueError for the rate of an acceleration in a contact that is integrated.
    """
    order = wanted.order + more
    if order == 1:
        return np.asarray(poses[:, 1] @ wanted.row)
    loads = solver.course.loads(times)
    which = np.maximum(np.searchsorted(trace[:, layout.START], times, side="right") - 1, 0)
    found = derivatives_in(solver.system, loads, trace[which], poses, wanted.row, order)
    return np.asarray(found - wanted.base * loads[order - 2])
