"""Periodic motions at points of lines of frequency by shooting, each point begun from the motions of its neighbours.

From a motion at a neighbouring point, of the same line or of the line before, Newton's method takes a few flights to
the motion here. Where no neighbour has one, motions are looked for (``vibeam.orbits``) in the middle of the longest
stretch without any, a few times a line.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from vibeam.flight.engine.threads import pause
from vibeam.maps.followed import FollowedLine, same_motion
from vibeam.periodic.continuation import Runners
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.orbit_search import orbits
from vibeam.periodic.shooting import shoot
from vibeam.periodic.stroboscopic import StroboscopicMap
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam_models.arrays import Array

SEARCHES = 3  # of a line
KEPT = 2  # motions of a point
TRIES = 12  # steps from a point to the next, at most
NEWTON = 8  # steps from a neighbour's motion: one that takes more has gone elsewhere


@dataclass
class ShotLine:
    """Motions with contacts at frequencies ``omega`` (points,) rad/s of a line, up to two a point, harder first.

    Of more than two the stable ones are kept.
    """

    line: FollowedLine
    omega: Array
    motions: list[list[Orbit]] = field(init=False)
    runners: Runners = field(default_factory=Runners)

    def __post_init__(self) -> None:
        self.motions = [[] for _ in self.omega]

    def fill(self, before: Sequence[Sequence[Orbit]], searches: int = SEARCHES) -> None:
        """Find the motions of all points; ``before``: those of another line near this, point by point, or none.

        ``searches``: how often motions are looked for at most.
        """
        points = range(len(self.omega))
        for at in points:
            self._lead([*(self.motions[at - 1] if at else []), *(before[at] if before else [])], at)
        self._spread(points[::-1])
        looked: set[int] = set()
        for _ in range(searches):
            middle = self._empty_middle(looked)
            if middle is None:
                return
            looked.add(middle)
            self._look(middle)
            self._spread(points[middle + 1 :])
            self._spread(points[::-1])

    def _spread(self, points: range) -> None:
        """Lead motions from point to point, where the next one has fewer."""
        for at in points:
            beside = at - points.step
            if 0 <= beside < len(self.motions) and len(self.motions[at]) < len(self.motions[beside]):
                self._lead(self.motions[beside], at)

    def _lead(self, starts: Sequence[Orbit], at: int) -> None:
        """Add the motions of a point that some of its neighbours lead to."""
        for start in starts:
            found = self._carried(start, float(self.omega[at]))
            if found is not None:
                self._add(found, at)

    def _carried(self, orbit: Orbit, goal: float) -> Orbit | None:
        """The motion at a frequency that an orbit leads to, in shorter steps where Newton's method needs them.

        Frequency, drive and gap go on together from those of the orbit.
        """
        system, drive = self.line.setting(goal)
        begin, gap, done, step = orbit.drive, orbit.system.gap, 0.0, 1.0
        for _ in range(TRIES):
            share = min(done + step, 1.0)
            if share == 1.0:
                there, driven = system, drive
            else:
                there = system if gap == system.gap else replace(system, gap=gap + share * (system.gap - gap))
                omega = begin.omega + share * (goal - begin.omega)
                driven = Drive(omega, begin.amplitude + share * (drive.amplitude - begin.amplitude))
            found = self._shot(orbit, there, driven)
            if found is None:
                step /= 4
            elif share == 1.0:
                return found
            else:
                orbit, done, step = found, share, 2 * step
        return None

    def _shot(self, start: Orbit, system: ImpactSystem, drive: Drive) -> Orbit | None:
        """The motion with contacts near another, at the same phase of the drive; None without one."""
        pause()
        time = start.time * start.drive.omega / drive.omega
        section = StroboscopicMap(system, drive, time, runner=self.runners.of(system, drive))
        try:
            found = shoot(section, start.state, self.line.periods, NEWTON)
        except ValueError:  # no such motion, or none near enough
            return None
        return found if len(found.times) else None

    def _look(self, at: int) -> None:
        try:
            found = orbits(*self.line.setting(float(self.omega[at])), self.line.periods)
        except ValueError:  # at a resonance of an undamped mode there is none
            return
        for orbit in found:
            self._add(orbit, at)

    def _add(self, orbit: Orbit, at: int) -> None:
        known = self.motions[at]
        if len(orbit.times) and not any(same_motion(orbit, other) for other in known):
            every = sorted([*known, orbit], key=lambda each: (not each.stable, -each.velocity))
            self.motions[at] = sorted(every[:KEPT], key=lambda each: -each.velocity)

    def _empty_middle(self, looked: set[int]) -> int | None:
        """Middle of the longest stretch without motions and not yet looked at; None without one."""
        ends = [-1, *(at for at, each in enumerate(self.motions) if each or at in looked), len(self.motions)]
        first, last = max(pairwise(ends), key=lambda each: each[1] - each[0])
        return (first + last) // 2 if last - first > 1 else None

    def points(self) -> tuple[Array, Array, Array]:
        """Velocity, admissible and stable (points, 2) of the motions."""
        velocity, (admissible, stable) = np.full((len(self.omega), KEPT), np.nan), np.zeros((2, len(self.omega), KEPT))
        for at, motions in enumerate(self.motions):
            for place, orbit in enumerate(motions):
                velocity[at, place], admissible[at, place], stable[at, place] = orbit.velocity, 1, orbit.stable
        return velocity, admissible, stable
