"""Comparison of two responses: what a model gets wrong of another one's, by two numbers and the differences in kind.

The *amplitude error* is the largest relative difference of the amplitudes over all places, in both directions of the
sweep, at which both make a motion of the same kind; where the reference has less than a tenth of its largest amplitude,
relative to that tenth; of motions that do not repeat, of means over neighbouring places. The *frequency error* is the
largest relative distance of ends of branches that both have. Where the kinds differ, and no end that both have
accounts for it, there is a *difference in kind*. A model suffices where both numbers are within what is asked, and no
difference in kind is wider than the frequency error allowed; where one of the two alone has contact, in the whole
sweep, none is narrow enough. Motions without contact count by their ends alone.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from vibeam.periodic.motion_kind import FREE, IRREGULAR, UNKNOWN, SteadyKind
from vibeam.runs.comparison.ends import SweptEnd, ends_of, matched
from vibeam.runs.comparison.errors import AmplitudeError, EndError, KindDifference, ResponseComparison
from vibeam.runs.comparison.places import (
    TOLERANCE,
    Simulator,
    SweptBranch,
    SweptPlace,
    bracketed,
    is_open,
    places_of,
    simulated,
    swept_branches,
)  # fmt: skip
from vibeam.system.response import Branches
from vibeam.system.state import StatesAfter
from vibeam_models.arrays import Array

LEAST = 0.1  # share of the largest amplitude, below which an error is relative to that
GROUP = 8  # neighbouring places over which the amplitude of a motion that does not repeat is averaged, at most
READINGS, SCATTER = 8, 0.01  # of such a motion, where single ones leave its mean more uncertain than that
PART = 0.1  # of the frequency error allowed, to which ends are bracketed
FAR = 3.0  # times the frequency error allowed, beyond which one end decides
ROUNDS = 8  # of bracketing
MOVED = 0.7  # share of the range between two ends in which the motions differ, at least, where they are one end


@dataclass(frozen=True, eq=False)
class Response:
    """Response of a model as places (in the order swept) by direction, with its ``simulator`` where there are any.

    Comparisons put places between those that there are.
    """

    places: dict[str, list[SweptPlace]]
    simulator: Simulator | None = None

    @classmethod
    def of(
        cls, branches: Branches, after: Mapping[str, StatesAfter] | None = None, simulator: Simulator | None = None
    ) -> Response:  # fmt: skip
        """Response of branches, which the ``simulator`` goes on with from the states ``after`` their points."""
        known = after or {}
        return cls({way: places_of(each, known.get(way)) for way, each in branches.items()}, simulator)

    @property
    def largest(self) -> float:
        """Largest amplitude of motions with contact."""
        sizes = [abs(each.amplitude) for several in self.places.values() for each in several if each.kind.strikes]
        return max(sizes, default=0.0)

    @property
    def cost(self) -> float:
        """Mean CPU time that a place took, s."""
        return float(np.mean([each.cost for several in self.places.values() for each in several] or [0]))

    def sharpen(self, way: str, frequency: float, tolerance: float) -> bool:
        """Bracket the end of a branch near a frequency; test whether there was one to bracket."""
        places = self.places[way]
        ends = (sorted((one.frequency, other.frequency)) for one, other in pairwise(places))
        found = (i for i, (low, high) in enumerate(ends) if low <= frequency <= high)
        open_ = [i for i in found if is_open(places[i], places[i + 1], tolerance)]
        if self.simulator is None or self.simulator.done or not open_:
            return False
        self.places[way] = bracketed(places, open_[0], self.simulator, tolerance)
        return True


def compared(ours: Response, reference: Response, narrowest: float = 0.01) -> ResponseComparison:
    """Compare a response with a reference; branches narrower than ``narrowest``, a share, are not told apart.

    Ends of branches that count are bracketed to a tenth of that, or to ``TOLERANCE`` where that is less.
    """
    ways, tolerance = [way for way in ours.places if way in reference.places], min(TOLERANCE, PART * narrowest)
    found = [_Direction(way, ours, reference, narrowest) for way in ways]
    for _ in range(ROUNDS):
        edges = {(one.way, edge) for one in found for edge in one.edges(tolerance)}
        made = [each.sharpen(*edge, tolerance) for edge in sorted(edges) for each in (ours, reference)]
        if True not in made:
            break
        found = [_Direction(way, ours, reference, narrowest) for way in ways]
    return _comparison(found, LEAST * reference.largest)


def _comparison(found: Sequence[_Direction], least: float) -> ResponseComparison:
    amplitudes = [each for one in found for each in one.amplitudes(least)]
    ends = [each for one in found for each in one.end_errors]
    kinds = [each for one in found for each in one.kind_differences()]
    return ResponseComparison(
        max(amplitudes, key=lambda each: (each.least, each.scatter < np.inf, abs(each.error)), default=None),
        max(amplitudes, key=lambda each: each.most, default=None),
        tuple(sorted(ends, key=lambda each: -abs(each.error))),
        tuple(sorted(kinds, key=lambda each: (not each.alone, -each.width))),
        len(amplitudes),
        tuple(each for one in found for each in one.unknown()),
    )


class _Pair(NamedTuple):
    """Range between neighbouring ends of either response, low to high in Hz, and the branches there."""

    low: float
    high: float
    ours: SweptBranch
    reference: SweptBranch


class _Direction:
    """Both responses in one direction of the sweep."""

    def __init__(self, way: str, ours: Response, reference: Response, narrowest: float) -> None:
        self.way, self.both, self.narrowest = way, (ours, reference), narrowest
        self.ours, self.theirs = (swept_branches(each.places[way]) for each in self.both)
        self.wide = [swept_branches(each.places[way], narrowest) for each in self.both]
        self._wide_at = [_Branches(each) for each in self.wide]
        kinds = [{each.kind for each in side.places[way]} for side in self.both]
        self.alone = {SteadyKind(FREE)} in kinds and any(each.strikes for several in kinds for each in several)
        self.pairs = list(_pairs(self.ours, self.theirs))
        every = [each for several in (self.ours, self.theirs) for each in several]
        self.opens = {each.start: each.open_start for each in every} | {each.end: each.open_end for each in every}
        pairs = matched(*(ends_of(each, way) for each in self.wide))
        self.matched = [each for each in pairs if self._has_moved(*each)]
        self.end_errors = [_end_error(one, other) for one, other in self.matched]

    def _has_moved(self, one: SweptEnd, other: SweptEnd) -> bool:
        """Test whether two ends are one that has moved: between them the motions differ, most of the way.

        Beginnings and ends of contact, and jumps of one kind of motion, are the same wherever they are.
        """
        if one.before.strikes != one.after.strikes or one.before == one.after:
            return True
        low, high = sorted((one.frequency, other.frequency))
        parts = [
            min(each.high, high) - max(each.low, low)
            for each in self.pairs if each.ours.kind != each.reference.kind and each.low < high and each.high > low
        ]  # fmt: skip
        return high - low <= one.open + other.open or sum(parts) >= MOVED * (high - low)

    def edges(self, tolerance: float) -> Iterator[float]:
        """Frequencies of ends that are to be bracketed: where one is far off, those that may be the worst alone."""
        ends = [
            (abs(each.error), each.open, [(each.open, each.ours.frequency, each.reference.frequency)])
            for each in self.end_errors
        ]
        groups = [(self._united(each), [(one.open, one.low, one.high) for one in each]) for each in self.different()]
        kinds = [(one.width, one.open, parts) for one, parts in groups if one.width + one.open > self.narrowest]
        far = any(size - open_ > FAR * self.narrowest for size, open_, _ in (*ends, *kinds))
        for several in (ends, kinds):
            least = max((size for size, *_ in several), default=0.0) if far else 0.0
            for size, open_, parts in several:
                if size + open_ >= least and any(each > tolerance for each, *_ in parts):
                    yield from (at for _, *both in parts for at in both)

    def kind_differences(self) -> list[KindDifference]:
        """Differences in kind wider than the narrowest branch, each named by the widest of its parts."""
        found = [self._united(each) for each in self.different()]
        return [each for each in found if each.alone or each.width + each.open > self.narrowest]

    def different(self) -> list[list[KindDifference]]:
        """Ranges of different kinds that no matched end accounts for, each as its parts with two kinds."""
        found: list[list[KindDifference]] = []
        spans = [sorted((one.frequency, other.frequency)) for one, other in self.matched]
        for each in self.pairs:
            kinds, middle = (each.ours.kind, each.reference.kind), 0.5 * (each.low + each.high)
            moved = any(low <= middle <= high for low, high in spans)
            if kinds[0] == kinds[1] or moved or UNKNOWN in (kinds[0].periods, kinds[1].periods):
                continue
            if not found or found[-1][-1].high != each.low:
                found.append([])
            open_ = self.opens[each.low] + self.opens[each.high]
            found[-1].append(KindDifference(each.low, each.high, open_ / middle, self.way, *kinds, self.alone))
        return found

    def _united(self, parts: Sequence[KindDifference]) -> KindDifference:
        """Neighbouring differences as one."""
        low, high, widest = parts[0].low, parts[-1].high, max(parts, key=lambda each: each.width)
        return replace(widest, low=low, high=high, open=(self.opens[low] + self.opens[high]) / (0.5 * (low + high)))

    def unknown(self) -> Iterator[tuple[str, float, float]]:
        """Ranges in which the motion of one of the two is not known."""
        for each in self.pairs:
            if UNKNOWN in (each.ours.kind.periods, each.reference.kind.periods):
                yield self.way, each.low, each.high

    def amplitudes(self, least: float) -> Iterator[AmplitudeError]:
        """Errors of the amplitude at the places that both have, and at the ends of their common ranges."""
        alike = [each for each in self.pairs if each.ours.kind == each.reference.kind and self._is_branch(each)]
        for each in alike:
            if each.ours.kind.repeats:
                yield from self._of_motion(each, least)
        yield from self._of_means([each for each in alike if each.ours.kind.periods == IRREGULAR], least)

    def _is_branch(self, pair: _Pair) -> bool:
        """Test whether a range is of branches that are told apart, not of narrow ones among others."""
        found = [each.at(0.5 * (pair.low + pair.high)) for each in self._wide_at]
        return all(each is not None and each.kind == pair.ours.kind for each in found)

    def _of_motion(self, pair: _Pair, least: float) -> Iterator[AmplitudeError]:
        ours, theirs = (_inside(each, pair) for each in (pair.ours, pair.reference))
        for frequency in sorted({*ours} & {*theirs}):
            yield self._error(frequency, ours[frequency], theirs[frequency], least)
        for frequency in _outermost(ours, theirs):
            places = [_reached(one, frequency, response.simulator)
                      for one, response in zip((pair.ours, pair.reference), self.both, strict=True)]  # fmt: skip
            if places[0] is not None and places[1] is not None and places[0].kind == places[1].kind:
                yield self._error(frequency, places[0], places[1], least)

    def _error(self, frequency: float, ours: SweptPlace, theirs: SweptPlace, least: float) -> AmplitudeError:
        size = max(abs(theirs.amplitude), least)
        error = (ours.amplitude - theirs.amplitude) / size if size > 0 else 0.0
        return AmplitudeError(error, frequency, self.way, ours.amplitude, theirs.amplitude)

    def _of_means(self, pairs: Sequence[_Pair], least: float) -> Iterator[AmplitudeError]:
        """Errors of means over neighbouring places of motions that do not repeat."""
        ours = {at: place for each in pairs for at, place in _inside(each.ours, each).items()}
        theirs = {at: place for each in pairs for at, place in _inside(each.reference, each).items()}
        shared = sorted({*ours} & {*theirs})
        for group in np.array_split(np.array(shared), max(1, len(shared) // GROUP)) if shared else []:
            pairs_ = [(ours[at], theirs[at]) for at in group.tolist()]
            error = self._mean_error(pairs_, least, 1)
            if error.scatter > SCATTER and None not in (self.both[0].simulator, self.both[1].simulator):
                error = self._mean_error(pairs_, least, READINGS)
            yield error

    def _mean_error(
        self, places: Sequence[tuple[SweptPlace, SweptPlace]], least: float, readings: int
    ) -> AmplitudeError:
        """Error of the mean amplitude over places, each read so many times."""
        sides = zip(zip(*places, strict=True), self.both, strict=True)
        mine, other = (np.array([_readings(each, side.simulator, readings) for each in own]) for own, side in sides)
        mean, at = float(np.nanmean(other)), places[len(places) // 2][0].frequency
        size = max(mean, least)
        off = (np.nanmean(mine, axis=1) - np.nanmean(other, axis=1)) / size
        scatter = float(off.std(ddof=1) / np.sqrt(len(off))) if len(off) > 1 else _scatter(mine - other) / size
        return AmplitudeError(float(off.mean()), at, self.way, float(np.nanmean(mine)), mean, scatter)


def _scatter(values: Array) -> float:
    """Standard error of the mean of readings at one place; ∞ of a single one."""
    known = values[np.isfinite(values)]
    return float(known.std(ddof=1) / np.sqrt(known.size)) if known.size > 1 else float("inf")


def _readings(place: SweptPlace, simulator: Simulator | None, count: int) -> list[float]:
    """Amplitudes of a motion that does not repeat, read so many times; NaN where it cannot go on."""
    found = [place.amplitude]
    while len(found) < count and simulator is not None and not simulator.done and place.state() is not None:
        place = simulated(simulator, place.frequency, place, settle=False)
        found.append(place.amplitude)
    return found + [float("nan")] * (count - len(found))


def _end_error(ours: SweptEnd, reference: SweptEnd) -> EndError:
    at = reference.frequency
    return EndError(ours.frequency / at - 1, (ours.open + reference.open) / at, ours, reference)


def _pairs(ours: Sequence[SweptBranch], theirs: Sequence[SweptBranch]) -> Iterator[_Pair]:
    """Ranges over which neither response changes its branch, from low to high."""
    cuts = sorted({each for several in (ours, theirs) for one in several for each in (one.start, one.end)})
    mine, other = _Branches(ours), _Branches(theirs)
    for low, high in pairwise(cuts if len(cuts) > 1 else cuts * 2):  # a sweep may have one frequency
        found = mine.at(0.5 * (low + high)), other.at(0.5 * (low + high))
        if found[0] is not None and found[1] is not None:
            yield _Pair(low, high, found[0], found[1])


class _Branches:
    """Branches of one response in one direction, by frequency."""

    def __init__(self, found: Sequence[SweptBranch]) -> None:
        self._found = sorted(found, key=lambda each: min(each.start, each.end))
        self._lows = [min(each.start, each.end) for each in self._found]

    def at(self, frequency: float) -> SweptBranch | None:
        """Branch at a frequency."""
        found = self._found[max(bisect_right(self._lows, frequency) - 1, 0)]
        return found if self._lows[0] <= frequency <= max(found.start, found.end) else None


def _outermost(ours: Mapping[float, SweptPlace], theirs: Mapping[float, SweptPlace]) -> list[float]:
    """Frequencies next to the ends of a common range at which only one has a place."""
    every = sorted({*ours, *theirs})
    return sorted({*every[:1], *every[-1:]} - ({*ours} & {*theirs}))


def _inside(stretch: SweptBranch, pair: _Pair) -> dict[float, SweptPlace]:
    """Places of a branch in a range, by frequency."""
    return {each.frequency: each for each in stretch.places if pair.low <= each.frequency <= pair.high}


def _reached(stretch: SweptBranch, frequency: float, simulator: Simulator | None) -> SweptPlace | None:
    """Place of a branch at a frequency, from the nearest one of its places; None where it cannot be had."""
    nearest = min(stretch.places, key=lambda each: abs(each.frequency - frequency))
    if nearest.frequency == frequency:
        return nearest
    if simulator is None or simulator.done or nearest.state() is None:
        return None
    return simulated(simulator, frequency, nearest)
