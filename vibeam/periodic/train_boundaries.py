"""Bifurcations and ends of motions with m impacts in n drive periods, along frequency, amplitude or gap.

The branch is followed by its arc length (Keller's pseudo-arclength continuation) in phases Ωt_j, impulses and the
parameter, so that it goes round its folds; each change of sign of a test function is then bracketed down to round-off.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from vibeam.periodic.bifurcation_functions import NAMES, Kind
from vibeam.periodic.boundaries import JUMP
from vibeam.periodic.train_branch import Setting, TrainBranch, birth_ahead, inward, point_before, shares_before
from vibeam.periodic.train_orbits import TrainOrbit, multipliers_of
from vibeam_models.arrays import Array, Complex, ValueRecord

KINDS = (Kind.FOLD, Kind.DOUBLING, Kind.NEIMARK_SACKER, Kind.GRAZING, Kind.TOUCHING)
ENDS = (Kind.GRAZING, Kind.TOUCHING)
HALVINGS = 20
STRAY = 0.05  # tolerance of the corrector, as a share of a step: a larger one could land on another branch
Tests = dict[Kind, float]


@dataclass(frozen=True, eq=False, repr=False)
class TrainBoundary(ValueRecord):
    """One boundary of a motion with m impacts: SI units; the impacts' phases Ωt and velocities, (m,)."""

    kind: Kind
    omega: float
    amplitude: float
    gap: float
    phases: Array
    velocities: Array
    multipliers: Complex


def train_boundaries(
    orbit: TrainOrbit, parameter: str, to: float, steps: int = 50, longest: int = 500
) -> tuple[TrainBoundary, ...]:
    """Follow ``orbit``'s branch towards ``parameter`` = ``to`` and return its boundaries in order.

    ``parameter``: omega (rad/s), amplitude or gap (m). The branch ends at the first grazing or second touch (proved),
    beyond which it is no motion; at ``to``; where it comes back behind its start; or after ``longest`` steps of at
    most 1/``steps`` of the way. Where it grew out of a shorter motion by period doubling it turns, at a FOLD whose
    impacts are that motion's, and ends; where the doubling is subcritical, the other FOLD that follows at once is not
    missed. Two boundaries of one kind within a step are missed otherwise. ValueError for an unknown parameter, or an
    orbit that is not admissible.

    >>> import vibeam
    >>> system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, restitution=0.5)
    >>> orbit = vibeam.settled_orbit(system, vibeam.Drive(2.0, 0.1))
    >>> [found.kind.name for found in vibeam.train_boundaries(orbit, "omega", 3.0)]
    ['DOUBLING']
    """
    if parameter not in NAMES:
        raise ValueError(f"parameter: {parameter!r} is none of {', '.join(NAMES)}")
    if not orbit.admissible:
        raise ValueError("orbit: it passes through the stop, so there is no branch of motions to follow")
    value = {"omega": orbit.drive.omega, "amplitude": orbit.drive.amplitude, "gap": orbit.system.gap}[parameter]
    if to == value:
        return ()
    size = float(np.abs(orbit.impulses).max())
    branch = TrainBranch(len(orbit.times), orbit.periods, _setting(orbit, parameter), size, abs(to - value))
    begin = np.concatenate([orbit.drive.omega * orbit.times, orbit.impulses / branch.size, [value / branch.scale]])
    return tuple(_follow(branch, begin, float(np.sign(to - value)), 1 / steps, longest))


def _setting(orbit: TrainOrbit, parameter: str) -> Setting:
    if parameter == "gap":
        return lambda value: (replace(orbit.system, gap=value), orbit.drive)
    return lambda value: (orbit.system, replace(orbit.drive, **{parameter: value}))


def _follow(branch: TrainBranch, begin: Array, towards: float, step: float, longest: int) -> Iterator[TrainBoundary]:
    z, along = begin, np.append(np.zeros(len(begin) - 1), towards)
    along = branch.direction(z, along)
    tests = {kind: branch.test(kind, z, along) for kind in KINDS}
    length = step
    for _ in range(longest):
        birth = birth_ahead(branch, z, along, step)
        if birth is not None:
            yield from _to_birth(branch, z, birth, begin[-1], towards)
            return
        length, ahead = stepped(branch, z, along, min(step, 2 * length))
        if ahead is None:
            return
        following = {kind: branch.test(kind, ahead, along) for kind in KINDS}
        stretch = BranchStretch(partial(branch.beside, z, along), along, 0.0, length)
        for found in _crossed(branch, stretch, tests, following):
            if _within(found.place, begin[-1], towards):
                yield found.boundary
            if found.boundary.kind in ENDS:
                return
        if not _within(ahead[-1], begin[-1], towards):
            return
        z, along = ahead, branch.direction(ahead, along)
        tests = following | {Kind.FOLD: float(along[-1])}


def stepped(branch: TrainBranch, z: Array, along: Array, length: float) -> tuple[float, Array | None]:
    """A step along the tangent and back to the branch, halved until it lands where it was going: length, point."""
    for _ in range(HALVINGS):
        ahead = branch.beside(z, along, length)
        if ahead is not None and np.linalg.norm(ahead - z - length * along) < STRAY * length:
            return length, ahead
        length /= 2
    return length, None


def _within(place: float, begin: float, towards: float) -> bool:
    """Test whether a parameter, over its scale, lies on the way."""
    return bool(0 <= towards * (place - begin) <= 1)


class _Located(NamedTuple):
    """A boundary, and its parameter over its scale."""

    place: float
    boundary: TrainBoundary


class BranchStretch(NamedTuple):
    """A stretch of a branch: the point at a position, about which way it goes, from and to which position."""

    point: Callable[[float], Array | None]
    along: Array
    low: float
    high: float


def _crossed(branch: TrainBranch, stretch: BranchStretch, tests: Tests, following: Tests) -> list[_Located]:
    """The boundaries within a stretch, in order, up to the first that ends the branch."""
    kinds = [kind for kind in KINDS if tests[kind] * following[kind] < 0]
    found = [(at, kind) for kind in kinds if (at := root_on(branch, kind, stretch)) is not None]
    located = list[_Located]()
    for at, kind in sorted(found, key=lambda pair: pair[0]):
        point = stretch.point(at)
        if point is not None:
            located.append(_Located(float(point[-1]), _boundary(branch, kind, point)))
        if kind in ENDS:
            break
    return located


def _to_birth(branch: TrainBranch, z: Array, birth: Array, begin: float, towards: float) -> Iterator[TrainBoundary]:
    """The boundaries on the way from z to a birth by doubling, and that, a fold: beyond it all comes once more."""
    along, (shares, way), gone = inward(branch, z), shares_before(branch, z, birth), 0.0
    tests = {kind: branch.test(kind, z, along) for kind in KINDS}

    def point(position: float) -> Array | None:
        return point_before(branch, z, birth, 1.0 - position)

    for share in shares:
        there = point(1.0 - share)
        if there is None:
            break
        following = {kind: branch.test(kind, there, along) for kind in KINDS}
        if share == shares[-1]:
            following[Kind.FOLD] = way
        for found in _crossed(branch, BranchStretch(point, along, gone, 1.0 - share), tests, following):
            if _within(found.place, begin, towards):
                yield found.boundary
            if found.boundary.kind in ENDS:
                return
        tests, gone = following, 1.0 - share
    if _within(birth[-1], begin, towards):
        yield _boundary(branch, Kind.FOLD, birth)


def root_on(branch: TrainBranch, kind: Kind, stretch: BranchStretch, within: float = 1e-15) -> float | None:
    """Position of the boundary in the stretch, ``within`` that length; None where the sign changes by a jump."""

    values: dict[float, float] = {}

    def test(step: float) -> float:
        point = stretch.point(step)
        if point is None:  # near a crossing of two branches the equations are almost singular
            raise ArithmeticError
        values[step] = branch.test(kind, point, stretch.along)
        return values[step]

    try:
        if test(stretch.low) * test(stretch.high) < 0:
            brentq(test, stretch.low, stretch.high, xtol=within, rtol=4 * np.finfo(float).eps, disp=False)
    except ArithmeticError:
        pass
    sizes = np.abs(np.array(list(values.values())))
    nearest = list(values)[int(np.argmin(sizes))]
    return nearest if len(values) > 2 and sizes.min() <= JUMP * sizes.max() else None


def _boundary(branch: TrainBranch, kind: Kind, z: Array) -> TrainBoundary:
    system, drive, span, train = branch.at(z)
    velocities = system.impact_velocity(train.impulses)
    values = np.zeros(0, dtype=complex) if kind is Kind.GRAZING else multipliers_of(system, drive, span, train)
    phases = np.mod(drive.omega * train.times, drive.omega * span)
    return TrainBoundary(kind, drive.omega, drive.amplitude, system.gap, phases, velocities, values)
