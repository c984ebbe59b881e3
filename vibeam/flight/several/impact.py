"""The impact at several contacts at once: Newton's law, one contact at a time; endless series by their limit.

Rigid contacts that are struck in the same instant have no unique outcome: it depends on which gives way first, of which
a rigid stop says nothing. What is computed here is one choice, the limit of impacts one shortly after another:

- Contacts that approach are struck in turn, the fastest first (of equally fast ones the first declared). Each gets the
  impulse p = −(1 + R) v⁻ / (w M⁻¹ wᵀ) of its own law, which changes the velocities of all others by the mass matrix of
  the contacts, G_ij = w_i M⁻¹ w_jᵀ; a contact that then approaches anew is struck again, until none approaches.
- A contact that is held, pressed by a force, stays where an impulse elsewhere presses it (v⁻ = 0: Newton's law gives it
  v⁺ = 0) and is released where it pulls. Its reaction is the least impulse that keeps it from approaching, so that the
  mobility of the struck contact is that of the system held there.
- A sequence without end is followed until what still approaches is round-off, and that is taken out.

No step adds energy. In the symmetric landing of a bar on two stops this law favours one end; Newton's law with both
impulses at once (Moreau) would not, but gives Newton's cradle wrong, which this one gives right.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vibeam.flight.equilibrium import NOISE, Contacts, multipliers, one_sided
from vibeam.flight.kernels.layout import FAITHFUL, FLOOR, LATE, NEAR, NEAR_MODES
from vibeam.flight.several.state import Pull
from vibeam_models.arrays import Array

ENDLESS = 100_000  # impulses in one instant
TIED = 1e-12  # share of the fastest approach by which another may be slower and still count as equally fast


@dataclass(frozen=True)
class Strike:
    """One impulse: at which contact, its velocity before, and all modal velocities after it."""

    contact: int
    before: float
    velocity: Array


def strikes(contacts: Contacts, velocity: Array, touched: list[int], held: list[int]) -> list[Strike]:
    """The impulses of one instant, in turn: ``touched`` are at their stops, ``held`` those that a force presses."""
    found: list[Strike] = []
    pressed, first = list(held), float(np.max(contacts.approaches(velocity)[touched], initial=0.0))
    while len(found) < ENDLESS:
        struck = _next(contacts, velocity, [j for j in touched if j not in pressed], first)
        if struck is None:
            return found
        before = float(contacts.rows[struck] @ velocity)
        direction = _direction(contacts, struck, pressed)
        along = contacts.rows @ direction
        impulse = (1.0 + float(contacts.restitutions[struck])) * before / float(along[struck])
        velocity = difference(velocity, impulse * direction)
        size = np.abs(contacts.rows) @ np.abs(direction)
        pressed = [j for j in pressed if along[j] <= NOISE * size[j]]
        velocity = stopped(contacts.rows[pressed], velocity) if pressed else velocity
        found.append(Strike(struck, before, velocity))
    return found


def _next(contacts: Contacts, velocity: Array, free: list[int], first: float) -> int | None:
    """The contact that approaches fastest; None where none does beyond round-off."""
    speeds = contacts.approaches(velocity)
    fastest = float(np.max(speeds[free], initial=0.0))
    if fastest <= NOISE * first or fastest == 0.0:
        return None
    return next(j for j in free if speeds[j] >= (1 - TIED) * fastest)


def _direction(contacts: Contacts, struck: int, pressed: list[int]) -> Array:
    """Change of the velocities by a unit impulse at one contact, less sign, with the pressed ones answering."""
    row: Array = contacts.rows[struck]
    if not pressed:
        return row
    rows = contacts.rows[pressed]
    return np.asarray(row + one_sided(rows, -row) @ rows)


def stopped(rows: Array, velocity: Array) -> Array:
    """The velocity with none along the rows, taken out by the least impulse."""
    return difference(velocity, (multipliers(rows) @ velocity) @ rows)


def difference(a: Array, b: Array) -> Array:
    """a − b, and 0 where that is no more than their round-off: one mode brought to rest lies still."""
    left = a - b
    return np.where(np.abs(left) > NOISE * np.abs(b), left, 0.0)


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
