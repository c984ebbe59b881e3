"""Steady points of plain systems, each with its gap, restitution, drive and start, by compiled code alone."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from threading import local

import numpy as np

from vibeam.flight.engine.call import items_of
from vibeam.flight.engine.entries import run_points
from vibeam.flight.engine.threads import resumed
from vibeam.flight.equilibrium import equilibria
from vibeam.flight.event_driven import LONGEST_PERIOD, ROWS
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.layout import Engine, Watch, watch_of
from vibeam.flight.linear.packing import PackedSystem
from vibeam.flight.points.kernels import layout as row
from vibeam.flight.points.packing import blank, held, packed, stacked
from vibeam.flight.readout import PointReadout
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import FrequencyResponse
from vibeam_models.arrays import Array, Flags, Index

LIMIT = 100_000  # impacts a drive period after which a point is given up, as of a sweep
_OWN = local()
SIDE_BY_SIDE = 8  # modes up to which points go side by side


@dataclass(frozen=True)
class PlainPoints:
    """Points (m,): systems of one number of modes and which of them each is of, drives in rad/s and m, gaps in m,
    restitutions; starts (m, 2, n), None: static equilibrium, and which of them rest on the stop.
    """

    systems: Sequence[ImpactSystem]
    system: Index
    omega: Array
    amplitude: Array
    gap: Array
    restitution: Array
    starts: Array | None = None
    resting: Flags | None = None

    def of(self, which: Index) -> PlainPoints:
        """Some of the points, and the systems that they are of."""
        used, system = np.unique(self.system[which], return_inverse=True)
        return PlainPoints(
            [self.systems[i] for i in used], system, self.omega[which], self.amplitude[which], self.gap[which],
            self.restitution[which], None if self.starts is None else self.starts[which],
            None if self.resting is None else self.resting[which],
        )  # fmt: skip

    def start(self, which: Index) -> tuple[Array, Array]:
        """Poses (k, 2, n) of points of one system, and whether FREE or RESTING, (k,)."""
        if self.starts is None:
            return self.rest(which)
        resting = np.zeros(len(which)) if self.resting is None else self.resting[which]
        return self.starts[which], np.where(resting, layout.RESTING, layout.FREE)

    def rest(self, which: Index) -> tuple[Array, Array]:
        """The same in static equilibrium."""
        gaps, places = np.unique(self.gap[which], return_inverse=True)
        poses, resting = equilibria(self.systems[self.system[which[0]]], gaps)
        return poses[places], np.where(resting[places], layout.RESTING, layout.FREE)


@dataclass(frozen=True)
class PointSettings:
    """Schedule of every point; ``most_modes`` up to which points go side by side, 0: each alone, as in a sweep.

    ``elastic``: whether all restitutions are next to 1, or none (``packing.packed``).
    """

    settle: int  # drive periods
    hold: int
    output: str
    strobes: int
    elastic: bool
    most_modes: int


@dataclass(frozen=True)
class PlainResults:
    """Points (m,) in the user's order of modes: what was read off, states (m, 2, n) after it, strobes (m, k)."""

    response: FrequencyResponse
    states: Array
    resting: Flags
    strobes: Array


Packed = tuple[PackedSystem, Engine]


def compute(points: PlainPoints, settings: PointSettings) -> list[tuple[Index, PlainResults]]:
    """Settle and watch every point: those that are packed alike, by their numbers, and what they came to."""
    return [(which, _run(points.of(which), made, settings)) for which, made in packed_alike(points, settings)]


def packed_alike(points: PlainPoints, settings: PointSettings) -> Iterator[tuple[Index, list[Packed]]]:
    """Points that are packed alike, by their numbers, and their systems packed."""
    slowest = float(points.omega.min())
    made = [packed(system, slowest, settings.elastic, settings.output) for system in points.systems]
    kind = np.array([engine.cells.size for _, engine in made])[points.system]
    for each in np.unique(kind):
        which = np.flatnonzero(kind == each)
        yield which, [made[i] for i in np.unique(points.system[which])]


def _output(packing: PackedSystem, settings: PointSettings) -> Array:
    """Row of the output in the kernels' order of modes."""
    return packing.inward(packing.system.output(settings.output))


def _run(points: PlainPoints, made: list[Packed], settings: PointSettings) -> PlainResults:
    begun, task = time.thread_time(), task_of(points, made, settings)
    lane, watch = lanes_of(task), room_of(made[0][0], settings)
    schedule = settings.settle, settings.hold, LIMIT, LONGEST_PERIOD, settings.most_modes
    resumed(lambda first: run_points(task, lane, watch, first, *schedule))
    return _results(points, made, task, settings.hold, time.thread_time() - begun)


def task_of(points: PlainPoints, made: list[Packed], settings: PointSettings) -> row.Task:
    """The arrays of the points, as the kernels take them."""
    m, n, blocks = len(points.omega), points.systems[0].size, made[0][1].rest.blocks.shape[1]
    at, constants, offsets = np.zeros((m, n)), np.zeros((m, 2, blocks)), np.zeros((m, 2 + n))
    poses, kinds = np.zeros((m, 2, n)), np.zeros(m)
    for i, (packing, engine) in enumerate(made):
        which, output = np.flatnonzero(points.system == i), _output(packing, settings)
        gaps, places = np.unique(points.gap[which], return_inverse=True)
        found = held(engine, output, gaps)
        for target, values in zip((at, constants, offsets[:, :2]), found, strict=True):
            target[which] = values[places]
        offsets[which, 2:] = output
        start, kinds[which] = points.start(which)
        poses[which] = packing.inward(start)
    return row.Task(
        stacked([engine for _, engine in made]), points.system.astype(np.int64),
        np.stack([points.omega, points.amplitude, points.gap, points.restitution], axis=1),
        at, constants, offsets, poses, kinds,
        np.zeros((m, layout.RESULT_ROWS)), np.zeros((m, n)), np.zeros((m, settings.strobes)),
        np.zeros((m, layout.COUNT_ROWS), dtype=np.int64), np.zeros((m, 2), dtype=np.int64),
    )  # fmt: skip


def lanes_of(task: row.Task) -> row.Lane:
    """Lanes without points: the calling thread's last ones where they fit, since to fill a call's slots costs more."""
    width, n = row.WIDTH, task.energy.shape[1]
    shapes = tuple(array.shape[1:] for array in items_of(task.packs))
    if getattr(_OWN, "shapes", None) != shapes:
        _OWN.shapes, _OWN.lane = shapes, row.Lane(
            np.zeros(row.COMMON_ROWS * width), np.zeros(n * row.MODAL_ROWS * width), blank(task.packs, width),
            np.zeros((width, 2, n)), np.zeros((width, layout.STATUS_ROWS)),
            np.zeros((width, layout.COUNT_ROWS), dtype=np.int64),
            np.zeros((width, row.LANE_ROWS), dtype=np.int64), np.zeros((width, row.ALONE_ROWS)),
            np.zeros(row.MARK + n), np.zeros((row.FLIGHT_COMMON + n * row.FLIGHT_ROWS) * width),
        )  # fmt: skip
    lane: row.Lane = _OWN.lane
    lane.whole[:] = 0
    lane.whole[:, row.PACK] = -1
    return lane


def room_of(made: PackedSystem, settings: PointSettings) -> Watch:
    """Arrays by which a point is watched."""
    trace, poses = np.zeros((ROWS, layout.TRACE_COLUMNS)), np.zeros((ROWS, 2, made.system.size))
    return watch_of(_output(made, settings), settings.hold, trace, poses)


def _results(points: PlainPoints, made: list[Packed], task: row.Task, hold: int, seconds: float) -> PlainResults:
    readout = PointReadout(0, 0)
    readout.result, readout.energy, readout.counts = task.results, task.energy, task.counts
    readout.ended, readout.period = np.ascontiguousarray(task.ended[:, 0]), np.ascontiguousarray(task.ended[:, 1])
    work = task.counts[:, layout.IMPACTS] + task.counts[:, layout.PANELS] + 1.0
    readout.seconds = seconds * work / work.sum()
    response = readout.response(points.omega, hold, 0.0)
    np.add(response.reach, points.gap, out=response.reach)
    states, kinds = task.poses, task.kinds
    for i, (packing, _) in enumerate(made):
        which = np.flatnonzero(points.system == i)
        states[which] = packing.outward(states[which])
        response.mode_energy[which] = packing.outward(response.mode_energy[which])
        failed = which[readout.ended[which] != layout.COMPLETE]
        if len(failed):
            states[failed], kinds[failed] = points.rest(failed)
            task.strobes[failed] = np.nan
    return PlainResults(response, states, kinds == layout.RESTING, task.strobes)
