"""Readout of a trace's rows, and of the points of a sweep: the kernels' rows of each as a frequency response."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.system.response import Ended, FrequencyResponse
from vibeam_models.arrays import Array, Flags, Index

STRUCK = (layout.IMPACT, layout.CHATTER, layout.STUCK)  # ends of segments that are impacts
OUTCOMES = {
    layout.COMPLETE: Ended.COMPLETE,
    layout.EVENT_LIMIT: Ended.EVENT_LIMIT,
    layout.PENETRATED: Ended.PENETRATED,
    layout.NOT_FINITE: Ended.NOT_FINITE,
    layout.UNRESOLVED: Ended.UNRESOLVED,
}
#: places in a ring from the oldest on, by what it counted
AGES = (np.arange(layout.KEPT) + np.arange(layout.KEPT)[:, None]) % layout.KEPT
#: number of velocities there must have been for the first of them to stand there
FIRST = layout.KEPT - np.arange(layout.KEPT)
CODES = np.array([OUTCOMES.get(outcome, Ended.NOT_RUN).code for outcome in range(max(OUTCOMES) + 1)])


def struck(trace: Array) -> Flags:
    """True for the segments (m,) of a trace that end with an impact."""
    return np.isin(trace[:, layout.END], STRUCK)


def rests(trace: Array) -> Flags:
    """True for the segments (m,) of a trace that are rests and take time."""
    return np.asarray((trace[:, layout.WHAT] == layout.RESTING) & (trace[:, layout.DURATION] > 0))


def sides(trace: Array) -> Index:
    """Stop (m,) that each segment of a trace starts at or ends at; 0 where the kernels know one alone."""
    if trace.shape[1] <= regime_layout.AT_SIDE:
        return np.zeros(len(trace), dtype=np.int64)
    return np.asarray(trace[:, regime_layout.AT_SIDE], dtype=np.int64)


class PointReadout:
    """Filled point by point as the sweep goes, read as a whole: a point costs microseconds, and so may its notes."""

    def __init__(self, points: int, modes: int) -> None:
        self.result, self.energy = np.zeros((points, layout.RESULT_ROWS)), np.zeros((points, modes))
        self.counts = np.zeros((points, layout.COUNT_ROWS), dtype=np.int64)
        self.ended, self.period = np.zeros(points, dtype=np.int64), np.zeros(points, dtype=np.int64)
        self.seconds = np.zeros(points)

    def note(self, index: int, outcome: int, period: int, result: Array, energy: Array, counts: Index) -> None:
        """Keep what a point came to: see ``kernels.layout`` for the rows."""
        self.result[index], self.energy[index], self.counts[index] = result, energy, counts
        self.ended[index], self.period[index] = outcome, period

    def time(self, index: int, begun: float) -> float:
        """Keep the CPU time since ``begun``; the time now."""
        now = time.thread_time()
        self.seconds[index] = now - begun
        return now

    def response(self, omegas: Array, hold: int, gap: float, reading: int = layout.EVERYTHING) -> FrequencyResponse:
        """The points at ``omegas``, rad/s, each read over ``hold`` periods, in the kernels' order of modes.

        ``reading``: how much was read off, see ``kernels.layout``; what was not is NaN.
        """
        response = self._noted(omegas, hold, gap)
        if reading < layout.REACH_TOO:
            response.reach[:] = np.nan
        if reading < layout.EVERYTHING:
            response.mode_energy[:] = np.nan
        return response

    def _noted(self, omegas: Array, hold: int, gap: float) -> FrequencyResponse:
        known = {
            "frequency": omegas / (2 * np.pi),
            "ended": CODES[self.ended],
            "impacts": self.counts[:, layout.IMPACTS],
            "evaluations": self.counts[:, layout.PANELS],
            "cpu_seconds": self.seconds,
        }
        if not self.ended.any():  # COMPLETE is 0
            return FrequencyResponse(**known, **self._readings(slice(None), omegas, hold, gap))
        done = self.ended == layout.COMPLETE
        response = FrequencyResponse.empty(known["frequency"], self.energy.shape[1])
        for name, values in self._readings(done, omegas[done], hold, gap).items():
            getattr(response, name)[done] = values
        return replace(response, **known)

    def _readings(self, which: slice | Flags, omegas: Array, hold: int, gap: float) -> dict[str, NDArray[Any]]:
        """Readings of the complete points ``which`` at ``omegas`` (m,) rad/s."""
        result, span = np.ascontiguousarray(self.result[which].T), hold * 2 * np.pi / omegas
        high, least, lowest, struck, speeds, rest = result[: layout.VELOCITY]
        return {
            "amplitude": (high - least) / 2,
            "reach": gap - lowest,
            "maximum": high,
            "minimum": least,
            "impacts_per_period": struck / hold,
            "impact_velocity": speeds / np.where(struck > 0, struck, np.nan),
            "impact_velocities": _velocities(result[layout.VELOCITY :].T, struck.astype(int)),
            "period": np.where(struck + rest > 0, self.period[which], -1),
            "rest": rest / span,
            "mode_energy": self.energy[which] / span[:, None],
        }


def _velocities(rings: Array, counts: Index) -> Array:
    """The last velocities (points, KEPT) of rings (points, KEPT), oldest first, NaN in front where there are fewer."""
    found: Array = rings[np.arange(len(counts))[:, None], AGES[counts % layout.KEPT]]
    found[counts[:, None] < FIRST] = np.nan
    return found
