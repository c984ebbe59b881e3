"""A stretch of frequencies without any stable known motion: flight, and claims by statistics where nothing repeats.

The amplitude of a motion that does not repeat, read over so many periods, is one draw of many: what can be claimed of
it is its mean, and how far single readings scatter about that. The stretch is flown with a shorter settling than the
sweep's, for the state that comes from the frequency before is on the motion already. A cheaper model is taken where the
mean of its readings over some of the frequencies is as near to the finest one's as asked, beyond doubt (two standard
errors), and each of its readings is where the finest model repeats.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vibeam.accuracy.known import Index
from vibeam.accuracy.ladder import SPARE
from vibeam.accuracy.readings import apart, values
from vibeam.accuracy.rungs import Read, Rung, rows
from vibeam.accuracy.sheet import Sheet
from vibeam.accuracy.track import note_flight
from vibeam.case import SweepPlan
from vibeam.response import FrequencyResponse
from vibeam.state import State
from vibeam.sweep import join

Array = NDArray[np.float64]
ASKED = 12  # frequencies at which cheaper models are compared with the finest
FEWEST = 24  # frequencies from which on that can be worth it
SURE = 2.0  # standard errors


@dataclass(frozen=True)
class Unsettled:
    """``rungs``: flight of each model, from the cheapest to the finest, with ``numbers`` in the study's list."""

    rungs: Sequence[Rung]
    numbers: Sequence[int]
    quantities: tuple[str, ...]
    within: float
    plan: SweepPlan
    flown: dict[tuple[int, int], tuple[FrequencyResponse, State]] = field(default_factory=dict)  # by rung and point

    def settle(self, sheet: Sheet, places: Index, state: State | None) -> State | None:
        """Fill the places of ``sheet``; the finest model's state after the last one."""
        probes = self._probes(places)
        state = self._finest(sheet, probes, state)
        left = places[sheet.rung[places] < 0]
        if len(left):
            self._cheaper(sheet, probes, left) or self._between(sheet, left)
        self._scatter(sheet, places)
        return sheet.states.get(int(places[-1]), state)

    def _probes(self, places: Index) -> Index:
        few = len(places) < FEWEST or len(self.rungs) < 2
        return places if few else places[np.unique(np.linspace(0, len(places) - 1, ASKED).astype(int))]

    def _finest(self, sheet: Sheet, places: Index, state: State | None) -> State | None:
        """The finest model at the places in turn; its last state."""
        for place in places:
            response, state = self._at(len(self.rungs) - 1, int(sheet.grid[place]), state)
            note_flight(sheet, int(place), self.numbers[-1], response, state)
        return state

    def _between(self, sheet: Sheet, left: Index) -> None:
        """The finest model at places between those where it was flown, each from the one before."""
        for place in left:
            self._finest(sheet, np.array([place]), sheet.states.get(int(place) - 1))

    def _cheaper(self, sheet: Sheet, probes: Index, left: Index) -> bool:
        """Whether a cheaper model was good enough for what is left, and was taken."""
        truth = rows(sheet.response, probes)
        if not _can_tell(truth, sheet.statistical[probes], self.quantities, self.within):
            return False
        for rung, number in enumerate(self.numbers[:-1]):
            found = self._through(rung, sheet.grid[probes])
            bound = _bound(found, truth, sheet.statistical[probes], self.quantities)
            if bound <= SPARE * self.within:
                whole = self._through(rung, sheet.grid[left])
                sheet.enter(left, Read(whole, np.full(len(left), bound)), number)
                sheet.statistical[left] = True
                return True
        return False

    def _at(self, rung: int, point: int, state: State | None) -> tuple[FrequencyResponse, State]:
        """One point by flight, or what was found there before."""
        if (rung, point) not in self.flown:
            self.flown[rung, point] = self.rungs[rung].fly(point, state, self.plan.settle, self.plan.hold)
        return self.flown[rung, point]

    def _through(self, rung: int, points: Index) -> FrequencyResponse:
        """Points in turn, from equilibrium."""
        found, state = [], None
        for point in points:
            response, state = self._at(rung, int(point), state)
            found.append(response)
        return join(found)

    def _scatter(self, sheet: Sheet, places: Index) -> None:
        """How far single readings scatter: about the mean of their neighbours, of all that do not repeat."""
        loose = places[sheet.statistical[places]]
        amplitude = sheet.response.amplitude[loose]
        if len(loose) >= 3:
            off = amplitude[1:-1] / ((amplitude[:-2] + amplitude[2:]) / 2) - 1
            sheet.scatter[loose] = np.sqrt(np.mean(off**2) / 1.5)


def _can_tell(truth: FrequencyResponse, loose: NDArray[np.bool_], quantities: Sequence[str], within: float) -> bool:
    """Whether so few readings can tell a mean that closely: else no cheaper model need be asked."""
    return bool(np.count_nonzero(loose) < 4 or _error_of_mean(values(truth, quantities)[loose]) < within)


def _error_of_mean(readings: Array) -> float:
    """Two standard errors of the mean of readings (frequencies, quantities) about their trend, relative; the worst."""
    place = np.arange(len(readings))
    trend = np.stack([np.polyval(np.polyfit(place, column, 1), place) for column in readings.T], axis=1)
    spread = np.std(readings - trend, axis=0, ddof=2) / np.abs(np.mean(readings, axis=0))
    return float(np.max(SURE * spread / np.sqrt(len(readings))))


def _bound(
    found: FrequencyResponse, truth: FrequencyResponse, loose: NDArray[np.bool_], quantities: Sequence[str]
) -> float:
    """The largest error where the truth repeats; of the mean, with two standard errors, where it does not."""
    error = apart(found, truth, quantities)
    worst = float(np.max(np.abs(error[~loose]), initial=0.0))
    count = int(np.count_nonzero(loose))
    if not count:
        return worst
    sure = SURE * np.std(error[loose], axis=0, ddof=1) / np.sqrt(count) if count > 1 else np.inf
    return max(worst, float(np.max(np.abs(np.mean(error[loose], axis=0)) + sure)))
