"""Decimation of histories: least and greatest value of every bin of time, the hardest impact of every bin.

What a picture of a million samples needs: no extreme and no impact is lost, whatever the bins. Histories merge into
coarser ones by whole bins, so that a zoom reads the same values as the whole. Those of an exact motion come from
``vibeam.extremes`` in as many bins.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from vibeam.system.record_pieces import blocks, integrated, turning_points
from vibeam_models.arguments import count, floats, refuse
from vibeam_models.arrays import Array, Index, ValueRecord

BINS = 2**16
MOST_BINS = 2**24


@dataclass(frozen=True, eq=False, repr=False)
class History(ValueRecord):
    """Least and greatest values (n,) of a quantity between successive ``edges`` (n + 1,), s, in its own unit.

    Every value within a bin lies between its two; both are reached in it.
    """

    edges: Array
    least: Array
    greatest: Array

    def __len__(self) -> int:
        return len(self.least)

    @property
    def time(self) -> Array:
        """Middles (n,) of the bins, s."""
        return np.asarray((self.edges[1:] + self.edges[:-1]) / 2)

    @property
    def peak(self) -> float:
        """Largest absolute value; 0 without bins."""
        return float(np.max(np.maximum(-self.least, self.greatest), initial=0.0))

    def within(self, begin: float, end: float, most: int = 2000) -> History:
        """History of the bins that meet [``begin``, ``end``], s, whole ones merged until there are ``most`` at most."""
        first = int(np.clip(np.searchsorted(self.edges, begin, side="right") - 1, 0, len(self) - 1))
        last = int(np.clip(np.searchsorted(self.edges, end, side="left"), first + 1, len(self)))
        starts = np.arange(first, last, -(-(last - first) // most))
        return History(
            self.edges[[*starts, last]],
            np.minimum.reduceat(self.least[:last], starts),
            np.maximum.reduceat(self.greatest[:last], starts),
        )


def _empty(begin: float, end: float, bins: int) -> History:
    """Bins without any value yet; ValueError for a span or a number of bins that makes none."""
    faults: list[str] = []
    count("bins", bins, faults, least=1, most=MOST_BINS)
    if not end > begin:
        faults.append(f"end {end:g} must be after begin {begin:g}")
    refuse("history", faults)
    return History(np.linspace(begin, end, bins + 1), np.full(bins, np.inf), np.full(bins, -np.inf))


def _take(into: History, times: Array, values: Array) -> None:
    """Let ``values`` at ``times`` count in their bins, those at an edge in that after it; those outside in none."""
    inside = (times >= into.edges[0]) & (times <= into.edges[-1])
    at = np.minimum(np.searchsorted(into.edges, times[inside], side="right") - 1, len(into) - 1)
    np.minimum.at(into.least, at, values[inside])
    np.maximum.at(into.greatest, at, values[inside])


def _take_edges(into: History, values: Array) -> None:
    """Let the values (n + 1,) at the edges count on both sides."""
    for side in (values[:-1], values[1:]):
        np.minimum(into.least, side, out=into.least)
        np.maximum(into.greatest, side, out=into.greatest)


def history_of_cubics(
    knots: ArrayLike, coefficients: ArrayLike, begin: float | None = None, end: float | None = None, bins: int = BINS
) -> History:
    """History of Σ c_j s^j between successive ``knots`` (k + 1,), s, with ``coefficients`` (k, 4): exact.

    From ``begin`` to ``end`` (s, None: the first and the last knot); before and behind the knots it is 0. At a knot
    where it jumps both values count. ValueError for shapes that do not fit, or no bin.
    """
    times, rows = floats("knots", knots), floats("coefficients", coefficients)
    if len(times) < 2 or rows.shape != (len(times) - 1, 4):
        raise ValueError(f"coefficients: {rows.shape}, must be (k, 4) of k + 1 knots, of which there are {len(times)}")
    found = _empty(times[0] if begin is None else begin, times[-1] if end is None else end, bins)
    for part in blocks(len(rows)):
        _take_cubics(found, times[part.start : part.stop + 1], rows[part])
    at = np.clip(np.searchsorted(times, found.edges, side="right") - 1, 0, len(rows) - 1)
    outside = (found.edges < times[0]) | (found.edges > times[-1])
    _take_edges(found, np.where(outside, 0.0, integrated(rows[at], found.edges - times[at], 0)))
    return found


def _take_cubics(into: History, times: Array, rows: Array) -> None:
    """Let the cubics between successive ``times`` count: at both ends of each and where it turns."""
    spans = np.diff(times)
    _take(into, times[:-1], rows[:, 0])
    _take(into, np.nextafter(times[1:], times[0]), integrated(rows, spans, 0))
    which, s = turning_points(rows, spans)
    _take(into, times[which] + s, integrated(rows[which], s, 0))


def cubics_of(times: Array, values: Array, rates: Array | None = None) -> Array:
    """Coefficients (k, 4) of the cubics through ``values`` with ``rates`` at ``times`` (k + 1,); lines without rates.

    Two samples at one time are a jump.
    """
    spans, rises = np.diff(times), np.diff(values)
    slope = np.divide(rises, spans, out=np.zeros_like(rises), where=spans > 0)
    if rates is None:
        return np.stack([values[:-1], slope, 0 * slope, 0 * slope], axis=1)
    v, w = rates[:-1], rates[1:]
    second = np.divide(3 * slope - 2 * v - w, spans, out=np.zeros_like(rises), where=spans > 0)
    third = np.divide(v + w - 2 * slope, spans**2, out=np.zeros_like(rises), where=spans > 0)
    return np.stack([values[:-1], v, second, third], axis=1)


def history_of_samples(
    times: ArrayLike, values: ArrayLike, rates: ArrayLike | None = None, bins: int = BINS
) -> History:
    """History of samples (k,) at ascending ``times``, s: of lines between them, of cubics where ``rates`` are given.

    ValueError for arrays of different lengths.
    """
    at, known = floats("times", times), floats("values", values)
    slopes = None if rates is None else floats("rates", rates)
    if not len(at) == len(known) == len(known if slopes is None else slopes):
        raise ValueError(f"values: {len(known)} of them at {len(at)} times")
    return history_of_cubics(at, cubics_of(at, known, slopes), bins=bins)


def hardest_impacts(times: ArrayLike, velocities: ArrayLike, edges: ArrayLike) -> tuple[Array, Array, Index]:
    """Time (m,), s, and velocity of the hardest impact of every bin that has any, and how many it has."""
    at, speeds, bounds = floats("times", times), floats("velocities", velocities), floats("edges", edges)
    bins = np.searchsorted(bounds, at, side="right")
    order = np.lexsort((speeds, bins))
    _, first, many = np.unique(bins[order], return_index=True, return_counts=True)
    hardest = order[first + many - 1]
    return at[hardest], speeds[hardest], many.astype(np.int64)
