"""One run: a solver at one setting, over the frequencies of a study, with its CPU time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from vibeam.flight.engine.threads import Clock, OutOfTime, ending_at
from vibeam.solvers import SOLVERS, solver
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import Ended, FrequencyResponse, join
from vibeam.system.state import State
from vibeam_models.arrays import Array

RTOLS = (1e-3, 1e-4, 1e-6, 1e-8, 1e-10)
STEPS = (100, 300, 1000, 3000, 10_000)
ATOL = 1e-2  # absolute tolerance over relative tolerance and size of the motion: the paper's 1e-8 for 1e-4 and 1e-2
SHORT, REPEATS = 0.02, 3  # s: a run that takes less is timed again so often, without a look at the clock within it


@dataclass(frozen=True)
class Setting:
    """One solver at one setting."""

    solver: str
    method: str = ""
    setting: str = ""
    options: Mapping[str, Any] = field(default_factory=dict)

    @property
    def label(self) -> str:
        """Name in tables and messages."""
        return " ".join(filter(None, (self.solver, self.method, self.setting)))


FLIGHT = Setting("flight")


def settings_of(solver: str, size: float) -> list[Setting]:
    """Settings of one solver, loose to strict, for contact motions of about ``size`` m; all methods at a tolerance."""
    declared = SOLVERS[solver].settings
    found = [Setting(solver, method=name, options=values) for name, values in declared.options.items()]
    for rtol in RTOLS:
        given = {"rtol": rtol, "atol": ATOL * rtol * size, "limit": declared.limit}
        found += [Setting(solver, name, f"rtol {rtol:.0e}", {"method": name, **given}) for name in declared.methods]
    found += [Setting(solver, "", f"{steps} steps", {"steps": steps}) for steps in STEPS if declared.steps]
    return found or [Setting(solver)]


@dataclass(frozen=True)
class Plan:
    """Sweep up over ``omega`` (rad/s), the state carried; ``amplitude``: of the base at each, m."""

    omega: Array
    amplitude: Array
    settle: int
    hold: int
    output: str


class Measurement:
    """Run under way, point by point: ``response`` so far, CPU seconds in all and of the points that are done."""

    def __init__(self, system: ImpactSystem, setting: Setting, plan: Plan, clock: Clock) -> None:
        self.system, self.setting, self.plan, self._clock = system, setting, plan, clock
        self.used, self.seconds = 0.0, 0.0
        self._parts: list[FrequencyResponse] = []
        self._runner: Any = None
        self._state: State | None = None

    def __len__(self) -> int:
        return len(self._parts)

    @property
    def done(self) -> bool:
        """True where all points are there."""
        return len(self) == len(self.plan.omega)

    @property
    def response(self) -> FrequencyResponse:
        """Points of the plan; those that are not there as ``Ended.NOT_RUN``."""
        rest = self.plan.omega[len(self) :] / (2 * np.pi)
        return join([*self._parts, FrequencyResponse.empty(rest, self.system.size)])

    @property
    def failure(self) -> str:
        """Reason why a point failed; empty where none did. A motion of another kind is no failure."""
        codes = [int(part.ended[0]) for part in self._parts]
        broken = [code for code in codes if code not in (Ended.COMPLETE.code, Ended.NO_ORBIT.code)]
        if not broken:
            return ""
        reason = Ended.of_code(broken[0]).value.partition(":")[0]  # the cure after the colon does not apply here
        return f"{len(broken)} of {len(self)} points: {reason}"

    def step(self, allowed: float = np.inf) -> bool:
        """Compute the next point; False where it takes more than ``allowed`` seconds: then nothing goes on.

        ValueError where the solver cannot take the system.
        """
        begun = self._clock()
        try:
            with ending_at(self._clock, begun + allowed):
                self._point()
        except OutOfTime:
            return False
        finally:
            self.used += self._clock() - begun
        self.seconds = self.used
        return True

    def _point(self) -> None:
        plan, index = self.plan, len(self)
        if self._runner is None:
            slowest = float(np.min(plan.omega))
            self._runner = solver(self.setting.solver, self.system, slowest, **self.setting.options)
        part, self._state = self._runner.steady(
            plan.omega[index : index + 1], float(plan.amplitude[index]), self._state, plan.settle, plan.hold,
            plan.output,
        )  # fmt: skip
        self._parts.append(part)

    def timed_again(self) -> None:
        """Take the least time of a few more runs where all points took little: without a look at the clock within."""
        if not self.done or self.used > SHORT:
            return
        again = [Measurement(self.system, self.setting, self.plan, self._clock) for _ in range(REPEATS)]
        self.seconds = min(_seconds(each._all, self._clock) for each in again)

    def _all(self) -> None:
        while not self.done:
            self._point()


def _seconds(run: Callable[[], None], clock: Clock) -> float:
    begun = clock()
    run()
    return clock() - begun


def measured(
    system: ImpactSystem, setting: Setting, plan: Plan, clock: Clock = lambda: 0.0, allowed: float = np.inf
) -> Measurement:
    """Run all of a plan, or what ``allowed`` seconds are enough for."""
    found = Measurement(system, setting, plan, clock)
    while not found.done and found.used < allowed and found.step(allowed - found.used):
        pass
    return found
