"""Stretches of a record in which its load is smooth, and the load there as a function of one time."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from vibeam.system.record import Record
from vibeam_models.arrays import Array, Flags

MOST = 1000  # corners at which an integrator starts anew; where there are more, its steps are short in their place
JUMP = 1e-9  # share of the peak by which values differ on both sides of a knot
CORNER = 1e-5  # the same of slopes, times the shorter piece
FREE = 4.0  # pieces that a step may be long where there are no corners inside


@dataclass(frozen=True)
class SmoothStretch:
    """Stretch of a load to the time ``end`` (s), its ``level`` over time, and the ``longest`` step that sees it all."""

    end: float
    level: Callable[[float], float]
    longest: float


def stretches(record: Record, start: float, end: float) -> list[SmoothStretch]:
    """Stretches from ``start`` to ``end`` (s) between corners of the load, or its jumps where corners are many."""
    jumps, corners = _breaks(record)
    few = int(corners.sum()) <= MOST
    apart = jumps | corners if few else jumps
    apart[[0, -1]] = True
    marks = record.times[apart]
    edges = np.concatenate([marks[(marks > start) & (marks < end)], [end]])
    begins = np.concatenate([[start], edges[:-1]])
    return [_stretch(record, begin, last, FREE if few else 1.0) for begin, last in zip(begins, edges, strict=True)]


def _breaks(record: Record) -> tuple[Flags, Flags]:
    """Knots (K + 1,) at which the load jumps, and those at which its slope does; outside of the span it is 0."""
    lengths = np.diff(record.times)
    a, b, c, d = record.coefficients.T
    after, last = a + lengths * (b + lengths * (c + lengths * d)), b + lengths * (2 * c + lengths * 3 * d)
    shorter = np.minimum(np.concatenate([lengths[:1], lengths]), np.concatenate([lengths, lengths[-1:]]))
    peak = record.peak
    jumps = np.abs(_both(a, after)) > JUMP * peak
    return jumps, np.abs(_both(b, last)) * shorter > CORNER * peak


def _both(first: Array, last: Array) -> Array:
    return np.asarray(np.concatenate([first, [0.0]]) - np.concatenate([[0.0], last]))


def _stretch(record: Record, begin: float, end: float, pieces: float) -> SmoothStretch:
    """Load from ``begin`` to ``end``, whose first and last polynomial go on beyond these."""
    if begin >= record.end or end <= record.start:
        return SmoothStretch(end, lambda t: 0.0, np.inf)
    low = int(np.searchsorted(record.times, begin, side="right")) - 1
    high = int(np.searchsorted(record.times, end, side="left"))
    low, high = max(low, 0), min(high, len(record.coefficients))
    times, rows = record.times[low:high].tolist(), (record.sign * record.coefficients[low:high]).tolist()

    def level(t: float) -> float:
        piece = max(bisect_right(times, t) - 1, 0)
        a, b, c, d = rows[piece]
        s = t - times[piece]
        return float(a + s * (b + s * (c + s * d)))

    return SmoothStretch(end, level, pieces * float(np.diff(record.times[low : high + 1]).max()))
