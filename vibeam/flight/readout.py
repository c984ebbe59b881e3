"""What the kernels tell of each point of a sweep, and how it reads as a frequency response."""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.layout import (
    COMPLETE,
    CONTACT_LEAST,
    COUNT_ROWS,
    EVENT_LIMIT,
    HIGH,
    IMPACTS,
    KEPT,
    LEAST,
    NOT_FINITE,
    PANELS,
    PENETRATED,
    REST_TIME,
    RESULT_ROWS,
    SPEED_SUM,
    STRUCK,
    UNRESOLVED,
    VELOCITY,
)
from vibeam.system.response import VELOCITIES_KEPT, Ended, FrequencyResponse

Array = NDArray[np.float64]

OUTCOMES = {
    COMPLETE: Ended.COMPLETE,
    EVENT_LIMIT: Ended.EVENT_LIMIT,
    PENETRATED: Ended.PENETRATED,
    NOT_FINITE: Ended.NOT_FINITE,
    UNRESOLVED: Ended.UNRESOLVED,
}

CODES = np.array([OUTCOMES.get(outcome, Ended.NOT_RUN).code for outcome in range(max(OUTCOMES) + 1)])


class PointReadout:
    """Filled point by point as the sweep goes, read as a whole: a point costs microseconds, and so may its notes."""

    def __init__(self, points: int, modes: int) -> None:
        self.result, self.energy = np.zeros((points, RESULT_ROWS)), np.zeros((points, modes))
        self.counts = np.zeros((points, COUNT_ROWS), dtype=np.int64)
        self.ended, self.period = np.zeros(points, dtype=np.int64), np.zeros(points, dtype=np.int64)
        self.seconds = np.zeros(points)

    def note(
        self, index: int, outcome: int, period: int, result: Array, energy: Array, counts: NDArray[np.int64]
    ) -> None:
        """Keep what a point came to: see ``kernels.layout`` for the rows."""
        self.result[index], self.energy[index], self.counts[index] = result, energy, counts
        self.ended[index], self.period[index] = outcome, period

    def time(self, index: int, begun: float) -> float:
        """Keep the CPU time since ``begun``; the time now."""
        now = time.thread_time()
        self.seconds[index] = now - begun
        return now

    def response(self, omegas: Array, hold: int, gap: float) -> FrequencyResponse:
        """The points at ``omegas``, rad/s, each read over ``hold`` periods, in the kernels' order of modes."""
        response = FrequencyResponse.empty(omegas / (2 * np.pi), self.energy.shape[1])
        response.ended[:], response.cpu_seconds[:] = CODES[self.ended], self.seconds
        response.impacts[:], response.evaluations[:] = self.counts[:, IMPACTS], self.counts[:, PANELS]
        done = self.ended == COMPLETE
        result, struck, span = self.result[done], self.result[done, STRUCK], hold * 2 * np.pi / omegas[done]
        touched = (struck > 0) | (result[:, REST_TIME] > 0)
        response.maximum[done], response.minimum[done] = result[:, HIGH], result[:, LEAST]
        response.amplitude[done] = (result[:, HIGH] - result[:, LEAST]) / 2
        response.reach[done] = gap - result[:, CONTACT_LEAST]
        response.impacts_per_period[done] = struck / hold
        response.impact_velocity[done] = result[:, SPEED_SUM] / np.where(struck > 0, struck, np.nan)
        response.impact_velocities[done] = _velocities(result[:, VELOCITY:], struck.astype(int))
        response.period[done] = np.where(touched, self.period[done], -1)
        response.rest[done] = result[:, REST_TIME] / span
        response.mode_energy[done] = self.energy[done] / span[:, None]
        return response


def _velocities(rings: Array, counts: NDArray[np.int64]) -> Array:
    """The last velocities (points, 16) of rings (points, KEPT), oldest first, NaN in front where there are fewer."""
    place = np.arange(KEPT)[None, :] + counts[:, None]
    kept = np.full((len(counts), VELOCITIES_KEPT), np.nan)
    found = np.take_along_axis(rings[:, :KEPT], place % KEPT, axis=1)
    kept[:, VELOCITIES_KEPT - KEPT :] = np.where(place >= KEPT, found, np.nan)
    return kept
