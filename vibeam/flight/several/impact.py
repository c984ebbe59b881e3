"""The impact at several contacts at once: Newton's law, one contact at a time.

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

from vibeam.flight.contacts import NOISE, Contacts, multipliers, one_sided
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
        velocity = _stopped(contacts, velocity, pressed)
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
    """What a unit impulse at one contact does to the velocities, less sign, with the pressed ones answering."""
    row: Array = contacts.rows[struck]
    if not pressed:
        return row
    rows = contacts.rows[pressed]
    return np.asarray(row + one_sided(rows, -row) @ rows)


def _stopped(contacts: Contacts, velocity: Array, pressed: list[int]) -> Array:
    """The velocity with none at the contacts that stay."""
    return stopped(contacts.rows[pressed], velocity) if pressed else velocity


def stopped(rows: Array, velocity: Array) -> Array:
    """The velocity with none along the rows, taken out by the least impulse."""
    return difference(velocity, (multipliers(rows) @ velocity) @ rows)


def difference(a: Array, b: Array) -> Array:
    """a − b, and 0 where that is no more than their round-off: one mode brought to rest lies still."""
    left = a - b
    return np.where(np.abs(left) > NOISE * np.abs(b), left, 0.0)
