"""What has been found of one branch: values, which rung gave them, and by how much they may be off."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vibeam.run.accuracy.candidates import Read, put
from vibeam.run.accuracy.closed_forms import Index
from vibeam.system.response import FrequencyResponse
from vibeam.system.state import State

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class BranchChoice:
    """One direction, in the order swept; ``grid`` (points,): which point of the ascending frequencies each one is.

    ``rung`` (points,): by its place in the study's list, −1 where nothing is there yet. ``estimate``: relative error.
    ``statistical``: the motion does not repeat, so the estimate is that of its mean, and ``scatter`` that of one
    reading. ``kind``: the closed-form motion that the finest model is on, −1 where on none; ``states``: of the finest
    model after a point that it was flown at.
    """

    way: str
    grid: Index
    response: FrequencyResponse
    rung: Index
    estimate: Array
    statistical: NDArray[np.bool_]
    scatter: Array
    kind: Index
    states: dict[int, State]

    @classmethod
    def blank(cls, way: str, grid: Index, frequency: Array, modes: int) -> BranchChoice:
        """Nothing known yet."""
        n = len(grid)
        return cls(
            way, grid, FrequencyResponse.empty(frequency[grid], modes), np.full(n, -1), np.full(n, np.nan),
            np.zeros(n, dtype=bool), np.full(n, np.nan), np.full(n, -1), {},
        )  # fmt: skip

    def enter(self, at: Index, read: Read, rung: int) -> None:
        """Take over what was read at the places ``at``."""
        put(self.response, at, read.response)
        self.rung[at], self.estimate[at] = rung, read.off
