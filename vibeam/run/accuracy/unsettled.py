"""A stretch of frequencies without any stable known motion: flight, and claims by statistics where nothing repeats.

The amplitude of a motion that does not repeat, read over so many periods, is one draw of many: what can be claimed of
it is its mean, and how far single readings scatter about that. The stretch is flown once, for both ways, with the
sweep's own settling: with less, more of the motions are missed that do repeat, in narrow windows and after a long
transient. A cheaper model is taken where the mean of its readings over some of the frequencies is as near to the finest
one's as asked, beyond doubt (three standard errors), and each of its readings is where the finest model repeats.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vibeam.case.plans import SweepPlan
from vibeam.run.accuracy.candidates import Candidate, Read, put, rows
from vibeam.run.accuracy.choice import SPARE
from vibeam.run.accuracy.choices import BranchChoice
from vibeam.run.accuracy.closed_forms import Index
from vibeam.run.accuracy.finest import note_flight
from vibeam.run.accuracy.readings import distance, values
from vibeam.system.response import FrequencyResponse
from vibeam.system.state import State

Array = NDArray[np.float64]

FIRST = 12  # frequencies that tell the scatter

ASKED = 12  # frequencies at which cheaper models are compared with the finest

FEWEST = 48  # frequencies from which on that can be worth it

SURE = 3.0  # standard errors


@dataclass(frozen=True)
class Unsettled:
    """``rungs``: flight of each model, from the cheapest to the finest, with ``numbers`` in the study's list."""

    rungs: Sequence[Candidate]
    numbers: Sequence[int]
    quantities: tuple[str, ...]
    within: float
    plan: SweepPlan
    flown: dict[int, tuple[FrequencyResponse, dict[int, State]]] = field(
        default_factory=dict
    )  # by rung: points, states

    def settle(self, sheet: BranchChoice, places: Index, state: State | None) -> State | None:
        """Fill the places of ``sheet``; the finest model's state after the last one."""
        first = places[:FIRST]
        state = self._finest(sheet, first, state)
        if len(places) < FEWEST or len(self.rungs) < 2 or not self._can_tell(sheet, first):
            state = self._finest(sheet, places[FIRST:], state)
        else:
            probes = places[np.unique(np.linspace(FIRST, len(places) - 1, ASKED).astype(int))]
            state = self._finest(sheet, probes, state)
            left = places[sheet.rung[places] < 0]
            if not self._cheaper(sheet, probes, left):
                self._between(sheet, left)
        self._scatter(sheet, places)
        return state

    def remember(self, sheet: BranchChoice) -> None:
        """Take over what the finest model was flown at place by place, on no known motion: it serves both ways."""
        kept, after = self._kept(len(self.rungs) - 1)
        alone = [place for place in sheet.states if sheet.kind[place] < 0 and int(sheet.grid[place]) not in after]
        put(kept, sheet.grid[alone], rows(sheet.response, np.array(alone, dtype=int)))
        after.update((int(sheet.grid[place]), sheet.states[place]) for place in alone)

    def _kept(self, rung: int) -> tuple[FrequencyResponse, dict[int, State]]:
        """What a rung was flown at so far: readings at all points, states after those there are."""
        if rung not in self.flown:
            known = self.rungs[rung].known
            self.flown[rung] = FrequencyResponse.empty(known.omega / (2 * np.pi), known.system.size), {}
        return self.flown[rung]

    def _can_tell(self, sheet: BranchChoice, first: Index) -> bool:
        """Whether a mean can be told closely enough by those to be asked, as these scatter: else none need be asked."""
        loose = first[sheet.statistical[first]]
        if len(loose) < FIRST // 2:
            return True
        scatter = _scatter(values(rows(sheet.response, loose), self.quantities))
        return bool(SURE * scatter / np.sqrt(ASKED) < self.within)

    def _finest(self, sheet: BranchChoice, places: Index, state: State | None) -> State | None:
        """The finest model at the places in turn; its last state."""
        if not len(places):
            return state
        response, states = self._through(len(self.rungs) - 1, sheet.grid[places], state)
        note_flight(sheet, places, self.numbers[-1], response, states)
        return states[-1]

    def _between(self, sheet: BranchChoice, left: Index) -> None:
        """The finest model at places between those where it was flown, each from the one before."""
        for place in left:
            self._finest(sheet, np.array([place]), sheet.states.get(int(place) - 1))

    def _cheaper(self, sheet: BranchChoice, probes: Index, left: Index) -> bool:
        """Whether a cheaper model was good enough for what is left, and was taken."""
        truth = rows(sheet.response, probes)
        for rung, number in enumerate(self.numbers[:-1]):
            if self._hopeless(sheet, rung, probes[: len(probes) // 3]):
                continue
            found, _ = self._through(rung, sheet.grid[probes])
            bound = _bound(found, truth, sheet.statistical[probes], self.quantities)
            if bound <= SPARE * self.within:
                whole, _ = self._through(rung, sheet.grid[left])
                sheet.enter(left, Read(whole, np.full(len(left), bound)), number)
                sheet.statistical[left] = True
                return True
        return False

    def _hopeless(self, sheet: BranchChoice, rung: int, probes: Index) -> bool:
        """Whether a few frequencies show already that a model is too far off."""
        found, _ = self._through(rung, sheet.grid[probes])
        error, loose = distance(found, rows(sheet.response, probes), self.quantities), sheet.statistical[probes]
        mean = np.abs(error[loose].mean(axis=0)) if loose.any() else np.zeros(1)
        sure = SURE * error[loose].std(axis=0, ddof=1) / np.sqrt(np.count_nonzero(loose)) if loose.sum() > 1 else np.inf
        return bool(np.any(np.abs(error[~loose]) > self.within) or np.any(mean - sure > self.within))

    def _through(self, rung: int, points: Index, state: State | None = None) -> tuple[FrequencyResponse, list[State]]:
        """Points in turn by flight, or what was found there before; and the states after each."""
        kept, after = self._kept(rung)
        for some in np.split(points, np.flatnonzero(np.diff([int(point) in after for point in points])) + 1):
            if int(some[0]) not in after:
                response, states = self.rungs[rung].fly(some, state, self.plan.settle, self.plan.hold)
                put(kept, some, response)
                after.update(zip(some.tolist(), states, strict=True))
            state = after[int(some[-1])]
        return rows(kept, points), [after[int(point)] for point in points]

    def _scatter(self, sheet: BranchChoice, places: Index) -> None:
        """How far single readings scatter: about the mean of their neighbours, of all that do not repeat."""
        loose = places[sheet.statistical[places]]
        amplitude = sheet.response.amplitude[loose]
        if len(loose) >= 3:
            off = amplitude[1:-1] / ((amplitude[:-2] + amplitude[2:]) / 2) - 1
            sheet.scatter[loose] = np.sqrt(np.mean(off**2) / 1.5)


def _scatter(readings: Array) -> float:
    """Relative scatter of readings (frequencies, quantities) about a straight trend, of the worst quantity."""
    place = np.arange(len(readings))
    trend = np.stack([np.polyval(np.polyfit(place, column, 1), place) for column in readings.T], axis=1)
    return float(
        np.max(np.sqrt(np.sum((readings - trend) ** 2, axis=0) / (len(place) - 2)) / abs(readings.mean(axis=0)))
    )


def _bound(
    found: FrequencyResponse, truth: FrequencyResponse, loose: NDArray[np.bool_], quantities: Sequence[str]
) -> float:
    """The largest error where the truth repeats; of the mean, with three standard errors, where it does not."""
    error = distance(found, truth, quantities)
    worst = float(np.max(np.abs(error[~loose]), initial=0.0))
    count = int(np.count_nonzero(loose))
    if not count:
        return worst
    sure = SURE * np.std(error[loose], axis=0, ddof=1) / np.sqrt(count) if count > 1 else np.inf
    return max(worst, float(np.max(np.abs(np.mean(error[loose], axis=0)) + sure)))
