"""Velocities, accelerations and jerks along a motion with several contacts, from its states and the held."""

from __future__ import annotations

import numpy as np

from vibeam.flight.contacts import Contacts
from vibeam.flight.kernels import layout
from vibeam.flight.several.holds import held_in
from vibeam.flight.several.state import Pull
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.time_derivative import TimeDerivative
from vibeam_models.arrays import Array


def derivative_along(
    system: ImpactSystem, drive: Drive, trace: Array, times: Array, poses: Array, wanted: TimeDerivative, more: int = 0
) -> Array:
    """As ``flight.accelerations.derivative_along``: the output (m,), or its rate, at ``times`` with their ``poses``."""
    order, contacts = wanted.order + more, Contacts.of(system)
    if order == 1:
        return np.asarray(poses[:, 1] @ wanted.row)
    which = np.maximum(np.searchsorted(trace[:, layout.START], times, side="right") - 1, 0)
    clocks = trace[which, layout.AT_CLOCK] + times - trace[which, layout.START]
    found = np.empty(len(times))
    for i, (segment, clock) in enumerate(zip(which, clocks.tolist(), strict=True)):
        rows = contacts.rows[list(held_in(trace[segment], len(contacts.gaps)))]
        found[i] = wanted.row @ Pull.of(contacts, drive, poses[i], clock).constrained(rows)[order - 2]
    turn = (np.sin if order == 2 else np.cos)(drive.omega * clocks)
    return np.asarray(found - wanted.base * drive.amplitude * drive.omega**order * turn)
