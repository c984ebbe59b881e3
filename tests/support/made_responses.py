"""Responses of models whose branches are known by formulas: what a comparison must find in them, on any grid."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from stand_in import curve

from vibeam.runs.comparison.places import simulated
from vibeam.runs.comparison.responses import Response
from vibeam.system.response import FrequencyResponse
from vibeam.system.state import State


@dataclass(frozen=True)
class MadeBranch:
    """Branch up to ``end`` in Hz: ``period``, ``impacts`` in it, its amplitude over the frequency."""

    end: float
    period: int
    impacts: int
    amplitude: Callable[[float], float]


@dataclass
class MadeSimulator:
    """Steady points of a model with known branches, which a step of more than ``careful`` Hz throws off.

    Over the last ``early`` Hz of a branch, without it the last ``careful`` ones.
    The state has the frequency, and the number of the branch.
    """

    branches: tuple[MadeBranch, ...]
    careful: float = np.inf
    early: float | None = None
    done: bool = False
    count: int = 0

    def at(self, frequency: float, state: State | None, settle: bool = True) -> tuple[FrequencyResponse, State]:
        """The point at a frequency."""
        self.count += 1
        which = next(i for i, each in enumerate(self.branches) if frequency <= each.end)
        if state is not None:
            before, last = int(state.velocity[0]), float(state.displacement[0])
            early = self.careful if self.early is None else self.early
            thrown = abs(frequency - last) > self.careful and frequency > self.branches[before].end - early
            which = max(which, before + 1) if thrown and before + 1 < len(self.branches) else max(which, before)
        own = self.branches[which]
        periods = own.period if own.period else 0
        found = curve([frequency], own.amplitude(frequency), periods)
        found.impacts_per_period[:] = own.impacts / max(own.period, 1) if own.period >= 0 else 0.0
        return found, State([frequency], [float(which)])


def made(
    branches: tuple[MadeBranch, ...], grid: np.ndarray, careful: float = np.inf, early: float | None = None
) -> Response:  # fmt: skip
    """Response of a model swept up over a grid."""
    simulator, places = MadeSimulator(branches, careful, early), []
    for frequency in np.sort(grid).tolist():
        places.append(simulated(simulator, frequency, places[-1] if places else None))
    return Response({"up": places}, simulator)


def amplitudes(size: float, slope: float = 0.0) -> Callable[[float], float]:
    """Amplitude that changes linearly from 100 Hz on."""
    return lambda frequency: size * (1 + slope * (frequency - 100.0))
