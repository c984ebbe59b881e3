"""Clearance of periodic motions from the stop between their impacts, with certified bounds.

The gap d(τ) of ``gap`` has its local minima where d' rises through zero. On an interval of width h, with d'''' ≤ K,
d lies within K h⁴/384 of its cubic Hermite interpolant, d' within √3 K h³/216 of that one's derivative (Birkhoff &
Priver 1967) and d'' within K h²/8 of the straight line between its ends. An interval is left where these bounds show
that d is too large there, that d' keeps its sign or that d is concave; where d is convex and d' changes sign it holds
exactly one minimum, found by Newton's method; every other is halved. No minimum is passed over.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vibeam.periodic.gap import FlightGap, Gap
from vibeam_models.arrays import Array, Flags, Index

FIRST = 8  # initial intervals a drive period
HALVINGS = 45  # halvings after which a flat minimum counts as a point of inflection
SMALLEST = 1e-15  # share of the motion's size taken as round-off
STEPS = 60
CLOSE = 1e-9  # share of the span by which the last of Newton's steps moves a minimum: it is then known to its square


class GapMinimum(NamedTuple):
    """Least local minimum of the gap strictly between two impacts, (motions,): ∞ and NaN where there is none."""

    value: Array
    time: Array


class _Pieces(NamedTuple):
    """Intervals that may hold a minimum: motion, begin and end of each, the gap there (4, m)."""

    motion: Index
    left: Array
    right: Array
    first: Array
    last: Array

    def chosen(self, which: Flags) -> _Pieces:
        return _Pieces(self.motion[which], *(each[..., which] for each in self[1:]))


def least_minimum(flights: FlightGap, ceiling: Array) -> GapMinimum:
    """Least local minimum of every motion's gap; ∞ where all are above its ``ceiling`` (motions,), m."""
    best = GapMinimum(np.full(len(flights), np.inf), np.full(len(flights), np.nan))
    floor = SMALLEST * np.abs(flights.part)
    pieces = _initial(flights)
    for _ in range(HALVINGS):
        if not len(pieces.motion):
            return best
        open_, single = _classified(flights, pieces, np.minimum(best.value, ceiling), floor)
        found = pieces.chosen(single)
        if len(found.motion):
            _update_least(best, ceiling, found.motion, *_minima(flights, found))
        pieces = _halved(flights, pieces.chosen(open_))
    _update_least(best, ceiling, pieces.motion, pieces.first[0], pieces.left)  # flat ones
    return best


def _initial(flights: FlightGap) -> _Pieces:
    """Initial intervals: a few a drive period for every motion."""
    counts = np.ceil(flights.omega * flights.span / (2 * np.pi) * FIRST - 1e-9).astype(int)
    motion = np.repeat(np.arange(len(flights)), counts)
    place = np.concatenate([np.arange(count) for count in counts]) if len(counts) else np.zeros(0)
    width, last = np.repeat(flights.span / counts, counts), np.repeat(counts, counts) - 1
    left, right = place * width, np.where(place == last, flights.span[motion], (place + 1) * width)
    return _Pieces(motion, left, right, np.stack(flights.gap(motion, left)), np.stack(flights.gap(motion, right)))


def _halved(flights: FlightGap, pieces: _Pieces) -> _Pieces:
    middle = (pieces.left + pieces.right) / 2
    at = np.stack(flights.gap(pieces.motion, middle))
    left, right = np.concatenate([pieces.left, middle]), np.concatenate([middle, pieces.right])
    return _Pieces(np.tile(pieces.motion, 2), left, right, np.hstack([pieces.first, at]), np.hstack([at, pieces.last]))


def _classified(flights: FlightGap, pieces: _Pieces, ceiling: Array, floor: Array) -> tuple[Flags, Flags]:
    """Classify intervals: those that stay open, and those with exactly one minimum."""
    motion, h, a, b = pieces.motion, pieces.right - pieces.left, Gap(*pieces.first), Gap(*pieces.last)
    most = a.fourth
    inner = a.value + h * a.slope / 3, b.value - h * b.slope / 3  # Bézier ordinates of the interpolant
    low = np.minimum.reduce([a.value, *inner, b.value]) - most * h**4 / 384
    slopes = np.stack([a.slope, 3 * (inner[1] - inner[0]) / h, b.slope])
    miss = most * h**3 * np.sqrt(3) / 216
    bends, spread = np.stack([a.bend, b.bend]), most * h**2 / 8
    convex = bends.min(axis=0) > spread
    above = low > ceiling[motion] + floor[motion]
    steady = (slopes.min(axis=0) > miss) | (slopes.max(axis=0) < -miss) | (bends.max(axis=0) < -spread)
    tiny = floor[motion] * flights.omega[motion]  # tolerance inside the span
    falls = a.slope < np.where(pieces.left == 0, -tiny, tiny)
    rises = b.slope > np.where(pieces.right == flights.span[motion], tiny, -tiny)
    single = convex & falls & rises & ~above
    return ~above & ~steady & ~convex, single


def _minima(flights: FlightGap, pieces: _Pieces) -> tuple[Array, Array]:
    """Values and times of the one minimum in each interval: Newton's method on d', safeguarded by bisection."""
    low, high = pieces.left.copy(), pieces.right.copy()
    time = (low + high) / 2
    at = flights.gap(pieces.motion, time)
    for _ in range(STEPS):
        low, high = np.where(at.slope < 0, time, low), np.where(at.slope < 0, high, time)
        step = time - at.slope / at.bend
        following = np.where((step > low) & (step < high), step, (low + high) / 2)
        done = np.abs(following - time) <= CLOSE * flights.span[pieces.motion]
        time, at = following, flights.gap(pieces.motion, following)
        if done.all():
            break
    return at.value, time


def _update_least(best: GapMinimum, ceiling: Array, motion: Index, value: Array, time: Array) -> None:
    """Update, in place, the least minimum of each motion that is not above its ceiling."""
    order = np.argsort(-value, kind="stable")  # written in descending order: the least stays
    motion, value, time = motion[order], value[order], time[order]
    lower = (value < best.value[motion]) & (value <= ceiling[motion])
    best.value[motion[lower]], best.time[motion[lower]] = value[lower], time[lower]
