"""Arrays of a batch that is under way, filled point by point by any thread."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.batch.response import BatchResponse
from vibeam.system.ended import Ended
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import FrequencyResponse
from vibeam.system.state import State

Array = NDArray[np.float64]

READ = (
    "amplitude", "reach", "maximum", "minimum", "impacts_per_period", "impact_velocity", "period", "rest",
    "mode_energy", "ended", "impacts", "cpu_seconds",
)  # fmt: skip

WHOLE = ("period", "ended", "impacts")


@dataclass(frozen=True)
class Plan:
    """What every point of a batch goes through."""

    settle: int  # drive periods
    hold: int
    output: str
    lanes: bool  # whether points go side by side
    strobes: int  # how many values of the output at the end of a period are kept
    lyapunov: int  # drive periods of the mean of the largest Lyapunov exponent, 0: it is not asked for

    def strobed(self, system: ImpactSystem, states: Array) -> Array:
        """The output at the last states (hold + 1, 2, n) of a hold."""
        derivative = system.derivative(self.output)
        return np.asarray(
            states[len(states) - self.strobes :, 0 if derivative is None else 1] @ system.row(self.output)
        )


class Record:
    """What each of m points came to."""

    def __init__(self, points: int, modes: int, strobes: int) -> None:
        self.values: dict[str, NDArray[Any]] = {
            name: np.zeros(points, dtype=np.int64) if name in WHOLE else np.full(points, np.nan) for name in READ
        }
        self.values["mode_energy"] = np.full((points, modes), np.nan)
        self.values["ended"][:] = Ended.NOT_RUN.code
        self.state, self.resting = np.zeros((points, 2 * modes)), np.zeros(points, dtype=bool)
        self.strobes = np.full((points, strobes), np.nan)
        self.lyapunov = np.full(points, np.nan)

    def fill(
        self, which: NDArray[np.int64], response: FrequencyResponse, states: Array, resting: NDArray[np.bool_],
        strobes: Array,
    ) -> None:  # fmt: skip
        """Keep the points ``which``, the states (m, 2, n) after them and the output at the ends of their periods."""
        for name in READ:
            self.values[name][which] = getattr(response, name)
        self.state[which], self.resting[which] = states.reshape(len(which), -1), resting
        done = response.ended == Ended.COMPLETE.code
        self.strobes[which[done]] = strobes[done]

    def note(self, point: int, response: FrequencyResponse, after: State, strobes: Array) -> None:
        """Keep a sweep of one frequency, the state after it and the output at the ends of its periods."""
        states = np.stack([after.displacement, after.velocity])[None]
        kept = np.full((1, self.strobes.shape[1]), np.nan)
        if response.ended[0] == Ended.COMPLETE.code:
            kept[0] = strobes
        self.fill(np.array([point]), response, states, np.array([after.resting]), kept)

    def response(self, shape: tuple[int, ...]) -> BatchResponse:
        """The batch in its shape."""
        every = self.values | {"state": self.state, "resting": self.resting, "strobes": self.strobes}
        every["lyapunov"] = self.lyapunov
        return BatchResponse(**{name: values.reshape((*shape, *values.shape[1:])) for name, values in every.items()})
