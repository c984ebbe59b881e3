"""Boundaries of periodic motions as contour curves over a grid of two parameters.

A boundary is a zero of a test function of ``bifurcation_functions``. Where it differs in sign between neighbours of
the grid, the zero is bracketed to round-off on the exact expressions. Cell by cell these points are joined to curves,
which may turn back in either parameter, close or end.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.optimize.elementwise import find_root

from vibeam.periodic.bifurcation_functions import (
    DrivePerLevel,
    Kind,
    MotionsAt,
    clearances,
    driven,
    motions,
    test_function,
)
from vibeam.periodic.boundaries import JUMP, TOUCH
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, Flags, ValueRecord

Edge = tuple[int, int, int]  # row and column of the first end, and the direction 0: along the row, 1: along the column
NUDGE = 1e-9  # share of a step from a fold at which both of its motions are real
LOOKS = 24  # at an edge: a root takes about five, a jump is halved each time


@dataclass(frozen=True, eq=False, repr=False)
class BoundaryCurve(ValueRecord):
    """Boundary curve of one branch, all (points,) in order along it. SI units.

    ``branch``: 0 is the root with the harder impact, 1 the other; ``value``: of the plane's rows; ``velocity``: of the
    impact; ``clear``: the motion keeps clear of the stop between its impacts, proved, so that it is the boundary of a
    motion.
    """

    kind: Kind
    branch: int
    omega: Array
    value: Array
    amplitude: Array
    gap: Array
    velocity: Array
    clear: Flags

    def __len__(self) -> int:
        return len(self.omega)


@dataclass(frozen=True)
class Plane:
    """Plane of frequency (columns,) and amplitude or gap (rows,); the third, ``held``, is constant.

    With ``per_level`` an amplitude is that of the drive at level 1, times the level that stands in its place.
    """

    system: ImpactSystem
    periods: int
    over: str
    omega: Array
    values: Array
    held: float
    per_level: DrivePerLevel | None = None

    def at(self, omega: Array, values: Array) -> MotionsAt:
        """Both motions at points (points,) of the plane."""
        other = np.full(len(omega), self.held)
        amplitude, gap = (values, other) if self.over == "amplitude" else (other, values)
        return motions(self.system, self.periods, omega, amplitude * driven(self.per_level, omega), gap)

    def grid(self) -> MotionsAt:
        """Both motions at all grid points, row by row."""
        omega, values = np.meshgrid(self.omega, self.values)
        return self.at(omega.ravel(), values.ravel())

    def between(self, edges: list[Edge], share: Array) -> tuple[Array, Array]:
        """Frequencies and values (edges,) at a ``share`` along each edge."""
        row, column, along = np.array(edges, dtype=int).reshape(-1, 3).T
        low, high = self.omega[column], self.omega[column + (along == 0)]
        first, last = self.values[row], self.values[row + (along == 1)]
        return low + share * (high - low), first + share * (last - first)


def map_function(system: ImpactSystem, kind: Kind, branch: int, points: MotionsAt) -> Array:
    """Test function on the map; for grazing and touching extended beyond the boundary, where there is no motion.

    Boundaries that a fold or a grazing cuts off within a cell are found so; that cut itself is a jump, no zero. At
    grazing the harder impact vanishes and the softer one begins.
    """
    value = test_function(system, kind, branch, points)
    if kind is Kind.TOUCHING:
        return beyond_touching(value)
    if kind is not Kind.GRAZING:
        return value
    size = np.abs(points.total.unit * points.amplitude) * points.total.omega / system.mobility
    return np.where(np.isnan(value), size if branch == 0 else -size, value)


def beyond_touching(share: Array) -> Array:
    """Clearances as shares of the motion's size, −1 where there is no motion."""
    return np.where(np.isnan(share), -1.0, share)


def boundary_curves(plane: Plane, kind: Kind, branch: int, values: Array) -> list[BoundaryCurve]:
    """All curves of one boundary; ``values`` (rows, columns): its test function on the grid."""
    edges = _crossed_edges(values)
    share = _roots(plane, kind, branch, edges)
    known = {edge: float(at) for edge, at in zip(edges, share, strict=True) if np.isfinite(at)}
    chains = list(_chains(known, values.shape))
    return [curve for chain in chains for curve in _curves(plane, kind, branch, chain, known)]


def _crossed_edges(values: Array) -> list[Edge]:
    """Grid edges across which the test function changes sign."""
    positive, known = values > 0, np.isfinite(values)
    found: list[Edge] = []
    for along in (0, 1):
        first, last = ((slice(None), slice(-1)), (slice(None), slice(1, None))) if along == 0 else (
            (slice(-1), slice(None)), (slice(1, None), slice(None))
        )  # fmt: skip
        change = (positive[first] != positive[last]) & known[first] & known[last]
        found += [(int(row), int(column), along) for row, column in np.argwhere(change)]
    return found


def _roots(plane: Plane, kind: Kind, branch: int, edges: list[Edge]) -> Array:
    """Position of the zero along each edge, 0 … 1, to round-off; NaN for a jump or a pole."""
    if not edges:
        return np.zeros(0)
    places = np.array(edges)

    def test(share: Array, which: Array) -> Array:
        chosen = [(int(r), int(c), int(a)) for r, c, a in places[np.rint(which).astype(int).ravel()]]
        points = plane.at(*plane.between(chosen, np.ravel(share)))
        return map_function(plane.system, kind, branch, points).reshape(np.shape(share))

    which = np.arange(len(edges), dtype=float)
    span = np.zeros(len(edges)), np.ones(len(edges))
    ends = [np.abs(test(end, which)) for end in span]
    found = find_root(test, span, args=(which,), tolerances={"xatol": 1e-15}, maxiter=LOOKS)
    sound = np.abs(found.f_x) <= JUMP * np.maximum(*ends)
    return np.where(sound, found.x, np.nan)


def _chains(known: dict[Edge, float], shape: tuple[int, ...]) -> Iterator[list[Edge]]:
    """Crossed edges ordered along the curves through them."""
    beside: dict[Edge, list[Edge]] = {edge: [] for edge in known}
    for first, second in _links(known, shape):
        beside[first].append(second)
        beside[second].append(first)
    left = dict.fromkeys(sorted(known, key=lambda edge: len(beside[edge])))  # ends first, closed curves last
    while left:
        chain = [next(iter(left))]
        del left[chain[0]]
        while following := next((edge for edge in beside[chain[-1]] if edge in left), None):
            chain.append(following)
            del left[following]
        if len(chain) > 2 and chain[0] in beside[chain[-1]]:
            chain.append(chain[0])
        yield chain


def _links(known: dict[Edge, float], shape: tuple[int, ...]) -> Iterator[tuple[Edge, Edge]]:
    """Pairs of crossed edges joined by one cell; of four, each with its nearer neighbour."""
    cells = {
        cell for row, column, along in known for cell in ((row, column), (row - (along == 0), column - (along == 1)))
    }
    for row, column in sorted(cells):
        if not (0 <= row < shape[0] - 1 and 0 <= column < shape[1] - 1):
            continue
        around = [(row, column, 0), (row, column + 1, 1), (row + 1, column, 0), (row, column, 1)]
        crossed = [edge for edge in around if edge in known]
        if len(crossed) == 2:
            yield crossed[0], crossed[1]
        elif len(crossed) == 4:
            turned = known[around[0]] + known[around[3]] < 1
            pairs = ((0, 3), (1, 2)) if turned else ((0, 1), (2, 3))
            yield from ((around[i], around[j]) for i, j in pairs)


def _curves(
    plane: Plane, kind: Kind, branch: int, chain: list[Edge], known: dict[Edge, float]
) -> Iterator[BoundaryCurve]:
    """Boundary curves along a chain; of folds only those of motions that push at the stop."""
    share = np.array([known[edge] for edge in chain])
    omega, values = plane.between(chain, share)
    points = plane.at(omega, values)
    beside = _motions_beside_fold(plane, chain, share) if kind is Kind.FOLD else points
    grazing = kind is Kind.GRAZING
    strikes = np.ones(len(chain), dtype=bool) if grazing else beside.roots.impulse[:, branch] < 0
    clear = points.gap > points.total.offset if grazing else clearances(plane.system, beside, branch) > -TOUCH
    velocity = np.zeros(len(chain)) if grazing else beside.roots.velocity[:, branch]
    for part in np.split(np.arange(len(chain)), np.flatnonzero(np.diff(strikes)) + 1):
        if strikes[part[0]]:
            rows = omega[part], values[part], points.amplitude[part], points.gap[part], velocity[part], clear[part]
            yield BoundaryCurve(kind, branch, *rows)


def _motions_beside_fold(plane: Plane, chain: list[Edge], share: Array) -> MotionsAt:
    """Motions beside the points of a fold, on the side where they are real."""
    before = plane.at(*plane.between(chain, share - NUDGE))
    inside = np.where(np.isfinite(before.roots.impulse[:, 0]), -1, 1)
    return plane.at(*plane.between(chain, share + inside * NUDGE))
