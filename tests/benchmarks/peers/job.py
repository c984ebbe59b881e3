"""What every solver is asked, and what it answers.

Everything is in scaled units, so that one tolerance means the same to all: time in 1/ω₁, the contact's displacement in
its typical size. A job is n modes η'' + 2ζωη' + ω²η = load Ω²B sin Ωt with a stop at contact·η = gap, |contact| = 1.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from vibeam_models.arrays import Array

LIMIT = 50  # impacts a period, in the mean, after which a solver is taken to be stuck on the stop


@dataclass(frozen=True)
class Job:
    """A sweep: point i starts from ``starts[i]`` at the drive's phase 0 and lasts ``periods`` drive periods."""

    omega: Array  # (n,)
    zeta: Array  # (n,)
    contact: Array  # (n,)
    load: Array  # (n,)
    gap: float
    restitution: float
    amplitude: float
    grid: Array  # (points,)
    starts: Array  # (points, 2, n)
    periods: int

    @property
    def size(self) -> int:
        """Number of modes."""
        return len(self.omega)

    def part(self, points: int, periods: int) -> Job:
        """The same with fewer points, spread evenly, and fewer periods."""
        which = ((np.arange(points) + 0.5) * (len(self.grid) / points)).astype(int)
        return replace(self, grid=self.grid[which], starts=self.starts[which], periods=periods)

    def end(self, omega: float) -> float:
        """When a point is over."""
        return float(self.periods * 2 * np.pi / omega)


@dataclass(frozen=True)
class Impacts:
    """One point: when it struck, and how fast; ``failed``: why it did not come to its end."""

    times: Array
    velocities: Array
    failed: str = ""


Answer = tuple[float, list[Impacts]]  # CPU seconds; one entry a point


@dataclass(frozen=True)
class Entry:
    """A solver with its setting. ``prepare`` compiles, and is not timed; what it gives back is."""

    peer: str
    setting: str
    prepare: Callable[[Job], Callable[[], Answer]]
    package: str
    fewest_modes: int = 1
    most_modes: int = 1000
    wide: bool = False  # points run side by side, so that fewer of them would cost more each

    @property
    def name(self) -> str:
        """As in the tables."""
        return f"{self.peer} {self.setting}"


def timed(work: Callable[[], list[Impacts]]) -> Callable[[], Answer]:
    """``work`` with its CPU time, of all its threads."""

    def run() -> Answer:
        begun = time.process_time()
        found = work()
        return time.process_time() - begun, found

    return run


Leg = Callable[[float, float, Array, float], tuple[float, Array, bool]]


def march(job: Job, leg: Leg) -> list[Impacts]:
    """All points by ``leg(omega, t, y, end) -> t, y, struck``: a flight up to an impact or the end. y = (η, η')."""
    return [_point(job, leg, float(omega), start.ravel()) for omega, start in zip(job.grid, job.starts, strict=True)]


def _point(job: Job, leg: Leg, omega: float, y: Array) -> Impacts:
    n, c, t, end = job.size, job.contact, 0.0, job.end(omega)
    times: list[float] = []
    speeds: list[float] = []
    for _ in range(LIMIT * job.periods):
        if t >= end:
            break
        t, y, struck = leg(omega, t, y, end)
        if struck:
            speed = float(c @ y[n:])
            times.append(t)
            speeds.append(speed)
            y = np.concatenate([y[:n] - c * (c @ y[:n] - job.gap), y[n:] - c * ((1 + job.restitution) * speed)])
    return Impacts(np.array(times), np.array(speeds), "" if t >= end else "stuck on the stop")
