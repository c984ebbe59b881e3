"""An endless series of impacts at one contact, completed by its geometric limit: as ``kernels.impact``, others held."""

from __future__ import annotations

import numpy as np

from vibeam.flight.contacts import Contacts
from vibeam.flight.several.state import Pull
from vibeam_models.arrays import Array

NEAR, NEAR_MODES = 1e-11, 4e-15  # shares of the length scale, of one mode and of more: see ``kernels.impact``
FAITHFUL, LATE, FLOOR = 1e-11, 1e-12, 1e-26  # as there


def time_left(
    contacts: Contacts, pull: Pull, held: list[int], which: int, after: float, top: float, slowest: float
) -> tuple[float, float]:
    """Time T = 2v⁺ / (a (1 − R)) that the rest of an accumulation at one contact takes, and a bound of its error.

    (−1, 0) where it is too early, or where there is none. ``after``: the velocity after the last impact; ``top``: the
    largest before one; ``slowest``: the slowest rate, rad/s. Criteria as ``kernels.impact.time_left``: Nordmark &
    Piiroinen 2009, to first order.
    """
    row, coefficient = contacts.rows[which], float(contacts.restitutions[which])
    acceleration, _, _ = pull.constrained(contacts.rows[held])
    toward, loss = float(row @ acceleration), 1.0 - coefficient
    if toward <= 0 or loss <= 0 or top <= 0:
        return -1.0, 0.0
    left, length = 2.0 * after / (toward * loss), top * (top / toward)
    _, parts = contacts.clearances(pull.pose[0])
    change = _jerk(contacts, pull, row) * left / toward
    remainder = left * change
    if after * left < FLOOR * length:
        return left, remainder
    late = remainder > FAITHFUL * coefficient * 2.0 * (top / toward) / loss or remainder * slowest > LATE
    near = (NEAR if len(row) == 1 else NEAR_MODES) * max(length, float(parts[which]))
    return (-1.0, 0.0) if late or after * left > near or change > 0.1 else (left, remainder)


def _jerk(contacts: Contacts, pull: Pull, row: Array) -> float:
    """About the most that the contact's jerk may be from here on: mode by mode, of amplitude and rate."""
    omega, displacement, velocity = contacts.system.omega, *np.abs(pull.pose)
    rate = omega + np.diag(contacts.damper)
    swing = rate**2 * (rate * displacement + velocity)
    return float(np.abs(row) @ (swing + rate * pull.size + np.abs(pull.drive_rate)))
