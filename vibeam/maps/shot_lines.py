"""Periodic motions at points of lines of frequency by shooting, each point begun from the motions of its neighbours.

From a motion at a neighbouring point, of the same line or of the line before, Newton's method takes a few flights to
the motion here. Where no neighbour has one, motions are looked for (``vibeam.orbits``) in the middle of the longest
stretch without any, a few times a line.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from vibeam.periodic.continuation import Runners
from vibeam.periodic.motion_at import Way, motion_at, touching
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.orbit_search import orbits
from vibeam.periodic.stroboscopic import StroboscopicMap
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam_models.arrays import Array

SEARCHES = 3  # of a line
KEPT = 2  # motions of a point
SAME = 1e-6  # share of the impact velocity within which two motions of a point are one
NEWTON = 8  # steps from a neighbour's motion: one that takes more has gone elsewhere
WAYS = (Way.CLOSED_FORM, Way.SHOT, Way.FOLLOWED)


@dataclass
class ShotLine:
    """Motions with contacts in ``periods`` drive periods at ``places`` along a line, up to two a place, harder first.

    Of more than two the stable ones are kept.
    """

    places: Sequence[tuple[ImpactSystem, Drive]]
    periods: int
    motions: list[list[Orbit]] = field(init=False)
    runners: Runners = field(default_factory=Runners)

    def __post_init__(self) -> None:
        self.motions = [[] for _ in self.places]

    def fill(self, before: Sequence[Sequence[Orbit]], searches: int = SEARCHES) -> None:
        """Find the motions of all points; ``before``: those of another line near this, point by point, or none.

        ``searches``: how often motions are looked for at most.
        """
        points = range(len(self.places))
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
        system, drive = self.places[at]
        section = StroboscopicMap(system, drive, runner=self.runners.of(system, drive))
        for start in starts:
            with suppress(ValueError):  # no such motion, or none near enough
                found = motion_at(section, start, self.periods, ways=WAYS, alike=touching, steps=NEWTON)
                self._add(found, at)

    def _look(self, at: int) -> None:
        try:
            found = orbits(*self.places[at], self.periods)
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
        shape = len(self.places), KEPT
        velocity, (admissible, stable) = np.full(shape, np.nan), np.zeros((2, *shape))
        for at, motions in enumerate(self.motions):
            for place, orbit in enumerate(motions):
                velocity[at, place], admissible[at, place], stable[at, place] = orbit.velocity, 1, orbit.stable
        return velocity, admissible, stable


def same_motion(one: Orbit, other: Orbit) -> bool:
    """Test whether two motions of a point are one."""
    return len(one.times) == len(other.times) and abs(one.velocity - other.velocity) <= SAME * abs(one.velocity)
