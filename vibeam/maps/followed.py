"""Periodic motions along lines of frequency by shooting and following, for models that no closed form knows.

On the first line motions are looked for at a few frequencies (``vibeam.orbits``); on the next those of the line before
are the starts. From each its branch is followed up and down over the whole line, folds and unstable parts with it, so
that a motion is found where a branch with one of the starts leads to it.
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
from vibeam.periodic.shooting import NoOrbit
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam_models.arrays import Array

STARTS = (0.5, 0.1, 0.9)  # shares of a line at which motions are looked for
SAME = 1e-6  # share of the impact velocity within which two motions at one frequency are one
MOST = 4  # branches of a line: with the steps of each the bound of its cost
STEP, LONGEST = 0.1, 150  # longest step, as a share of the motion's size and of the line, and number of steps


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


def branches_of(line: FollowedLine, before: list[Orbit]) -> list[Branch]:
    """Branches of motions with contacts over a line; ``before``: motions of another line near it."""
    return _followed(line, _near(line, before)) or _followed(line, _anywhere(line))


def _followed(line: FollowedLine, starts: Iterator[Orbit]) -> list[Branch]:
    """Branches through some motions."""
    found: list[Branch] = []
    for start in starts:
        omega = start.drive.omega
        if len(found) >= MOST or any(_same(start, other) for branch in found for other in branch.at(omega)):
            continue
        pause()
        for to, back in (line.high, line.low), (line.low, line.high):
            if to != omega:
                found.append(follow(start, line.setting, to, value=omega, behind=back, step=STEP, longest=LONGEST))
    return found


def _same(one: Orbit, other: Orbit) -> bool:
    return len(one.times) == len(other.times) and abs(one.velocity - other.velocity) <= SAME * abs(one.velocity)


def _near(line: FollowedLine, before: list[Orbit]) -> Iterator[Orbit]:
    """Motions on a line near those of another."""
    for orbit in before:
        system, drive = line.setting(orbit.drive.omega)
        try:
            yield from orbits(system, drive, line.periods, start=orbit.state, time=orbit.time)
        except NoOrbit:
            continue


def _anywhere(line: FollowedLine) -> Iterator[Orbit]:
    """Motions with contacts at a few frequencies of a line."""
    for share in STARTS:
        system, drive = line.setting(line.low + share * (line.high - line.low))
        try:
            found = orbits(system, drive, line.periods)
        except ValueError:  # at a resonance of an undamped mode there is none
            continue
        yield from (orbit for orbit in found if len(orbit.times))


def onward(branches: list[Branch]) -> list[Orbit]:
    """Motions from which a line beside is begun: the middle one of each branch that has contacts."""
    return [orbit for each in branches if len((orbit := each.orbits[len(each) // 2]).times)]


def motions_at(branches: list[Branch], omega: float) -> list[Orbit]:
    """Distinct motions with contacts at a frequency, the hardest first."""
    found: list[Orbit] = []
    for orbit in (orbit for branch in branches for orbit in branch.at(omega)):
        if len(orbit.times) and not any(_same(orbit, other) for other in found):
            found.append(orbit)
    return sorted(found, key=lambda orbit: -orbit.velocity)


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


def points_on(omega: Array, branches: list[Branch]) -> tuple[Array, Array, Array]:
    """Velocity, admissible and stable (points, 2) of the two hardest motions at frequencies (points,)."""
    velocity, (admissible, stable) = np.full((len(omega), 2), np.nan), np.zeros((2, len(omega), 2))
    for at, each in enumerate(omega):
        for place, orbit in enumerate(motions_at(branches, float(each))[:2]):
            velocity[at, place], admissible[at, place], stable[at, place] = orbit.velocity, 1, orbit.stable
    return velocity, admissible, stable
