"""A scene as every peer is told it, and what a peer is: numbers alone, nothing of vibeam or of the truth.

n modes η'' + 2ζωη' + ω²η = load Ω²B sin Ωt + static; stops at row·η = gap, at which row·η' becomes −R times itself.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

Array = np.ndarray
RESTING = 1e-6  # share of the scale of velocities: slower behind an impact, pressed on, a contact is taken to rest


@dataclass(frozen=True)
class Stop:
    """A one-sided stop."""

    row: Array
    gap: float
    restitution: float

    @property
    def kick(self) -> Array:
        """Change of the modal velocities for each unit of the contact's velocity before."""
        return -self.row * ((1 + self.restitution) / (self.row @ self.row))


@dataclass(frozen=True)
class Told:
    """Modes, stops, drive, start and span. ``held``: the stop on which it rests at the start, or None."""

    omega: Array
    zeta: Array
    load: Array
    static: Array
    stops: tuple[Stop, ...]
    drive: float
    amplitude: float
    displacement: Array
    velocity: Array
    held: int | None
    begin: float
    end: float

    @property
    def size(self) -> int:
        """Number of modes."""
        return len(self.omega)

    @property
    def start(self) -> Array:
        """Displacements and velocities in one row."""
        return np.concatenate([self.displacement, self.velocity])

    @property
    def force(self) -> Array:
        """Amplitudes of the modal forces."""
        return self.load * (self.drive**2 * self.amplitude)

    @property
    def reach(self) -> float:
        """Scale of the contact's displacement."""
        return float(np.abs(self.stops[0].row) @ np.abs(self.displacement) + abs(self.stops[0].gap))

    @property
    def speed(self) -> float:
        """Scale of the contact's velocity: of the start, of its springs and of the drive."""
        own = np.maximum(np.maximum(self.omega, self.drive), 1e-300)
        steady = np.abs(self.force) / own + np.abs(self.static) / np.maximum(own, 1 / (self.end - self.begin))
        parts = np.abs(self.velocity) + self.omega * np.abs(self.displacement) + steady
        return float(np.abs(self.stops[0].row) @ parts)

    @property
    def cycle(self) -> float:
        """Period of the drive, of the slowest mode where nothing is driven, or the whole span."""
        rates = [self.drive] if self.amplitude else [w for w in self.omega if w > 0]
        return min(2 * np.pi / min(rates), self.end - self.begin) if rates else self.end - self.begin

    def tolerances(self, rtol: float) -> Array:
        """Absolute tolerances of each displacement and velocity: a hundredth of ``rtol`` times their scales."""
        scales = np.repeat([self.reach, self.speed], self.size) / np.abs(self.stops[0].row).max()
        return 1e-2 * rtol * scales


@dataclass
class Answer:
    """What a peer found: impacts (m, 2) as (time, velocity before), places of the first stop's row with the last one in
    the end, the modes then (2, n); ``seconds`` where it measured its own CPU time."""

    impacts: Array
    places: Array
    state: Array | None
    complaint: str = ""
    seconds: float | None = None


@dataclass(frozen=True)
class Peer:
    """A program with its setting. ``prepare`` compiles and is timed apart; what it gives back runs the scene once."""

    name: str
    package: str
    setting: str
    prepare: Callable[[Told], Callable[[], Answer]]


def told(scene: Any) -> Told:
    """A scene of ``tests/hard/scenes.py``, without its truth."""
    system, drive, start = scene.case
    stops = [Stop(system.contact, system.gap, system.restitution)]
    if system.second_gap is not None:
        stops.append(Stop(-system.contact, system.second_gap, system.restitution))
    return Told(
        system.omega, system.zeta, system.load, system.static, tuple(stops), drive.omega, drive.amplitude,
        np.array(start.displacement), np.array(start.velocity), 0 if start.resting else None, scene.begin, scene.end,
    )  # fmt: skip
