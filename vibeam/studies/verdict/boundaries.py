"""Exact boundaries of motions with one impact a drive period over the plane.

Over gap and drive they are contours of exact test functions (``maps.boundaries``); over any other key, which changes
the structure, they are located to round-off along each row and joined from row to row.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from vibeam.case.grid_keys import GAP, LEVELS
from vibeam.maps.closed_form import boundaries_over
from vibeam.maps.points import GridPoints
from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.boundaries import boundaries
from vibeam.studies.stability.rows import NAMES
from vibeam.studies.verdict.axes import VerdictAxis
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.case.case import Case


PLACES = 121  # looked at along a row before each change of sign is bracketed
STEP = 3.0  # columns by which a boundary may move from row to row and still be one curve


@dataclass(frozen=True)
class ExactBoundary:
    """A boundary curve of motions that keep clear of the stop between impacts: Hz and the key's SI value, (points,).

    ``branch``: 0 the harder impact, 1 the softer.
    """

    fidelity: str
    boundary: str
    branch: int
    frequency: Array
    value: Array


def exact_boundaries(
    case: Case, name: str, points: GridPoints, axis: VerdictAxis, frequency: Array
) -> Iterator[ExactBoundary]:
    """The boundaries of a model; none beyond plain systems."""
    if points.systems[0].beyond_plain or not points.amplitude.all():
        return
    if axis.key == GAP or axis.key in LEVELS:
        yield from _over_plane(case, name, points, axis)
    else:
        yield from _rows(case, name, points, axis, STEP * float(frequency[1] - frequency[0]))


def _over_plane(case: Case, name: str, points: GridPoints, axis: VerdictAxis) -> Iterator[ExactBoundary]:
    def unit(omega: Array) -> Array:
        return np.asarray(case.amplitude_of(name, omega))

    own = points.amplitude[:, 0] / np.ravel(unit(points.omega[0, :1]))[0]
    over: Literal["gap", "amplitude"] = "gap" if axis.key == GAP else "amplitude"
    up = points.gap[:, 0] if over == "gap" else own
    if not np.all(np.diff(up) > 0):
        return
    for curve in boundaries_over(points.systems[0], over, points.omega[0], up, float(points.gap[0, 0]), unit):
        values = np.interp(curve.value, up, axis.values)
        yield ExactBoundary(name, NAMES[curve.kind], curve.branch, curve.frequency, values)


def _rows(case: Case, name: str, points: GridPoints, axis: VerdictAxis, width: float) -> Iterator[ExactBoundary]:
    """``width``: Hz by which a boundary may move from row to row."""
    model = case.model(name)
    known = dict[tuple[Kind, int], list[list[float]]]()
    for row in range(len(axis.values)):
        system = points.systems[int(points.which[row, 0])]
        if points.restitution is not None:
            system = replace(system, restitution=float(points.restitution[row, 0]))
        omega, gap = points.omega[row], float(points.gap[row, 0])
        own = model.at({axis.key: float(axis.values[row])})
        found = boundaries(
            system, 1.0, (float(omega.min()), float(omega.max())), 1, gap=gap, points=PLACES, kinds=tuple(NAMES),
            per_level=own.amplitude,
        )  # fmt: skip
        for each in found:
            rows = known.setdefault((each.kind, each.branch), [[] for _ in axis.values])
            if each.clear:
                rows[row].append(each.omega / (2 * np.pi))
    for (kind, branch), rows in known.items():
        for curve in joined(rows, width):
            at, hertz = np.array(curve).T
            yield ExactBoundary(name, NAMES[kind], branch, hertz, axis.values[at.astype(int)])


def joined(rows: Sequence[Sequence[float]], width: float) -> list[list[tuple[int, float]]]:
    """Places (row, frequency) joined to curves: each to the nearest in the next row that is within ``width``."""
    open_: list[list[tuple[int, float]]] = []
    done: list[list[tuple[int, float]]] = []
    for row, places in enumerate(rows):
        here, following = list(places), []
        for curve in open_:
            last = curve[-1][1]
            near = min(here, key=lambda each: abs(each - last), default=np.inf)
            if abs(near - last) <= width:
                here.remove(near)
                curve.append((row, near))
                following.append(curve)
            else:
                done.append(curve)
        open_ = [*following, *([(row, each)] for each in here)]
    return [*done, *open_]
