"""Readout of motions with several contacts: holds, and derivatives along them."""

from __future__ import annotations

import numpy as np

from vibeam.flight.contacts.sets import ConstrainedSystem, ContactSet
from vibeam.flight.equilibrium import Contacts, multipliers
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.contacts.layout import HELD_AT, PUSHED_AT
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam_models.arrays import Array


def holds_of(trace: Array, end: float, contact: int | None) -> Array:
    """(m, 2): begin and end, s, of the stretches of a motion until ``end`` in which a contact, or any, was held.

    A hold begins where the accumulation of impacts before it is over.
    """
    bits = trace[:, HELD_AT].astype(np.int64)
    held = (bits if contact is None else bits >> contact & 1) > 0
    change = np.diff(np.concatenate([[False], held, [False]]).astype(int))
    times, first = np.append(trace[:, layout.START], end), np.flatnonzero(change == 1)
    before = trace[np.maximum(first - 1, 0)]
    accumulated = (first > 0) & (before[:, layout.END] == layout.CHATTER)
    accumulated &= (contact is None) | (before[:, regime_layout.AT_SIDE] == contact)
    return np.stack([times[first] + np.where(accumulated, before[:, layout.LEFT], 0.0), times[change == -1]], axis=1)


def keys_of(trace: Array, contacts: int) -> Array:
    """Key of the set of each segment (m,), see ``ContactEngine.sets``."""
    return np.asarray(trace[:, HELD_AT] + float(1 << contacts) * trace[:, PUSHED_AT]).astype(np.int64)


def derivatives_in(system: ImpactSystem, loads: Array, rows: Array, poses: Array, row: Array, order: int) -> Array:
    """Derivative of the ``order`` 2 or 3 of what a ``row`` reads, at states in the segments ``rows`` of a trace.

    ``loads`` (2, m): what the modes' load is multiplied by, and its rate.
    """
    contacts, found = Contacts.of(system), np.empty(len(rows))
    keys = keys_of(rows, len(contacts.gaps))
    for key in np.unique(keys):
        here = keys == key
        which = ContactSet.of(int(key), len(contacts.gaps))
        found[here] = _in_set(contacts, which, loads[:, here], poses[here], order) @ row
    return found


def loads_of(drive: Drive, clocks: Array) -> Array:
    """Ω²B sin φ and its rate (2, m) at times in the drive period."""
    strength, phase = drive.omega**2 * drive.amplitude, drive.omega * clocks
    return np.array([strength * np.sin(phase), strength * (drive.omega * np.cos(phase))])


def _in_set(contacts: Contacts, which: ContactSet, loads: Array, poses: Array, order: int) -> Array:
    """Second or third derivative (m, n) of η in one set; ValueError for the third where contact is integrated."""
    system, held = ConstrainedSystem(contacts, which), contacts.rows[list(which.held)]
    free = np.eye(poses.shape[2]) - (multipliers(held).T @ held if len(held) else 0.0)
    load = contacts.system.load
    pull = np.outer(loads[0], load) + system.static - poses[:, 1] @ system.damper - poses[:, 0] @ system.stiffness
    curved = [j for j in which.pushed if contacts.laws[j].integrated]
    for j in curved:
        deep, rate = np.maximum(poses[:, 0] @ contacts.rows[j] - contacts.gaps[j], 0.0), poses[:, 1] @ contacts.rows[j]
        pull -= contacts.laws[j].force(deep, rate)[:, None] * contacts.rows[j]
    second = pull @ free
    if curved and order > 2:
        raise ValueError(f"the jerk in a contact that is integrated, {contacts.laws[curved[0]].name!r}, is not read")
    if order == 2:
        return np.asarray(second)
    rate = np.outer(loads[1], load) - second @ system.damper - poses[:, 1] @ system.stiffness
    return np.asarray(rate @ free)
