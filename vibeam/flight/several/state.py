"""The next state of contacts that are touched: held by a force, drawn away, or left with a velocity.

Which of them are held is Gauss' principle of least constraint: the accelerations are as near to those of free motion,
in the metric of the mass, as stops that only push allow. Where an acceleration is round-off the jerk decides.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from vibeam.flight.equilibrium import NOISE, Contacts, multipliers, one_sided, within
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.system.impact_system import Drive
from vibeam_models.arrays import Array

Start = tuple[float, float]  # order of the root with which a signal starts, and the derivative of that order


@dataclass(frozen=True)
class ContactState:
    """Contacts that are held, how gaps (and forces of the held) start, and contacts that others hold at their stops."""

    held: tuple[int, ...] = ()
    starts: Mapping[int, Start] = field(default_factory=dict)
    implied: frozenset[int] = frozenset()


@dataclass(frozen=True)
class Pull:
    """Free acceleration (n,) of a pose, its time derivative as far as the drive goes, and the sizes of their parts."""

    contacts: Contacts
    pose: Array
    acceleration: Array
    size: Array
    drive_rate: Array

    @classmethod
    def of(cls, contacts: Contacts, drive: Drive, pose: Array, clock: float) -> Pull:
        """The pull on all modes at a time within the drive's period."""
        system, phase = contacts.system, drive.omega * clock
        force = system.load * (drive.omega**2 * drive.amplitude)
        parts = (force * np.sin(phase), system.static, -contacts.damper @ pose[1], -contacts.spring * pose[0])
        size = np.abs(force) + np.abs(system.static) + np.abs(contacts.damper) @ np.abs(pose[1]) + np.abs(parts[3])
        return cls(contacts, pose, sum(parts[1:], parts[0]), size, force * (drive.omega * np.cos(phase)))

    def constrained(self, rows: Array) -> tuple[Array, Array, Array]:
        """Acceleration and jerk (n,) with the rows held, and the sizes of the jerk's parts."""
        acceleration = _along(rows, self.acceleration)
        contacts = self.contacts
        jerk = self.drive_rate - contacts.damper @ acceleration - contacts.spring * self.pose[1]
        size = np.abs(self.drive_rate) + np.abs(contacts.damper) @ self.size + contacts.spring * np.abs(self.pose[1])
        return acceleration, _along(rows, jerk), size + contacts.system.omega * self.size


def _along(rows: Array, vector: Array) -> Array:
    return vector - (multipliers(rows) @ vector) @ rows if len(rows) else vector


def pressing(contacts: Contacts, pull: Pull, held: tuple[int, ...]) -> list[int]:
    """Those of the contacts held whose force is none that round-off could have made."""
    if not held:
        return []
    each = multipliers(contacts.rows[list(held)])
    found = each @ pull.acceleration > NOISE * (np.abs(each) @ pull.size)
    return [j for j, pressed in zip(held, found, strict=True) if pressed]


def next_state(
    contacts: Contacts, pull: Pull, touched: list[int], leaving: frozenset[int] = frozenset(), least: float = 0.0
) -> ContactState:
    """State of ``touched`` contacts; those ``leaving`` are at the root of their force, speeds up to ``least`` none."""
    speeds = contacts.approaches(pull.pose[1])
    speeds = np.where(np.abs(speeds) > least, speeds, 0.0)
    starts: dict[int, Start] = {j: (1.0, -float(speeds[j])) for j in touched if speeds[j] < 0}
    still = [j for j in touched if j not in starts]
    if not still:
        return ContactState((), starts)
    pressed = one_sided(contacts.rows[still], pull.acceleration) > 0
    held = [j for j, pushes in zip(still, pressed, strict=True) if pushes and j not in leaving]
    gone = set(leaving)
    for _ in range(4 * len(still) + 4):
        settled, implied = _starts(contacts, pull, still, held, gone)
        changed = [j for j, start in settled.items() if start is None]
        if not changed:
            break
        _exchange(changed[0], held, gone)
    known = {j: start for j, start in settled.items() if start is not None and start[0] != 0}
    return ContactState(tuple(held), starts | known, frozenset(implied))


def _exchange(j: int, held: list[int], gone: set[int]) -> None:
    if j in held:
        held.remove(j)
        gone.add(j)
    else:
        held.append(j)
        held.sort()
        gone.discard(j)


def _starts(
    contacts: Contacts, pull: Pull, still: list[int], held: list[int], gone: set[int]
) -> tuple[dict[int, Start | None], set[int]]:
    """Starts of the contacts without velocity, None where one is to be held or let go; and the implied ones."""
    rows = contacts.rows[held]
    acceleration, jerk, size = pull.constrained(rows)
    settled: dict[int, Start | None] = {}
    implied: set[int] = set()
    for place, j in enumerate(held):
        settled[j] = _pressing(rows, place, pull, size)
    for j in still:
        if j in held:
            continue
        if within(contacts.rows[j], rows):
            implied.add(j)
            continue
        weight = np.abs(contacts.rows[j])
        second = _seen(contacts.rows[j] @ acceleration, weight @ pull.size)
        third = _seen(contacts.rows[j] @ jerk, weight @ size)
        settled[j] = _opening(second, third, j in gone)
    return settled, implied


def _pressing(rows: Array, place: int, pull: Pull, size: Array) -> Start | None:
    """Start of the force of a held contact; None where it is to be let go."""
    each = multipliers(rows)[place]
    force = _seen(each @ pull.acceleration, np.abs(each) @ pull.size)
    if force > 0:
        return 0.0, 0.0
    contacts = pull.contacts
    acceleration = _along(rows, pull.acceleration)
    rate = pull.drive_rate - contacts.damper @ acceleration - contacts.spring * pull.pose[1]
    growth = _seen(each @ rate, np.abs(each) @ size)
    if growth > 0:
        return 1.0, growth
    return None if growth < 0 or force < 0 else (regime_layout.TOUCHING, 0.0)


def _opening(second: float, third: float, at_root: bool) -> Start | None:
    """Start of the gap of a contact at rest at its stop; None where it is to be held. Of motion toward the stop."""
    if third < 0 and (at_root or second >= 0):
        return 3.0, -third
    if second < 0:
        return 2.0, -second
    if at_root and second == 0 and third == 0:
        return regime_layout.TOUCHING, 0.0
    return None


def _seen(value: float, size: float) -> float:
    """The value, 0 where it is the round-off of its parts."""
    return float(value) if abs(value) > NOISE * size else 0.0
