"""Choices along one branch: values, candidate and error bound of each point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vibeam.run.accuracy.candidates import Evaluation, put
from vibeam.run.accuracy.closed_forms import Index
from vibeam.system.response import FrequencyResponse
from vibeam.system.state import State

Array = NDArray[np.float64]


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
