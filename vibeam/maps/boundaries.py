"""Exact boundaries of motions with one impact over a plane of frequency and another key of the case.

Over the gap and the level of the drive they are contours of exact test functions (``periodic.contours``), on a platform
too; over any other key, which changes the structure, they are located to round-off along rows and joined from row to
row. A level scales the drive as the case has it: the base's amplitude is level · B₁(Ω).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.case.grid_keys import FREQUENCY, GAP, LEVELS, SHARE, STARTS, AxisPlan
from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.boundaries import Boundary, boundaries
from vibeam.periodic.contours import Plane
from vibeam.periodic.orbit_map import plane_boundaries
from vibeam_models.arrays import Array, Flags

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.fidelity import Model
    from vibeam.periodic.bifurcation_functions import DrivePerLevel

KINDS = {
    Kind.FOLD: "fold",
    Kind.GRAZING: "grazing",
    Kind.TOUCHING: "second touch",
    Kind.DOUBLING: "period doubling",
    Kind.NEIMARK_SACKER: "Neimark–Sacker",
}

SIDE = 81  # points of the grid along each axis, on which boundaries are looked for
PLACES = 121  # looked at along a row before each change of sign is bracketed
STEP = 3.0  # columns of the map by which a boundary may move from row to row and still be one curve


@dataclass(frozen=True)
class PlaneBoundary:
    """Boundary curve of one model: Hz, SI value of the key, impact velocity (m/s), all (points,) in order along it.

    ``branch``: 0 the harder impact, 1 the softer; ``clear``: the motion keeps clear of the stop between impacts.
    """

    fidelity: str
    kind: Kind
    branch: int
    frequency: Array
    value: Array
    velocity: Array
    clear: Flags

    @property
    def boundary(self) -> str:
        """Its kind in words."""
        return KINDS[self.kind]

    def parts(self) -> list[NDArray[np.int64]]:
        """Stretches of the curve that have an admissible motion."""
        found = np.split(np.arange(len(self.clear)), np.flatnonzero(np.diff(self.clear)) + 1)
        return [part for part in found if self.clear[part[0]]]


def boundaries_of(
    case: Case, fidelity: str, axes: Sequence[AxisPlan], outer: Sequence[tuple[str, float]] = (), periods: int = 1
) -> tuple[list[PlaneBoundary], str]:  # fmt: skip
    """Boundaries of a model over the last two of ``axes``, the others as in ``outer``; or why there are none."""
    if len(axes) < 2 or axes[-1].key != FREQUENCY or axes[-2].key in STARTS:
        return [], "no exact boundaries: they are known over the frequency and a key of the case"
    upward, across = axes[-2:]
    scaled = dict(outer).get(SHARE, 1.0)
    own = case.model(fidelity).at({key: value for key, value in outer if key != SHARE})
    system = own.system()
    hertz = _grid(across.values)
    if not np.all(own.amplitude(2 * np.pi * hertz)):
        return [], "no exact boundaries: a drive above 0 is needed"
    search = _Search(fidelity, own, upward, hertz, len(across.values), periods, scaled)
    if system.beyond_plain:
        what = " or ".join(system.beyond_plain)
        return [], f"no exact boundaries of {fidelity}: no closed form knows {what}"
    if upward.key == GAP:
        return list(search.over_gap()), ""
    if upward.key in (SHARE, *LEVELS):
        return (list(search.over_level()), "") if max(upward.values) > 0 else ([], "no exact boundaries: no drive")
    return list(search.by_rows()), ""


def gaps_at_contact(model: Model, values: Sequence[float] | Array) -> Array:
    """Gaps at the contact (m) of some of the case's, which may be at the sensor: a straight line through two."""
    low, high = float(min(values)), float(max(values))
    ends = [model.at({GAP: value}).system().gap for value in (low, high)]
    return ends[0] + (np.asarray(values) - low) * (ends[1] - ends[0]) / (high - low)


def level_of(model: Model, key: str) -> DrivePerLevel:
    """Amplitude of the drive (m) at a level of 1 of its key, at angular frequencies."""
    return (model if key == SHARE else model.at({key: 1.0})).amplitude


@dataclass(frozen=True)
class _Search:
    fidelity: str
    model: Model
    upward: AxisPlan
    hertz: Array
    columns: int  # of the map
    periods: int
    scaled: float  # share of the drive

    def over_gap(self) -> Iterator[PlaneBoundary]:
        values = _grid(self.upward.values)
        gaps = gaps_at_contact(self.model, values)
        yield from self._contours("gap", gaps, values, self.scaled, self.model.amplitude)

    def over_level(self) -> Iterator[PlaneBoundary]:
        levels = np.sort(self.upward.values)
        known = levels[levels > 0]
        values = np.linspace(known[0], known[-1], len(_grid(levels)))
        per_level = level_of(self.model, self.upward.key)
        yield from self._contours("amplitude", values, values, self.model.system().gap, per_level)

    def _contours(
        self, over: str, rows: Array, values: Array, held: float, drive: DrivePerLevel
    ) -> Iterator[PlaneBoundary]:
        if not np.all(np.diff(rows) > 0):
            return
        plane = Plane(self.model.system(), self.periods, over, 2 * np.pi * self.hertz, rows, held, drive)
        for each in plane_boundaries(plane):
            at = np.interp(each.value, rows, values)
            yield PlaneBoundary(
                self.fidelity, each.kind, each.branch, each.omega / (2 * np.pi), at, each.velocity, each.clear
            )

    def by_rows(self) -> Iterator[PlaneBoundary]:
        values = self.upward.values if len(self.upward.values) <= SIDE else _grid(self.upward.values)
        known = dict[tuple[Kind, int], list[list[Boundary]]]()
        for row, value in enumerate(values):
            model, share = self.model, self.scaled
            if self.upward.key == SHARE:
                share = share * float(value)
            else:
                model = model.at({self.upward.key: float(value)})
            met = along_row(model, self.hertz, self.periods, share)
            for each in met:
                rows = known.setdefault((each.kind, each.branch), [[] for _ in values])
                if each.clear:
                    rows[row].append(each)
        width = STEP / max(self.columns - 1, 1) * float(self.hertz[-1] - self.hertz[0])
        for (kind, branch), rows in known.items():
            places = [[each.omega / (2 * np.pi) for each in row] for row in rows]
            velocity = [{each.omega / (2 * np.pi): each.velocity for each in row} for row in rows]
            for curve in joined(places, width):
                at, hertz = (np.array(each) for each in zip(*curve, strict=True))
                speeds = np.array([velocity[row][place] for row, place in curve])
                clear = np.ones(len(curve), dtype=bool)
                yield PlaneBoundary(self.fidelity, kind, branch, hertz, np.array(values)[at], speeds, clear)


def along_row(
    model: Model, hertz: Array, periods: int = 1, share: float = 1.0, points: int = PLACES
) -> Sequence[Boundary]:
    """Boundaries of a model as it is over a range of frequencies (Hz), looked for in ``points`` places.

    Its drive times ``share``.
    """
    span = 2 * np.pi * float(hertz.min()), 2 * np.pi * float(hertz.max())
    found = boundaries(model.system(), share, span, periods, points=points, per_level=model.amplitude)
    return [each for each in found if each.kind in KINDS]


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


def _grid(values: Sequence[float] | Array, points: int = SIDE) -> Array:
    """Even grid over the range of an axis, ascending."""
    return np.linspace(min(values), max(values), points)
