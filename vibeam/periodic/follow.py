"""Branches of periodic motions, followed along any parameter through folds, stable or not (``vibeam.follow``)."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from vibeam.periodic.bifurcation_functions import NAMES, Kind
from vibeam.periodic.branch_boundaries import Met
from vibeam.periodic.branch_walk import BranchEnd, Walk
from vibeam.periodic.continuation import BranchPoint, BranchSection, Setting
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.shooting import orbit_at
from vibeam.periodic.stroboscopic import StroboscopicMap
from vibeam_models.arguments import count, number, refuse, require
from vibeam_models.arrays import Array, Complex, Flags, ValueRecord

FIRST = (0.01, 0.003, 0.001, 0.03, 3e-4, 1e-4)  # parts along the null vector of the first motion of another branch
ROUNDED = 1e-14  # share of a parameter by which round-off may move the end of a branch
APART = 0.3  # share of that part by which a motion must miss itself after half its span
NEAR = 1e-3  # share of the motion's size within which an orbit must solve the equations


@dataclass(frozen=True, eq=False, repr=False)
class BranchBoundary(ValueRecord):
    """Boundary met on a branch, where the motion changes its stability, its events, or ends.

    ``multipliers`` (2n,), largest first, are empty where an impact has no velocity: they are infinite.

    >>> import vibeam
    >>> system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, restitution=0.5)
    >>> [met] = vibeam.follow(vibeam.orbits(system, vibeam.Drive(2.0, 0.1))[0], "omega", 3.0).boundaries
    >>> met.kind.name, bool(min(abs(met.multipliers + 1)) < 1e-9), met.orbit.periods
    ('DOUBLING', True, 1)
    """

    kind: Kind
    value: float  #: of the parameter
    multipliers: Complex
    _point: BranchPoint | None = field(compare=False, repr=False)
    _way: Array = field(compare=False, repr=False)

    @cached_property
    def orbit(self) -> Orbit:
        """The motion there; ValueError at a touch with no velocity, which is at the limit of what can be flown."""
        if self._point is None:
            raise ValueError(f"orbit: {self.kind.value}: take one of the branch's orbits beside it")
        return _orbit(self._point)


@dataclass(frozen=True, eq=False, repr=False)
class Branch(ValueRecord):
    """Branch of periodic motions in order along it, from the start on; SI units, or those of the parameter.

    >>> import vibeam
    >>> system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, restitution=0.5)
    >>> branch = vibeam.follow(vibeam.orbits(system, vibeam.Drive(2.0, 0.1))[0], "omega", 3.0)
    >>> [(met.kind.name, round(met.value, 9)) for met in branch.boundaries], branch.end.name
    ([('DOUBLING', 2.675254657)], 'REACHED')
    """

    values: Array  #: of the parameter (points,)
    stable: Flags  #: (points,) all multipliers within the unit circle
    boundaries: tuple[BranchBoundary, ...]
    end: BranchEnd  #: why it goes no further
    _points: tuple[BranchPoint, ...] = field(compare=False, repr=False)
    _walk: Walk = field(compare=False, repr=False)

    def __len__(self) -> int:
        return len(self.values)

    @cached_property
    def orbits(self) -> tuple[Orbit, ...]:
        """The motions (points,)."""
        return tuple(_orbit(point) for point in self._points)

    def at(self, value: float) -> tuple[Orbit, ...]:
        """The motions at one value of the parameter, in the order in which the branch comes to it."""
        values = self.values
        values = np.where(np.abs(values - value) <= ROUNDED * np.abs(value), value, values)
        passed = np.flatnonzero((values[:-1] - value) * (values[1:] - value) <= 0)
        found = (_between(self._points[k], self._points[k + 1], value) for k in passed if values[k + 1] != value)
        last = [_orbit(self._points[-1])] if len(self) and values[-1] == value else []
        return tuple([orbit for orbit in found if orbit is not None] + last)

    def switch(self, at: BranchBoundary, side: int = 1) -> Branch:
        """Branch of motions of twice the span that a period doubling begins, to the ends of this one's range.

        Where a multiplier is 1 without a fold (PLUS_ONE), symmetry is lost: then the branch of one ``side``, 1 or −1,
        with the same span; both sides of a doubling are one motion, half its span apart. ValueError for another
        boundary, and where no motion is found beside it.
        """
        point = at._point
        if point is None or at.kind not in (Kind.DOUBLING, Kind.PLUS_ONE):
            raise ValueError(f"at: {at.kind.name} begins no branch: a DOUBLING or PLUS_ONE of this one does")
        start, ahead = _beside(point, at._way, 2 if at.kind is Kind.DOUBLING else 1, float(np.sign(side)))
        return _followed(self._walk.renewed(start, ahead), (ahead.section.point(start),))


def follow(
    orbit: Orbit, along: str | Setting, to: float, *, value: float | None = None, behind: float | None = None,
    step: float = 0.05, longest: int = 500,
) -> Branch:  # fmt: skip
    """Follow a periodic motion along one parameter to its value ``to``, through folds, stable or not.

    ``along``: "omega" (rad/s), "amplitude" or "gap" (m), or a function of a number that returns a system and a drive;
    ``value``: that number at the orbit, needed for a function. The branch ends at ``to``, at ``behind`` (None: the
    orbit's own value) on the other side, where the motion ceases, or after ``longest`` steps; ``end`` says which.
    ``step``: the longest, as a share of the motion's size and of the way. Any law, any number of impacts and rests,
    either side. What is met on the way (``Kind``) is located to round-off, but where events change otherwise than by a
    touch to 1e-10 of the way, and where branches cross (PLUS_ONE) to 1e-8; two of one kind within a step are missed.
    ValueError for arguments that make no sense, and an orbit that is not admissible or none of the system at ``value``.

    >>> import vibeam
    >>> system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, restitution=0.5)
    >>> start = vibeam.orbits(system, vibeam.Drive(2.0, 0.1))[0]
    >>> branch = vibeam.follow(start, "omega", 1.0)
    >>> branch.end.value, branch.boundaries[0].kind.name
    ('the motion grazes the stop, and beyond ceases as it was', 'TOUCHING')
    """
    require("orbit", orbit, Orbit)
    faults: list[str] = []
    goal, share = number("to", to, faults), number("step", step, faults, least=1e-6, most=1.0)
    steps = count("longest", longest, faults, least=1)
    refuse("follow", faults)
    setting, begin = _setting(orbit, along, value)
    back = begin if behind is None else number("behind", behind, faults)
    refuse("follow", faults)
    if not orbit.admissible:
        raise ValueError("orbit: it passes through the stop, so there is no branch of motions to follow")
    if goal == begin or (goal - begin) * (back - begin) > 0:
        raise ValueError(f"to, behind: must lie on either side of the orbit's own value {begin:g}, and to not on it")
    start = _first(orbit, setting, begin, abs(goal - begin))
    ahead = np.append(np.zeros(len(start.z) - 1), np.sign(goal - begin))
    return _followed(Walk(start, ahead, goal, back, share, steps))


def _setting(orbit: Orbit, along: str | Setting, value: float | None) -> tuple[Setting, float]:
    """System and drive as a function of the parameter, and its value at the orbit."""
    system, drive = orbit.system, orbit.drive
    if not isinstance(along, str):
        if value is None:
            raise ValueError("value: a function needs the number at which it makes the orbit's system and drive")
        return along, float(value)
    if along not in NAMES:
        raise ValueError(f"along: {along!r} is none of {', '.join(NAMES)}, nor a function of a number")
    if along == "gap":
        return (lambda number: (replace(system, gap=number), drive)), system.gap
    return (lambda number: (system, replace(drive, **{along: number}))), float(getattr(drive, along))


def _first(orbit: Orbit, setting: Setting, value: float, scale: float) -> BranchPoint:
    """The orbit as a point of a branch, its section in the middle of the longest flight."""
    here, state = StroboscopicMap(orbit.system, orbit.drive, orbit.time).in_flight(orbit.state)
    section = BranchSection.of(setting, orbit.periods, here.time, state, value, scale)
    z = section.place(state, value)
    try:
        point = section.corrected(z, np.append(np.zeros(len(z) - 1), 1.0), section.slope(z))
    except ArithmeticError as end:
        raise ValueError(f"orbit: {end}") from None
    if point is None or np.linalg.norm(point.z - z) > NEAR:
        raise ValueError(f"orbit: it is none of the system at {value:g}: Newton's method leads elsewhere from it")
    return point


def _followed(walk: Walk, before: tuple[BranchPoint, ...] = ()) -> Branch:
    walk.run()
    assert walk.end is not None
    points = (*before, *walk.points)
    stable = np.array([bool(abs(each.multipliers[0]) < 1) for each in points])
    stable[: len(before)] = stable[len(before)]
    met = tuple(BranchBoundary(each.kind, value, _multipliers(each), each.point, each.way) for each, value in walk.met)
    return Branch(np.array([each.value for each in points]), stable, met, walk.end, points, walk)


def _multipliers(met: Met) -> Complex:
    return np.zeros(0, dtype=complex) if met.point is None else met.point.multipliers


def _beside(point: BranchPoint, way: Array, times: int, side: float) -> tuple[Array, BranchPoint]:
    """Beginning of a branch of so many ``times`` the span, and the first motion of it.

    There the derivatives of the equations have two null vectors: the tangent of the branch that goes the ``way``, and
    one across, along which the other branch leaves.
    """
    section = replace(point.section, periods=times * point.section.periods)
    both = section.point(point.z)
    rows = np.column_stack([both.monodromy - np.eye(len(both.monodromy)), section.slope(point.z)])
    null = np.linalg.svd(rows)[2][-2:]
    tangent = point.section.tangent(point, point.section.slope(point.z)) if times == 2 else way
    share = null @ tangent
    normal = side * np.array([-share[1], share[0]]) @ null / np.linalg.norm(share)
    for part in FIRST:
        guess = point.z + part * normal
        ahead = section.corrected(guess, normal, section.slope(guess))
        if ahead is not None and np.linalg.norm(ahead.z - point.z) < 3 * part and _apart(point, ahead, part):
            return point.z, ahead
    raise ValueError("at: Newton's method finds no motion beside it")


def _apart(point: BranchPoint, ahead: BranchPoint, part: float) -> bool:
    """Test whether a motion of twice the span is none of the span itself."""
    if ahead.section.periods == point.section.periods:
        return True
    return float(np.linalg.norm(point.section.residual(ahead.z)[0])) > APART * part


def _between(one: BranchPoint, other: BranchPoint, value: float) -> Orbit | None:
    """The motion at a value between two points, from the nearer one on; None where Newton's method finds none."""
    share = (value - one.value) / (other.value - one.value)
    for near in sorted((one, other), key=lambda point: abs(point.value - value)):
        same = one.section.phase == other.section.phase
        guess = one.z + share * (other.z - one.z) if same else near.z.copy()
        guess[-1] = value / near.section.scale
        fixed = np.append(np.zeros(len(guess) - 1), 1.0)
        point = near.section.corrected(guess, fixed, np.zeros(len(guess) - 1))  # the parameter is held: no slope by it
        if point is not None and point.itinerary in (one.itinerary, other.itinerary):
            return _orbit(point)
    return None


def _orbit(point: BranchPoint) -> Orbit:
    """The record of a motion on a branch."""
    ratio = point.chart.units / point.section.units
    matrix = point.monodromy * (ratio[:, None] / ratio)
    return orbit_at(point.chart, point.section.periods, point.state, point.flown, matrix)
