"""Clearance of periodic motions from the stop between their impacts, with certified bounds.

The gap d(τ) of ``gap`` has its local minima where d' rises through zero. On an interval of width h, with d'''' ≤ K,
d lies within K h⁴/384 of its cubic Hermite interpolant, d' within √3 K h³/216 of that one's derivative (Birkhoff &
Priver 1967) and d'' within K h²/8 of the straight line between its ends. An interval is left where these bounds show
that d is too large there, that d' keeps its sign or that d is concave; where d is convex and d' changes sign it holds
exactly one minimum; every other is halved. No minimum is passed over. Those that may be the least are found by Newton's
method.
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


class GapMinimum(NamedTuple):
    """Least local minimum of the gap strictly between two impacts, (motions,): ∞ and NaN where there is none."""

    value: Array
    time: Array


class _Pieces(NamedTuple):
    """Intervals that may hold a minimum: motion, begin and end of each, the gap there (4, m): see ``Gap``."""

    motion: Index
    left: Array
    right: Array
    first: Array
    last: Array

    @property
    def width(self) -> Array:
        return self.right - self.left

    def chosen(self, which: Flags) -> _Pieces:
        return _Pieces(self.motion[which], *(each[..., which] for each in self[1:]))


def least_minimum(flights: FlightGap, ceiling: Array) -> GapMinimum:
    """Least local minimum of every motion's gap; ∞ where all are above its ``ceiling`` (motions,), m."""
    best = GapMinimum(np.full(len(flights), np.inf), np.full(len(flights), np.nan))
    floor, most = SMALLEST * np.abs(flights.part), np.array(ceiling, dtype=float)  # above ``most`` none is the least
    pieces, single = _initial(flights), list[tuple[_Pieces, Array]]()
    for _ in range(HALVINGS):
        if not len(pieces.motion):
            break
        low = _least(pieces)
        open_, one = _classified(flights, pieces, low > most[pieces.motion] + floor[pieces.motion], floor)
        found = pieces.chosen(one)
        np.minimum.at(most, found.motion, np.minimum(found.first[0], found.last[0]))
        single.append((found, low[one]))
        pieces = _halved(flights, pieces.chosen(open_))
    if single:
        found, low = _joined([one for one, _ in single]), np.concatenate([each for _, each in single])
        near = found.chosen(low <= most[found.motion] + floor[found.motion])
        _update_least(best, ceiling, near.motion, *_minima(flights, near))
    _update_least(best, ceiling, pieces.motion, pieces.first[0], pieces.left)  # flat ones
    return best


def _joined(pieces: list[_Pieces]) -> _Pieces:
    ends = zip(*(each[1:] for each in pieces), strict=True)
    return _Pieces(np.concatenate([each.motion for each in pieces]), *(np.hstack(each) for each in ends))


def _initial(flights: FlightGap) -> _Pieces:
    """Initial intervals: a few a drive period for every motion."""
    counts = np.ceil(flights.omega * flights.span / (2 * np.pi) * FIRST - 1e-9).astype(int)
    motion = np.repeat(np.arange(len(flights)), counts)
    place = np.concatenate([np.arange(count) for count in counts]) if len(counts) else np.zeros(0)
    width, end = np.repeat(flights.span / counts, counts), place + 1 == np.repeat(counts, counts)
    left, right = place * width, np.where(end, flights.span[motion], (place + 1) * width)
    return _Pieces(motion, left, right, _gaps(flights, motion, left), _gaps(flights, motion, right))


def _gaps(flights: FlightGap, motion: Index, times: Array) -> Array:
    return np.stack(flights.gap(motion, times))


def _halved(flights: FlightGap, pieces: _Pieces) -> _Pieces:
    middle = (pieces.left + pieces.right) / 2
    first, at, last = pieces.first, _gaps(flights, pieces.motion, middle), pieces.last
    ends = np.concatenate([pieces.left, middle]), np.concatenate([middle, pieces.right])
    return _Pieces(np.tile(pieces.motion, 2), *ends, np.hstack([first, at]), np.hstack([at, last]))


def _inner(pieces: _Pieces) -> tuple[Array, Array]:
    """Bézier ordinates of the interpolants."""
    h = pieces.width
    return pieces.first[0] + h * pieces.first[1] / 3, pieces.last[0] - h * pieces.last[1] / 3


def _least(pieces: _Pieces) -> Array:
    """Lower bound of the gap in each interval."""
    values = np.minimum.reduce([pieces.first[0], *_inner(pieces), pieces.last[0]])
    return np.asarray(values - pieces.first[3] * pieces.width**4 / 384)


def _classified(flights: FlightGap, pieces: _Pieces, above: Flags, floor: Array) -> tuple[Flags, Flags]:
    """Classify intervals, but those ``above`` all that counts: those that stay open, and those with one minimum."""
    motion, h, a, b = pieces.motion, pieces.width, Gap(*pieces.first), Gap(*pieces.last)
    inner, most = _inner(pieces), a.fourth
    slopes = np.stack([a.slope, 3 * (inner[1] - inner[0]) / h, b.slope])
    miss = most * h**3 * np.sqrt(3) / 216
    bends, spread = np.stack([a.bend, b.bend]), most * h**2 / 8
    convex = bends.min(axis=0) > spread
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
        done = np.abs(following - time) <= 4e-16 * flights.span[pieces.motion]
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
