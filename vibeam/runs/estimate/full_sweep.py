"""Sweep of a full model beside the motions that are predicted of it: which of them it makes by itself.

Where several motions coexist the full model may make another one than the reduced model, though the same motion exists
in it, is stable and clear of the stop: only a sweep of the full model itself tells. It carries its state through all
frequencies and is left at each of them as soon as it is on a motion that was predicted, which takes a fraction of the
settling. Where none was, the state is carried on for the same fraction; from there a motion counts as the full model's
own where the sweep comes to it from several states of what was before, since which one it has is not known.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.solver import exact_solver
from vibeam.runs.estimate.records import QUANTITIES, Basis, ErrorEstimate
from vibeam.runs.estimate.work import CountedWork
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import FrequencyResponse, complete
from vibeam.system.state import State
from vibeam_models.arrays import Array

AGREES = 1e-3  # largest relative difference in amplitude and impact velocity between a flight and its motion
FIRST = 8  # the first look is after this part of the settling, each further one after as many periods again as before
LONGEST = 1000  # periods of settling at most
MOST = 300  # impacts a drive period, above which a flight is given up
STARTS = 8  # states of a motion that is not known, from which the next one that is known is to be reached
READ = 8  # repetitions of a motion over which it is read


@dataclass(frozen=True)
class Motion:
    """Motions at the points of a branch as far as they are compared, (points,): NaN and 0 where not known."""

    amplitude: Array
    velocity: Array
    impacts: Array  #: a drive period; NaN also where the same motion may have another number
    period: NDArray[np.int64]

    @classmethod
    def of(cls, response: FrequencyResponse) -> Motion:
        """Motions of a response."""
        done = complete(response)
        values = (response.amplitude, response.impact_velocity, response.impacts_per_period)
        amplitude, velocity, impacts = (np.where(done, each, np.nan) for each in values)
        return cls(amplitude, velocity, impacts, response.period)

    @classmethod
    def predicted(cls, response: FrequencyResponse, estimate: ErrorEstimate, alike: bool = True) -> Motion:
        """Motions of the full model that an estimate says are those of a response; ``alike``: impact by impact.

        Where not, or at rest for a while, they may have other numbers of impacts.
        """
        own = cls.of(response)
        amplitude, velocity = (
            np.where(estimate.known, values / (1 + error), np.nan)
            for values, error in ((own.amplitude, estimate.amplitude), (own.velocity, estimate.impact_velocity))
        )
        other = (own.impacts > 0) & ((response.rest > 0) | (not alike))
        impacts, velocity = (np.where(other, np.nan, each) for each in (own.impacts, velocity))
        return cls(amplitude, velocity, impacts, own.period)

    @property
    def known(self) -> NDArray[np.bool_]:
        """Points (points,) of which it is known."""
        return np.isfinite(self.amplitude)

    def agrees(self, other: Motion) -> NDArray[np.bool_]:
        """Test (points,) whether two are one motion, within what a flight that still settles may be off."""
        velocity = ~(np.abs(self.velocity / other.velocity - 1) > AGREES)
        same = np.where(self.impacts == 0, other.impacts == 0, velocity)
        near = ~(np.abs(self.impacts - other.impacts) > 1 / READ)
        return np.asarray(same & near & (np.abs(self.amplitude / other.amplitude - 1) <= AGREES))

    def at(self, point: int) -> Motion:
        """Motion at one point."""
        return Motion(*(getattr(self, name)[point : point + 1] for name in NAMES))


NAMES = tuple(field.name for field in fields(Motion))
_NAN = np.full(1, np.nan)
UNKNOWN = Motion(_NAN, _NAN, _NAN, np.zeros(1, dtype=np.int64))


class FullSweep:
    """Sweep of the full model ``system``, branch after branch, its state carried; see the module.

    TooDear where it takes more than ``work``.
    """

    def __init__(self, system: ImpactSystem, slowest: float, settle: int, output: str, work: CountedWork) -> None:
        self._work = work
        self._flight, self._output = exact_solver(system, slowest), output
        self._flight.limit = MOST
        self._settle = min(settle, LONGEST)
        self._part = max(self._settle // FIRST, 1)
        self._starts: list[State | None] = [None]

    def work(self, omega: float, base: float, points: int) -> float:
        """Work in contact evaluations × modes that the sweep of so many ``points`` will take at least."""
        found, _ = self._flight.steady([omega], base, None, READ, READ, self._output, layout.OUTPUT_ALONE)
        return float(found.evaluations[0]) / (2 * READ) * self._flight.system.size * points * (self._part + READ)

    def branch(self, omega: Array, base: Array, expected: Sequence[Motion]) -> Motion:
        """Motions at drives ``omega`` (points,) rad/s, ``base`` m, in the order swept, beside those ``expected``."""
        known = np.append(np.any([each.known for each in expected], axis=0), True)
        points = [
            self._beside(omega[i], base[i], [each.at(i) for each in expected if each.known[i]])
            if known[i]
            else self._between(omega[i], base[i], last=bool(known[i + 1]))
            for i in range(len(omega))
        ]
        return Motion(*(np.concatenate([getattr(p, name) for p in points]) for name in NAMES))

    def _beside(self, omega: float, base: float, expected: Sequence[Motion]) -> Motion:
        """Motion at one drive: one of those expected where it ends there from all starts, else another one."""
        found = UNKNOWN
        for start in self._starts or [None]:
            found, state = self._settled(omega, base, expected, start)
            self._starts = [] if state is None else [state]
            if not any(each.agrees(found)[0] for each in expected):
                break
        return found

    def _settled(
        self, omega: float, base: float, expected: Sequence[Motion], state: State | None
    ) -> tuple[Motion, State | None]:
        """Motion from one start, on one of those expected or after all of the settling, and its state."""
        hold, flown, more = READ * max(abs(int(each.period[0])) for each in expected), 0, self._part
        while True:
            found, state = self._on(omega, base, state, more, hold)
            flown += more + hold
            if state is None or flown >= self._settle or any(each.agrees(found)[0] for each in expected):
                return found, state
            more = min(flown, self._settle - flown)

    def _between(self, omega: float, base: float, last: bool) -> Motion:
        """Motion at a drive at which none is known: only carried on; ``last``: the next one has several starts."""
        if not self._starts:
            return UNKNOWN
        found, state = self._on(omega, base, self._starts[0], self._settle if last else self._part, 1)
        self._starts = [state]
        for periods in range(1, STARTS) if last else ():
            if state is not None:
                _, state = self._on(omega, base, state, periods, 1)
                self._starts.append(state)
        self._starts = [each for each in self._starts if each is not None]
        return found

    def _on(
        self, omega: float, base: float, state: State | None, settle: int, hold: int
    ) -> tuple[Motion, State | None]:
        """Motion of so many periods, and the state after it; None where it was given up."""
        response, after = self._flight.steady(
            [omega], float(base), state, settle, hold, self._output, layout.OUTPUT_ALONE
        )
        self._work.flight(self._flight.system, int(response.evaluations[0]), int(response.impacts[0]))
        return Motion.of(response), after if complete(response)[0] else None


def without_another_motion(estimate: ErrorEstimate, expected: Motion, flown: Motion) -> ErrorEstimate:
    """Estimate without the points at which the full model was ``flown`` to another motion than was ``expected``."""
    other = expected.known & ~expected.agrees(flown)
    names = (*QUANTITIES, *(f"{name}_bound" for name in QUANTITIES))
    rows = {name: np.where(other, np.nan, getattr(estimate, name)) for name in names}
    return replace(estimate, basis=np.where(other, Basis.ANOTHER.code, estimate.basis), **rows)
