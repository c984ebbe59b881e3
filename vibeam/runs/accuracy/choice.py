"""Choice along a range of frequencies with one known motion: the cheapest accurate candidate, stretch by stretch.

The finest model and the cheaper candidates are evaluated at five places. A candidate that is accurate at fewer than
two is dropped; where none is left the finest model is used throughout. Between two places a candidate's error is
interpolated linearly, and a third place in the middle measures the deviation: the claim for the stretch is the
largest error found plus that deviation. Its two halves are tested in the same way before it is accepted, because a
narrow resonance of a higher mode can hide between three places. A stretch that is undecided is halved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from vibeam.runs.accuracy.candidates import Candidate, Evaluation, distance, put, takes
from vibeam.system.response import FrequencyResponse
from vibeam.system.state import State
from vibeam_models.arrays import Array, Index


@dataclass(frozen=True, eq=False)
class BranchChoice:
    """One direction, in the order swept; ``grid`` (points,): index of each point in the ascending frequencies.

    ``candidate`` (points,): index in the study's list, −1 where there is none yet. ``estimate``: relative error.
    ``statistical``: the motion is aperiodic, so the estimate is that of its mean, and ``scatter`` that of one
    reading. ``kind``: the closed-form motion that the finest model is on, −1 where on none; ``states``: of the finest
    model after a point that it was flown at.
    """

    direction: str
    grid: Index
    response: FrequencyResponse
    candidate: Index
    estimate: Array
    statistical: NDArray[np.bool_]
    scatter: Array
    kind: Index
    states: dict[int, State]

    @classmethod
    def blank(cls, direction: str, grid: Index, frequency: Array, modes: int) -> BranchChoice:
        """Branch without any values yet."""
        n = len(grid)
        return cls(
            direction, grid, FrequencyResponse.empty(frequency[grid], modes), np.full(n, -1), np.full(n, np.nan),
            np.zeros(n, dtype=bool), np.full(n, np.nan), np.full(n, -1), {},
        )  # fmt: skip

    def enter(self, at: Index, evaluation: Evaluation, candidate: int) -> None:
        """Enter the values at the places ``at``."""
        put(self.response, at, evaluation.response)
        self.candidate[at], self.estimate[at] = candidate, evaluation.error


SAMPLE = 5  # points of the whole sweep that decide whether a candidate is evaluated at more
FAR = 5  # error of a candidate, as a multiple of the accuracy, beyond which coarser ones are not evaluated
STRETCHES = 8  # initial number of stretches
SHORTEST = 6  # steps of the sweep: a shorter stretch is left to the finest model
SPARE = 0.9  # share of the accuracy available to an estimate


@dataclass(frozen=True)
class Choice:
    """Candidates from the cheapest to the finest model in closed form, with their ``numbers`` in the study's list."""

    candidates: Sequence[Candidate]
    numbers: Sequence[int]
    quantities: tuple[str, ...]
    within: float

    def settle(self, branch: BranchChoice, places: Index, kind: int) -> int:
        """Fill the places and return how many: fewer than all where the finest model's motion ends."""
        promising = self._promising(branch, places, kind)
        if promising:
            places = places[: self._places_held(branch, places, kind)]
            stretches = _stretches(len(places)) if len(places) else []
            for number, candidate in promising:
                if stretches:
                    stretches = self._assigned(branch, places, kind, candidate, number, stretches)
        return self._finish(branch, places, kind) if len(places) else 0

    def _promising(self, branch: BranchChoice, places: Index, kind: int) -> list[tuple[int, Candidate]]:
        """Cheaper candidates, with their numbers, that are accurate at two of five places; one could be an accident.

        From the finest of them down: where one is off by many times the accuracy, coarser models are not evaluated.
        """
        step = max(len(branch.grid) // SAMPLE, 1)  # the same points in both directions
        sample = places[branch.grid[places] % step == step // 2]
        sample = sample if len(sample) else places[len(places) // 2 :][:1]
        exists = np.isfinite(self.candidates[-1].evaluate(branch.grid[sample], kind).error)
        found: list[tuple[int, Candidate]] = []
        for number, candidate in list(zip(self.numbers, self.candidates, strict=True))[-2::-1]:
            if not takes(candidate, kind):
                continue
            worst = np.abs(self._errors(branch, sample[exists], kind, candidate)).max(axis=1)
            if np.count_nonzero(worst <= self.within) >= len(worst) // 2:
                found.insert(0, (number, candidate))
            elif np.median(worst) > FAR * self.within:
                break
        return found

    def _places_held(self, branch: BranchChoice, places: Index, kind: int) -> int:
        """Number of places on which the finest model's motion persists, by bisection."""
        finest = self.candidates[-1]
        probes = _probes(_stretches(len(places)))
        fine = np.isfinite(finest.evaluate(branch.grid[places[probes]], kind).error)
        if fine.all():
            return len(places)
        bad = int(probes[np.argmin(fine)])
        good = int(max(probes[: np.argmin(fine)], default=-1))
        while bad - good > 1:
            middle = (good + bad) // 2
            if np.isfinite(finest.evaluate(branch.grid[places[[middle]]], kind).error[0]):
                good = middle
            else:
                bad = middle
        return bad

    def _assigned(self, branch: BranchChoice, places: Index, kind: int, candidate: Candidate, number: int,
                 stretches: list[tuple[int, int]]) -> list[tuple[int, int]]:  # fmt: skip
        """Stretches left after the candidate has taken those for which it is accurate enough."""
        left, open_ = [], stretches
        while open_:
            fits = self._verdicts(branch, places, kind, candidate, _fifths(open_)[:, ::2])
            closer = [i for i, (fine, _) in enumerate(fits) if fine is True]
            checked = (
                self._verdicts(branch, places, kind, candidate, _fifths([open_[i] for i in closer])) if closer else []
            )
            fits = [dict(zip(closer, checked, strict=True)).get(i, each) for i, each in enumerate(fits)]
            halves: list[tuple[int, int]] = []
            for (low, high), (fine, bound) in zip(open_, fits, strict=True):
                if fine is True and self._entered(branch, places[low + 1 : high], kind, candidate, number, bound):
                    continue
                if fine is None and high - low >= 3 * SHORTEST:
                    halves += [(low, (low + high) // 2), ((low + high) // 2, high)]
                else:
                    left.append((low, high))
            open_ = halves
        return left

    def _verdicts(
        self, branch: BranchChoice, places: Index, kind: int, candidate: Candidate, probes: Index
    ) -> list[tuple[bool | None, float]]:
        """Verdict on every stretch (rows of ``probes``, places within ``places``), and the claimed error."""
        asked, back = np.unique(probes, return_inverse=True)
        errors = self._errors(branch, places[asked], kind, candidate)[back.reshape(probes.shape)]
        return [_verdict(each, probes[i], self.within) for i, each in enumerate(errors)]

    def _errors(self, branch: BranchChoice, places: Index, kind: int, candidate: Candidate) -> Array:
        points = branch.grid[places]
        truth, found = self.candidates[-1].evaluate(points, kind), candidate.evaluate(points, kind)
        error = distance(found.response, truth.response, self.quantities)
        return np.where(np.isfinite(found.error)[:, None], error, np.inf)

    def _entered(
        self, branch: BranchChoice, places: Index, kind: int, candidate: Candidate, number: int, bound: float
    ) -> bool:
        """Enter the candidate's values, unless its motion is absent at one of the places."""
        evaluation = candidate.evaluate(branch.grid[places], kind)
        if not np.isfinite(evaluation.error).all():
            return False
        branch.enter(places, Evaluation(evaluation.response, np.full(len(places), bound)), number)
        return True

    def _finish(self, branch: BranchChoice, places: Index, kind: int) -> int:
        """Use the finest model wherever nothing cheaper was taken; return the number of places that hold."""
        finest, number = self.candidates[-1], self.numbers[-1]
        left = places[branch.candidate[places] < 0]
        evaluation = finest.evaluate(branch.grid[left], kind)
        branch.enter(left, evaluation, number)
        lost = left[~np.isfinite(evaluation.error)]
        if not len(lost):
            return len(places)
        branch.candidate[lost[0] :] = -1
        return int(np.searchsorted(places, lost[0]))


def _verdict(errors: Array, places: Index, within: float) -> tuple[bool | None, float]:
    """Verdict on a stretch from its errors (3 or 5 places, quantities): accurate or not, None: undecided; and a bound.

    Every second place is compared with the straight line between its neighbours.
    """
    known = np.isfinite(errors).all(axis=1)
    if not known.all():
        return (None if known.any() else False), np.inf
    share = (places[1::2] - places[:-2:2]) / np.maximum(places[2::2] - places[:-2:2], 1)
    straight = errors[:-2:2] + share[:, None] * (errors[2::2] - errors[:-2:2])
    bent = np.abs(errors[1::2] - straight).max(axis=0)
    bound = float(np.max(np.abs(errors).max(axis=0) + bent))
    if bound <= SPARE * within:
        return True, bound
    one_side = np.abs(np.sign(errors).sum(axis=0)) == len(errors)  # else it is near no place between
    beyond = one_side & (np.abs(errors).min(axis=0) - bent > within)
    return (False if beyond.any() else None), bound


def _stretches(count: int) -> list[tuple[int, int]]:
    """Ends of about equal stretches over ``count`` places."""
    ends = np.unique(np.linspace(0, count - 1, min(STRETCHES, max((count - 1) // SHORTEST, 1)) + 1).astype(int))
    return [(int(low), int(high)) for low, high in pairwise(ends)] or [(0, 0)]


def _fifths(stretches: Sequence[tuple[int, int]]) -> Index:
    """Five places of each (stretches, 5): ends, middle and between."""
    ends = np.array(stretches)
    return np.asarray((ends[:, :1] * np.arange(4, -1, -1) + ends[:, 1:] * np.arange(5)) // 4)


def _probes(stretches: Sequence[tuple[int, int]]) -> Index:
    """Ends and middles, ascending."""
    return np.unique(_fifths(stretches)[:, ::2])
