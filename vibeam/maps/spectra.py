"""Spectra of the output along the one axis of a map, from the states that its points settled in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibeam.case.grid_keys import FREQUENCY
from vibeam.flight.trajectory import simulate
from vibeam.maps.points import Axis, GridPoints, grid_points
from vibeam.observe.harmonics import spectrum_of
from vibeam.system.curves import evenly
from vibeam.system.quantities import Ended
from vibeam.system.state import State
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.maps.result import MapResult


LINES = 32  # spectra shown at most
PERIODS = 64  # drive periods of a spectrum
SAMPLES = 64  # a drive period


@dataclass(frozen=True)
class LineSpectrum:
    """Amplitude spectrum at one ``value`` of the axis: ``order``, multiples of the drive frequency; NaN: it failed."""

    value: float
    order: Array
    amplitude: Array


def spectra_along(result: MapResult, fidelity: str, way: int) -> list[LineSpectrum]:
    """Spectra at up to ``LINES`` values of the axis, one way; a sine reads its peak value."""
    (axis,) = result.plan.axes
    response = result[fidelity]
    count = len(axis.values)
    chosen = evenly(0, count - 1, LINES)
    line = (Axis(axis.key, axis.values),)
    given = None if axis.key == FREQUENCY else result.plan.frequency
    points = grid_points(result.case.model(fidelity), line, given, np.zeros(1, int))
    return [_spectrum(result, points, response.way(response.ways[way]), int(at)) for at in chosen]


def _spectrum(result: MapResult, points: GridPoints, known: Mapping[str, NDArray[Any]], at: int) -> LineSpectrum:
    system, drive = points.system_at(at), points.drive_at(at)
    value = result.plan.axes[0].values[at]
    if known["ended"][at] != Ended.COMPLETE.code:
        return LineSpectrum(value, np.empty(0), np.empty(0))
    n = system.size
    state = State(known["state"][at, :n], known["state"][at, n:], bool(known["resting"][at]))
    time = np.arange(PERIODS * SAMPLES) * 2 * np.pi / drive.omega / SAMPLES
    path = simulate(system, drive, PERIODS * 2 * np.pi / drive.omega, state)
    found = spectrum_of(time, path.at(np.minimum(time, path.t_end), result.plan.output))
    return LineSpectrum(value, found.frequency * 2 * np.pi / drive.omega, found.amplitude)
