"""Choice along a range of frequencies without a stable known motion: flight, and statistics where it is aperiodic.

One reading of an aperiodic motion's amplitude is one sample: claims are made for its mean, with the scatter of single
readings about it. The stretch is flown once, for both directions, with the sweep's own settling: with less, more
periodic motions in narrow windows and after long transients are missed. A cheaper model is taken where the mean of its
readings at some of the frequencies agrees with the finest model's within the accuracy at three standard errors, and
each single reading does where the finest model is periodic.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vibeam.case.plans import SweepPlan
from vibeam.runs.accuracy.candidates import Candidate, Evaluation, distance, put, rows, values
from vibeam.runs.accuracy.choice import SPARE, BranchChoice
from vibeam.runs.accuracy.finest import note_flight
from vibeam.system.response import FrequencyResponse
from vibeam.system.state import State
from vibeam_models.arrays import Array, Index

FIRST = 12  # frequencies that determine the scatter
ASKED = 12  # frequencies at which cheaper models are compared with the finest
FEWEST = 48  # smallest number of frequencies for which that can pay
SURE = 3.0  # standard errors of a claim


@dataclass(frozen=True)
class Unsettled:
    """Flight candidates, from the cheapest to the finest model, with ``numbers`` in the study's list."""

    candidates: Sequence[Candidate]
    numbers: Sequence[int]
    quantities: tuple[str, ...]
    within: float
    plan: SweepPlan
    flown: dict[int, tuple[FrequencyResponse, dict[int, State]]] = field(
        default_factory=dict
    )  # by candidate: points, states

    def settle(self, branch: BranchChoice, places: Index, state: State | None) -> State | None:
        """Fill the places of the branch; return the finest model's state after the last one."""
        first = places[:FIRST]
        state = self._finest(branch, first, state)
        if len(places) < FEWEST or len(self.candidates) < 2 or not self._mean_resolvable(branch, first):
            state = self._finest(branch, places[FIRST:], state)
        else:
            probes = places[np.unique(np.linspace(FIRST, len(places) - 1, ASKED).astype(int))]
            state = self._finest(branch, probes, state)
            left = places[branch.candidate[places] < 0]
            if not self._cheaper(branch, probes, left):
                self._between(branch, left)
        self._scatter(branch, places)
        return state

    def remember(self, branch: BranchChoice) -> None:
        """Keep the finest model's aperiodic points for the other direction."""
        kept, after = self._kept(len(self.candidates) - 1)
        alone = [place for place in branch.states if branch.kind[place] < 0 and int(branch.grid[place]) not in after]
        put(kept, branch.grid[alone], rows(branch.response, np.array(alone, dtype=int)))
        after.update((int(branch.grid[place]), branch.states[place]) for place in alone)

    def _kept(self, index: int) -> tuple[FrequencyResponse, dict[int, State]]:
        """Points of a candidate flown so far: readings at all points, states after those known."""
        if index not in self.flown:
            known = self.candidates[index].known
            self.flown[index] = FrequencyResponse.empty(known.omega / (2 * np.pi), known.system.size), {}
        return self.flown[index]

    def _mean_resolvable(self, branch: BranchChoice, first: Index) -> bool:
        """Test whether so few readings can determine a mean to the accuracy; otherwise none is made."""
        aperiodic = first[branch.statistical[first]]
        if len(aperiodic) < FIRST // 2:
            return True
        scatter = _scatter(values(rows(branch.response, aperiodic), self.quantities))
        return bool(SURE * scatter / np.sqrt(ASKED) < self.within)

    def _finest(self, branch: BranchChoice, places: Index, state: State | None) -> State | None:
        """Finest model at the places in order; its last state."""
        if not len(places):
            return state
        response, states = self._fly(len(self.candidates) - 1, branch.grid[places], state)
        note_flight(branch, places, self.numbers[-1], response, states)
        return states[-1]

    def _between(self, branch: BranchChoice, left: Index) -> None:
        """Finest model at places between those flown, each from the one before."""
        for place in left:
            self._finest(branch, np.array([place]), branch.states.get(int(place) - 1))

    def _cheaper(self, branch: BranchChoice, probes: Index, left: Index) -> bool:
        """Test whether a cheaper model is accurate enough for the rest, and use it."""
        truth = rows(branch.response, probes)
        for index, number in enumerate(self.numbers[:-1]):
            if self._ruled_out(branch, index, probes[: len(probes) // 3]):
                continue
            found, _ = self._fly(index, branch.grid[probes])
            bound = _bound(found, truth, branch.statistical[probes], self.quantities)
            if bound <= SPARE * self.within:
                whole, _ = self._fly(index, branch.grid[left])
                branch.enter(left, Evaluation(whole, np.full(len(left), bound)), number)
                branch.statistical[left] = True
                return True
        return False

    def _ruled_out(self, branch: BranchChoice, index: int, probes: Index) -> bool:
        """Test whether a few frequencies already rule a model out."""
        found, _ = self._fly(index, branch.grid[probes])
        error, aperiodic = distance(found, rows(branch.response, probes), self.quantities), branch.statistical[probes]
        mean = np.abs(error[aperiodic].mean(axis=0)) if aperiodic.any() else np.zeros(1)
        margin = (
            SURE * error[aperiodic].std(axis=0, ddof=1) / np.sqrt(np.count_nonzero(aperiodic))
            if aperiodic.sum() > 1
            else np.inf
        )
        return bool(np.any(np.abs(error[~aperiodic]) > self.within) or np.any(mean - margin > self.within))

    def _fly(self, index: int, points: Index, state: State | None = None) -> tuple[FrequencyResponse, list[State]]:
        """Points in order by flight, or as found there before; and the states after each."""
        kept, after = self._kept(index)
        for some in np.split(points, np.flatnonzero(np.diff([int(point) in after for point in points])) + 1):
            if int(some[0]) not in after:
                response, states = self.candidates[index].fly(some, state, self.plan.settle, self.plan.hold)
                put(kept, some, response)
                after.update(zip(some.tolist(), states, strict=True))
            state = after[int(some[-1])]
        return rows(kept, points), [after[int(point)] for point in points]

    def _scatter(self, branch: BranchChoice, places: Index) -> None:
        """Scatter of single aperiodic readings about the mean of their neighbours."""
        aperiodic = places[branch.statistical[places]]
        amplitude = branch.response.amplitude[aperiodic]
        if len(aperiodic) >= 3:
            deviation = amplitude[1:-1] / ((amplitude[:-2] + amplitude[2:]) / 2) - 1
            branch.scatter[aperiodic] = np.sqrt(np.mean(deviation**2) / 1.5)


def _scatter(readings: Array) -> float:
    """Relative scatter of readings (frequencies, quantities) about a linear trend, of the worst quantity."""
    place = np.arange(len(readings))
    trend = np.stack([np.polyval(np.polyfit(place, column, 1), place) for column in readings.T], axis=1)
    return float(
        np.max(np.sqrt(np.sum((readings - trend) ** 2, axis=0) / (len(place) - 2)) / abs(readings.mean(axis=0)))
    )


def _bound(
    found: FrequencyResponse, truth: FrequencyResponse, aperiodic: NDArray[np.bool_], quantities: Sequence[str]
) -> float:
    """Largest error where the finest model is periodic; of the mean, with three standard errors, where it is not."""
    error = distance(found, truth, quantities)
    worst = float(np.max(np.abs(error[~aperiodic]), initial=0.0))
    count = int(np.count_nonzero(aperiodic))
    if not count:
        return worst
    margin = SURE * np.std(error[aperiodic], axis=0, ddof=1) / np.sqrt(count) if count > 1 else np.inf
    return max(worst, float(np.max(np.abs(np.mean(error[aperiodic], axis=0)) + margin)))
