"""Result of a batch: arrays over its points, filled in point by point by any thread."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.system.impact_system import ImpactSystem
from vibeam.system.labelled import LabelledData, LabelledPart
from vibeam.system.quantities import Ended
from vibeam.system.response import FrequencyResponse
from vibeam.system.state import State
from vibeam_models.arguments import counted
from vibeam_models.arrays import Array, Flags, Index, ValueRecord


@dataclass(frozen=True, eq=False, repr=False)
class BatchResponse(ValueRecord, LabelledData):
    """Steady points of ``vibeam.batch``, each array of the batch's shape, and one axis more where it says so.

    SI units; every quantity is that of ``FrequencyResponse``. A failed point is NaN, its reason in ``ended``, its
    ``state`` the equilibrium from which a sweep goes on.

    >>> import vibeam
    >>> system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, gap=9.0)
    >>> vibeam.batch(system, omega=[0.5, 0.6], amplitude=0.1, settle=5, hold=2)
    BatchResponse(2 points (2,), 1 mode)
    """

    amplitude: Array  #: ½(max − min) of the output over the hold
    reach: Array  #: gap − min of the contact displacement, m
    maximum: Array  #: max of the output
    minimum: Array  #: min of the output
    impacts_per_period: Array  #: impacts a drive period, over the hold
    impact_velocity: Array  #: mean contact velocity just before impact, m/s (NaN where there is none)
    period: Index  #: drive periods after which the motion repeats (1…16), 0 none, −1 no contact
    rest: Array  #: share of the time at rest on the stop, 0…1
    mode_energy: Array  #: (…, n) time-mean energy of each mode over the hold, J
    ended: Index  #: code of ``Ended``
    impacts: Index  #: impacts computed, settling included
    cpu_seconds: Array = field(compare=False)  #: CPU time of the point, s
    state: Array  #: (…, 2n) modal displacements, then velocities, at the end of the hold
    resting: Flags  #: whether that state is in lasting contact with the stop
    strobes: Array  #: (…, k) the output at the end of the last k periods held, the latest last
    lyapunov: Array  #: largest Lyapunov exponent, 1/s, −∞ where every direction is lost (NaN where not asked for)
    lyapunov_error: Array  #: its standard error, 0 where the motion repeats

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the batch."""
        return self.ended.shape

    def _parts(self) -> list[LabelledPart]:
        grid = self.shape or (1,)
        axes = {f"axis_{number}": range(size) for number, size in enumerate(grid, 1)}
        whole = {each.name: getattr(self, each.name) for each in fields(self)}
        values = {name: each.reshape((*grid, *each.shape[len(self.shape) :])) for name, each in whole.items()}
        return [LabelledPart({}, axes, values)]

    def __repr__(self) -> str:
        failed = int(np.count_nonzero(self.ended != Ended.COMPLETE.code))
        size, modes = counted(self.ended.size, "point"), counted(self.mode_energy.shape[-1], "mode")
        return f"BatchResponse({size} {self.shape}, {modes}{f', {failed} not complete' if failed else ''})"


READ = (
    "amplitude", "reach", "maximum", "minimum", "impacts_per_period", "impact_velocity", "period", "rest",
    "mode_energy", "ended", "impacts", "cpu_seconds",
)  # fmt: skip

WHOLE = ("period", "ended", "impacts")


@dataclass(frozen=True)
class BatchPlan:
    """Course of every point of a batch: settling, hold, and what is read off."""

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


class BatchRecord:
    """Results of m points, under way."""

    def __init__(self, points: int, modes: int, strobes: int) -> None:
        self.values: dict[str, NDArray[Any]] = {
            name: np.zeros(points, dtype=np.int64) if name in WHOLE else np.full(points, np.nan) for name in READ
        }
        self.values["mode_energy"] = np.full((points, modes), np.nan)
        self.values["ended"][:] = Ended.NOT_RUN.code
        self.state, self.resting = np.zeros((points, 2 * modes)), np.zeros(points, dtype=bool)
        self.strobes = np.full((points, strobes), np.nan)
        self.exponents = np.full((2, points), np.nan)  # largest Lyapunov exponents and their standard errors

    def fill(
        self, which: Index, response: FrequencyResponse, states: Array, resting: Flags,
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
        every["lyapunov"], every["lyapunov_error"] = self.exponents
        return BatchResponse(**{name: values.reshape((*shape, *values.shape[1:])) for name, values in every.items()})
