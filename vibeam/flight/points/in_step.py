"""Sweeps of many plain systems in step: at one frequency after another, all systems side by side.

Each point starts from the state in which the one before it ended, as in a sweep of one system; a system is packed once
for its whole sweep, and its state stays in the kernels' arrays.
"""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from vibeam.flight.engine.entries import run_points
from vibeam.flight.engine.threads import resumed
from vibeam.flight.event_driven import LONGEST_PERIOD
from vibeam.flight.kernels import layout
from vibeam.flight.points.kernels import layout as row
from vibeam.flight.points.points import (
    LIMIT,
    Packed,
    PlainPoints,
    PointSettings,
    lanes_of,
    packed_alike,
    room_of,
    task_of,
)  # fmt: skip
from vibeam.flight.readout import PointReadout
from vibeam.system.response import FrequencyResponse
from vibeam_models.arrays import Array


def compute_in_step(
    points: PlainPoints, omega: Array, amplitude: Array, settings: PointSettings
) -> list[FrequencyResponse]:
    """Response of each of the m points' systems at drives ``omega`` (k,), rad/s, in the order swept.

    ``points``: a point a system, with its start; its own drive is not read. ``amplitude`` (m, k) of the base, m.
    """
    found: dict[int, FrequencyResponse] = {}
    slowest = replace(points, omega=np.full(len(points.omega), omega.min()))
    for which, made in packed_alike(slowest, settings):
        curves = _in_step(slowest.of(which), made, omega, amplitude[which], settings)
        found.update(zip(which.tolist(), curves, strict=True))
    return [found[i] for i in range(len(points.omega))]


def _in_step(
    points: PlainPoints, made: list[Packed], omega: Array, amplitude: Array, settings: PointSettings
) -> list[FrequencyResponse]:
    """Responses of the points' systems, which are packed alike."""
    task = task_of(points, made, settings)
    lane, watch = lanes_of(task), room_of(made[0][0], settings)
    schedule = settings.settle, settings.hold, LIMIT, LONGEST_PERIOD, settings.most_modes
    readouts = [PointReadout(len(omega), points.systems[0].size) for _ in points.omega]
    begun = time.thread_time()
    for place, frequency in enumerate(omega):
        task.drives[:, 0], task.drives[:, 1] = frequency, amplitude[:, place]
        for each in (task.results, task.energy, task.counts, task.ended):
            each.fill(0)
        lane.whole[:] = 0
        lane.whole[:, row.PACK] = -1
        resumed(lambda first: run_points(task, lane, watch, first, *schedule))
        _put_to_rest(task, points, made)
        for i, readout in enumerate(readouts):
            ended, period = task.ended[i].tolist()
            readout.note(place, ended, period, task.results[i], task.energy[i], task.counts[i])
    _share_out(time.thread_time() - begun, readouts)
    return [_response(readout, points, made, i, omega, settings) for i, readout in enumerate(readouts)]


def _put_to_rest(task: row.Task, points: PlainPoints, made: list[Packed]) -> None:
    """Put systems whose point failed back to equilibrium, from which they go on."""
    for i in np.flatnonzero(task.ended[:, 0] != layout.COMPLETE):
        pose, kind = points.rest(np.array([i]))
        task.poses[i], task.kinds[i] = made[points.system[i]][0].inward(pose[0]), kind[0]


def _share_out(seconds: float, readouts: list[PointReadout]) -> None:
    """Share the time of all points out by their work."""
    work = [each.counts[:, layout.IMPACTS] + each.counts[:, layout.PANELS] + 1.0 for each in readouts]
    total = sum(float(each.sum()) for each in work)
    for each, own in zip(readouts, work, strict=True):
        each.seconds[:] = seconds * own / total


def _response(
    readout: PointReadout, points: PlainPoints, made: list[Packed], i: int, omega: Array, settings: PointSettings
) -> FrequencyResponse:
    response = readout.response(omega, settings.hold, float(points.gap[i]))
    response.mode_energy[:] = made[points.system[i]][0].outward(response.mode_energy)
    return response
