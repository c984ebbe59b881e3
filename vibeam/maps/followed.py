"""Branches of periodic motions along lines of frequency, and their boundaries, for models that no closed form knows.

Motions are looked for at a few frequencies (``vibeam.orbits``). From each its branch is followed up and down over the
whole line, folds and unstable parts with it, and the boundaries on it are located.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from vibeam.flight.engine.threads import pause
from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.boundaries import Boundary
from vibeam.periodic.follow import Branch, follow
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.orbit_search import orbits
from vibeam.system.impact_system import Drive, ImpactSystem

STARTS = (0.5, 0.1, 0.9)  # shares of a line at which motions are looked for
SAME = 1e-6  # share of the impact velocity within which two motions at one frequency are one
MOST = 4  # branches of a line: with the steps of each the bound of its cost
STEP = 0.1  # the longest, as a share of the motion's size and of the line
LONGEST, ALL = 150, 400  # steps of a branch, and of all of a line


@dataclass(frozen=True)
class FollowedLine:
    """A system under a drive over frequencies from ``low`` to ``high``, rad/s; ``amplitude``: m at one of them."""

    system: ImpactSystem
    amplitude: Callable[[float], float]
    low: float
    high: float
    periods: int

    def setting(self, omega: float) -> tuple[ImpactSystem, Drive]:
        """System and drive at a frequency."""
        return self.system, Drive(omega, self.amplitude(omega))


def branches_of(line: FollowedLine) -> list[Branch]:
    """Branches of motions with contacts over a line."""
    found: list[Branch] = []
    steps = ALL
    for start in _anywhere(line):
        omega = start.drive.omega
        if len(found) >= MOST or any(same_motion(start, other) for branch in found for other in branch.at(omega)):
            continue
        for to, back in (line.high, line.low), (line.low, line.high):
            if to != omega and steps > 0:
                pause()
                longest = min(LONGEST, steps)
                found.append(follow(start, line.setting, to, value=omega, behind=back, step=STEP, longest=longest))
                steps -= len(found[-1])
    return found


def same_motion(one: Orbit, other: Orbit) -> bool:
    """Test whether two motions at one frequency are one."""
    return len(one.times) == len(other.times) and abs(one.velocity - other.velocity) <= SAME * abs(one.velocity)


def _anywhere(line: FollowedLine) -> Iterator[Orbit]:
    """Motions with contacts at a few frequencies of a line."""
    for share in STARTS:
        system, drive = line.setting(line.low + share * (line.high - line.low))
        try:
            found = orbits(system, drive, line.periods)
        except ValueError:  # at a resonance of an undamped mode there is none
            continue
        yield from (orbit for orbit in found if len(orbit.times))


def boundaries_on(line: FollowedLine, branches: list[Branch]) -> list[Boundary]:
    """Boundaries met on branches over a line, in order of the frequency, each once."""
    found: list[Boundary] = []
    for branch in branches:
        for met in branch.boundaries:
            velocity = 0.0 if met.kind in (Kind.GRAZING, Kind.TOUCHING) else met.orbit.velocity
            drive = line.setting(met.value)[1]
            boundary = Boundary(
                met.kind, "omega", met.value, drive.amplitude, line.system.gap, line.periods, 0, np.nan, velocity,
                met.multipliers, True,
            )  # fmt: skip
            if not any(other.kind is met.kind and abs(other.omega - met.value) < SAME * met.value for other in found):
                found.append(boundary)
    return sorted(found, key=lambda each: each.omega)
