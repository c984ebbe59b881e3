"""One block of lines of a grid: a description that can be sent anywhere, and its numbers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import prod
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from vibeam.case.grid_keys import DISPLACEMENT, STARTS, VELOCITY
from vibeam.flight.engine.threads import pause
from vibeam.maps.irregular import judged
from vibeam.maps.points import (
    Axis,
    GridPoints,
    Starts,
    grid_points,
    lines_of,
    random_starts,
    shape_of,
    start_states,
    values_at,
)
from vibeam.store.blocks import Values
from vibeam_models.arrays import Array, Flags

if TYPE_CHECKING:
    from vibeam.batches.response import BatchResponse
    from vibeam.case.fidelity import Model
    from vibeam.maps.shot_lines import ShotLine
    from vibeam.periodic.orbit import Orbit


Way = Literal["up", "down", "harder", "softer"]  # of a sweep; motions with one impact, by which of the two it is
Source = Literal["flown", "judged", "orbits"]
CODES = ("period", "ended", "resting", "kind", "admissible", "stable")
DTYPES: Mapping[str, type] = dict.fromkeys(CODES, np.int16)
SWEPT = ("period", "ended", "state", "resting", "cpu_seconds")  # read of sweeps that are judged, beside a quantity
LED = 12  # lines on each side by which motions are led to the first line of a block, about
LEAST = 20  # drive periods of the mean of a Lyapunov exponent

QUANTITIES = (
    "amplitude", "reach", "maximum", "minimum", "impacts_per_period", "impact_velocity", "period", "rest", "energy",
    "strobes", "state", "resting", "lyapunov", "ended", "cpu_seconds",
)  # fmt: skip


@dataclass(frozen=True)
class Grid:
    """Evaluation over a grid, as plain data: equal grids give equal numbers, to the bit.

    ``model``: of one fidelity. The last of the ``axes`` is swept: with ``ways`` (up, down or first up, then down) the
    state is carried from point to point along it, and every line begins at equilibrium; without any, every point starts
    from equilibrium, from where the axes say, or from ``starts``. ``frequency`` in Hz, where that is no axis;
    ``settle`` and ``hold`` in drive periods; ``strobes``: how many values of the output at the end of a period are
    read. ``lanes``: lines, or points apart, fly side by side where they can (``vibeam.batch``). ``motions``: "flown";
    "judged": those that do not repeat are followed further (``irregular``); "orbits": with one impact in ``periods``
    in closed form, or with contacts by shooting where no closed form knows the model.
    """

    model: Model
    axes: tuple[Axis, ...]
    ways: tuple[Way, ...]
    settle: int
    hold: int
    output: str
    quantities: tuple[str, ...]
    frequency: float | None = None
    strobes: int = 0
    starts: Starts | None = None
    lanes: bool = True
    motions: Source = "flown"
    periods: int = 1

    @property
    def fidelity(self) -> str:
        """Name of its fidelity."""
        return self.model.fidelity.name

    @property
    def lines(self) -> int:
        """Number of lines."""
        return lines_of(self.axes)

    @property
    def shape(self) -> tuple[int, ...]:
        """Points of a line of one quantity of one number: ways (one where there is none), last axis, starts."""
        starts = () if self.starts is None else (self.starts.count,)
        return (max(len(self.ways), 1), shape_of(self.axes)[-1], *starts)


@dataclass(frozen=True)
class Block:
    """Lines ``first`` to ``last`` (not itself) of a grid."""

    grid: Grid
    first: int
    last: int

    @property
    def size(self) -> int:
        """Number of points: ways and random starts are counted each."""
        return (self.last - self.first) * prod(self.grid.shape)


def evaluate_block(block: Block, threads: int | None = None) -> Values:
    """Every quantity of a block, (lines, ways, points of the last axis, starts …): a function of the block alone.

    The same to the bit wherever and in however many threads. ``Stopped`` or KeyboardInterrupt pass through.
    """
    grid = block.grid
    lines = np.arange(block.first, block.last)
    points = grid_points(grid.model, grid.axes, grid.frequency, lines)
    if grid.motions == "orbits":
        return _orbits(grid, points, block.first)
    if grid.motions == "judged":
        swept = _carried(replace(grid, quantities=(grid.quantities[0], *SWEPT)), points, threads)
        return judged(points, swept, grid.quantities[0], grid.hold, grid.output)
    if grid.ways:
        return _carried(grid, points, threads)
    return _apart(grid, points, block.first, threads)


def _carried(grid: Grid, points: GridPoints, threads: int | None) -> Values:
    """Column by column, the state carried; all lines side by side."""
    columns = points.omega.shape[1]
    found = [dict[int, Values]() for _ in grid.ways]
    before: BatchResponse | None = None
    for way, columns_of_way in zip(grid.ways, found, strict=True):
        for column in range(columns) if way == "up" else range(columns - 1, -1, -1):
            pause()
            before = _flown(grid, points, np.s_[:, column], _back_on_stop(points, column, before), threads)
            columns_of_way[column] = _read(grid, before)
    return {
        name: np.stack([np.stack([way[at][name] for at in range(columns)], axis=1) for way in found], axis=1)
        for name in grid.quantities
    }


def _orbits(grid: Grid, points: GridPoints, first: int) -> Values:
    """Motions with one impact, the harder and the softer, of each system with its restitution.

    By shooting, line by line, for systems that no closed form knows.
    """
    shape = points.omega.shape
    found = {name: np.empty((*shape, 2), DTYPES.get(name, float)) for name in grid.quantities}
    reads = _shot(grid, points, first) if any(each.beyond_plain for each in points.systems) else _closed(grid, points)
    for part, read in reads:
        for name, values in zip(grid.quantities, read, strict=True):
            found[name][part] = values
    return {name: np.moveaxis(values, 2, 1) for name, values in found.items()}


def _closed(grid: Grid, points: GridPoints) -> Iterator[tuple[Any, Sequence[Array | Flags]]]:
    from vibeam.periodic.orbit_map import orbit_points

    rebound = np.zeros(points.omega.shape) if points.restitution is None else points.restitution
    for which, own in dict.fromkeys(zip(points.which.flat, rebound.flat, strict=True)):
        mine = (points.which == which) & (rebound == own)
        system = points.system_at(int(np.flatnonzero(mine)[0]))
        yield mine, orbit_points(system, grid.periods, points.omega[mine], points.amplitude[mine], points.gap[mine])


def _shot(grid: Grid, points: GridPoints, first: int) -> Iterator[tuple[Any, Sequence[Array | Flags]]]:
    """Lines in turn, each begun from the motions of the one before, the first from those that others lead to."""
    columns = points.omega.shape[1]
    before: list[list[Orbit]] = [[] for _ in range(columns)]
    at = np.unique([columns // 6, columns // 2, columns - 1 - columns // 6])
    for way in range(first), range(grid.lines - 1, first, -1):
        for column, motions in zip(at, _led(grid, way[:: 1 + len(way) // LED], at), strict=True):
            before[column] += motions
    for row in range(len(points.omega)):
        shot = _line(grid, points, row, np.arange(columns))
        shot.fill(before)
        before = shot.motions
        yield row, shot.points()


def _led(grid: Grid, lines: Sequence[int], columns: Any) -> list[list[Orbit]]:
    """Motions in some columns of the last of some lines, each line begun from the one before."""
    before: list[list[Orbit]] = [[] for _ in columns]
    for each in lines:
        line = _line(grid, grid_points(grid.model, grid.axes, grid.frequency, np.array([each])), 0, columns)
        line.fill(before, searches=0 if any(before) else 1)
        before = line.motions if any(line.motions) else before
    return before


def _line(grid: Grid, points: GridPoints, row: int, columns: Any) -> ShotLine:
    from vibeam.maps.shot_lines import ShotLine

    places = row * points.omega.shape[1] + columns
    return ShotLine([(points.system_at(at), points.drive_at(at)) for at in places.tolist()], grid.periods)


def _back_on_stop(points: GridPoints, column: int, before: BatchResponse | None) -> BatchResponse | None:
    """States admissible to the stops of the next column: one beyond its stop, or that rested on it, is put onto it."""
    if before is None or np.array_equal(points.gap[:, column], points.gap[:, column - 1]):
        return before
    if any(system.contact_law.yields for system in points.systems):  # a contact may lie beyond its stop
        return before
    contacts = np.array([system.contact for system in points.systems])[points.which[:, column]]
    n = contacts.shape[1]
    beyond = np.sum(before.state[:, :n] * contacts, axis=1) - points.gap[:, column]
    moved = before.state.copy()
    shift = np.where((beyond > 0) | before.resting, beyond, 0.0) / np.sum(contacts**2, axis=1)
    moved[:, :n] -= shift[:, None] * contacts
    return replace(before, state=moved)


def _apart(grid: Grid, points: GridPoints, first: int, threads: int | None) -> Values:
    """Every point by itself, from its own start or starts."""
    state: Array | None = None
    if grid.starts is not None:
        state = start_states(points, *random_starts(points, first, grid.starts))
    elif any(axis.key in STARTS for axis in grid.axes):
        place = [values_at(grid.axes, points.index, key) for key in (DISPLACEMENT, VELOCITY)]
        given = [np.zeros(points.omega.shape) if each is None else each for each in place]
        state = start_states(points, given[0][..., None], given[1][..., None])[..., 0, :]
    found: Values = {}
    for part in _of_one_size(points):
        response = _flown(grid, points, part, None if state is None else state[part], threads)
        for name, values in _read(grid, response).items():
            shape = (*points.omega.shape, *values.shape[1:])
            found.setdefault(name, np.empty(shape, dtype=values.dtype))[part] = values
    return {name: values[:, None] for name, values in found.items()}


def _of_one_size(points: GridPoints) -> list[Any]:
    """Masks of the points whose systems have the same number of modes."""
    modes = np.array([system.size for system in points.systems])[points.which]
    return [modes == size for size in np.unique(modes)]


def _flown(
    grid: Grid, points: GridPoints, part: Any, state: Array | BatchResponse | None, threads: int | None
) -> BatchResponse:
    from vibeam.batches.batch import batch

    wide = isinstance(state, np.ndarray) and state.ndim == 3  # several starts a point

    def rows(values: Any) -> Any:
        return values[part][:, None] if wide else values[part]

    restitution = None if points.restitution is None else rows(points.restitution)
    return batch(
        points.systems_of(rows(points.which)), rows(points.omega), rows(points.amplitude), gap=rows(points.gap),
        restitution=restitution, state=state, settle=grid.settle, hold=grid.hold, output=grid.output,
        strobes=grid.strobes, lanes=grid.lanes,
        lyapunov=max(grid.hold, LEAST) if "lyapunov" in grid.quantities else 0, threads=threads,
    )  # fmt: skip


def _read(grid: Grid, response: BatchResponse) -> Values:
    """Quantities of points by name."""
    every: dict[str, Any] = vars(response) | {"energy": np.sum(response.mode_energy, axis=-1)}
    return {name: np.asarray(every[name], dtype=DTYPES.get(name, float)) for name in grid.quantities}
