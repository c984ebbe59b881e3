"""Branches of motions with 2m impacts in 2n drive periods that grow out of doublings of those with m in n.

Gone through twice, a motion with m impacts solves the equations of 2m. At its doubling, where a multiplier is −1, their
derivatives by phases and impulses are singular along a vector that is antisymmetric in the two halves,

    a = (δθ, −δθ, δp, −δp),

and the branch of the doubled motion leaves along it: a pitchfork, as z and its mirror are one motion shifted by half
its span. Its first points are found with their part along a held, the others by arc length. It ends at grazing, at a
second touch, at the end of the range, or at another doubling of the shorter motion. Its own doublings begin the next.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.train_boundaries import ENDS, BranchStretch, root_on, stepped
from vibeam.periodic.train_branch import TrainBranch, birth_ahead, twice
from vibeam.periodic.train_orbits import multipliers_of
from vibeam.periodic.trains import Train
from vibeam_models.arrays import Array, Complex

STEP = 0.02  # longest along the branch: rad, share of the impulse, share of the range of the parameter
FIRST = (0.002, 0.005, 0.01, 0.02)  # parts along the antisymmetric vector of the first points
LONGEST = 1000  # steps
END = 1e-8  # length along the branch to which its end is located
SAME = 1e-7  # share of the range within which two doublings of one motion are the same


@dataclass(frozen=True)
class DoubledBranch:
    """Branch of motions with ``impacts`` in ``periods`` drive periods, from its birth on.

    ``values`` (points,): of the parameter; ``trains``: impacts there; ``multipliers`` (points, 2 modes), largest first,
    NaN where an impact grazes. The first point is the doubling of the shorter motion, gone through twice.
    """

    impacts: int
    periods: int
    values: Array
    trains: tuple[Train, ...]
    multipliers: Complex

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Test whether all multipliers lie within the unit circle, (points,); at the birth as just after it."""
        found = np.abs(self.multipliers[:, 0]) < 1
        found[0] = found[1]
        return found


def doubled_branches(
    branch: TrainBranch, points: Sequence[Array], low: float, high: float, longest: int = 4
) -> list[DoubledBranch]:
    """Branches that grow out of the doublings between ``points`` z of a branch, and out of their own, and so on.

    Parameters from ``low`` to ``high``, motions of up to ``longest`` drive periods.
    """
    if 2 * branch.periods > longest:
        return []
    doubled, found, ends = replace(branch, impacts=2 * branch.impacts, periods=2 * branch.periods), [], list[Array]()
    for birth in _doublings(branch, points):
        begin = twice(birth, branch.impacts, doubled.periods)
        if any(abs(begin[-1] - end[-1]) * branch.scale < SAME * (high - low) for end in ends):
            continue
        followed = list(_followed(doubled, begin, low / branch.scale, high / branch.scale))
        ends.append(followed[-1])
        if len(followed) < 3:  # it ends, at an impact that grazes, as good as where it begins
            continue
        found.append(_described(doubled, followed))
        found += doubled_branches(doubled, followed[1:], low, high, longest)
    return found


def _doublings(branch: TrainBranch, points: Sequence[Array]) -> Iterator[Array]:
    """Points of the branch with a multiplier of −1."""
    tests = [branch.test(Kind.DOUBLING, z, z) for z in points]
    for at in range(len(points) - 1):
        way = points[at + 1] - points[at]
        length = float(np.linalg.norm(way))
        if not tests[at] * tests[at + 1] < 0 or not length > 0:
            continue
        stretch = BranchStretch(partial(branch.beside, points[at], way / length), way / length, 0.0, length)
        place = root_on(branch, Kind.DOUBLING, stretch)
        found = None if place is None else stretch.point(place)
        if found is not None:
            yield found


def _antisymmetric(branch: TrainBranch, begin: Array) -> Array:
    """Unit vector along which the doubled motion leaves the shorter one."""
    half = branch.impacts // 2
    basis = np.zeros((len(begin), branch.impacts))
    for column in range(half):
        for block in (0, 1):
            first = block * branch.impacts + column
            basis[first, block * half + column], basis[first + half, block * half + column] = 1.0, -1.0
    basis /= np.sqrt(2.0)
    return np.asarray(basis @ np.linalg.svd(branch.slopes(begin)[1] @ basis)[2][-1])


def _followed(branch: TrainBranch, begin: Array, low: float, high: float) -> Iterator[Array]:
    """Points of the branch from its birth on."""
    yield begin
    along, z = _antisymmetric(branch, begin), begin
    for part in FIRST:
        ahead = branch.beside(begin, along, part)
        if ahead is None or not low <= ahead[-1] <= high:
            continue
        z = ahead
        yield z
    if z is begin:
        return
    yield from _continued(branch, z, branch.direction(z, along), low, high)


def _continued(branch: TrainBranch, z: Array, along: Array, low: float, high: float) -> Iterator[Array]:
    """Points ahead of z to the end of the branch or of the range."""
    length = STEP
    tests = {kind: branch.test(kind, z, along) for kind in ENDS}
    for _ in range(LONGEST):
        birth = birth_ahead(branch, z, along, STEP)
        if birth is not None:
            yield birth
            return
        length, ahead = stepped(branch, z, along, min(STEP, 2 * length))
        if ahead is None:
            return
        following = {kind: branch.test(kind, ahead, along) for kind in ENDS}
        ended = [kind for kind in ENDS if tests[kind] * following[kind] < 0]
        if ended:
            stretch = BranchStretch(partial(branch.beside, z, along), along, 0.0, length)
            places = [at for kind in ended if (at := root_on(branch, kind, stretch, END)) is not None]
            last = stretch.point(min(places)) if places else None
            if last is not None and low <= last[-1] <= high:
                yield last
            return
        if not low <= ahead[-1] <= high:
            last = _at_value(branch, z, ahead, low if ahead[-1] < low else high)
            if last is not None:
                yield last
            return
        yield ahead
        z, along, tests = ahead, branch.direction(ahead, along), following


def _at_value(branch: TrainBranch, before: Array, after: Array, value: float) -> Array | None:
    """The point between two others with that parameter."""
    fixed = np.append(np.zeros(len(before) - 1), 1.0)
    share = (value - before[-1]) / (after[-1] - before[-1])
    return branch.corrected(before + share * (after - before), fixed)


def _described(branch: TrainBranch, points: Sequence[Array]) -> DoubledBranch:
    known = [branch.at(z) for z in points]
    return DoubledBranch(
        branch.impacts,
        branch.periods,
        np.array([z[-1] * branch.scale for z in points]),
        tuple(train for *_, train in known),
        np.array([_multipliers(*each) for each in known]),
    )


def _multipliers(*at) -> Complex:  # type: ignore[no-untyped-def]
    """Multipliers at a point of a branch; NaN where an impact grazes."""
    system, train = at[0], at[-1]
    if train.impulses.max() > -1e-9 * np.abs(train.impulses).max():
        return np.full(2 * system.size, np.nan, dtype=complex)
    return multipliers_of(*at)
