"""Measurement of one run: the same sweep and path for every fidelity, and every solver from loose to strict."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from vibeam.flight.engine.threads import Clock, OutOfTime, ending_at, pause
from vibeam.solvers import SOLVERS, solver
from vibeam.studies.cost.trajectories import ComparedPath, path_of, released
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Ended, FrequencyResponse, join
from vibeam.system.state import State
from vibeam_models.arrays import Array

RTOLS = (1e-3, 1e-4, 1e-6, 1e-8, 1e-10)
STEPS = (100, 300, 1000, 3000, 10_000)
ORDERS = {"RK23": 3, "RK45": 5, "DOP853": 8, "LSODA": 8}  # order of a step's error: tolerance^(−1/order) steps
ATOL = 1e-2  # absolute tolerance over relative tolerance and size of the motion: the paper's 1e-8 for 1e-4 and 1e-2


@dataclass(frozen=True)
class Setting:
    """One solver at one setting; ``growth``: about the ratio of its cost to that of the setting before it."""

    solver: str
    method: str = ""
    setting: str = ""
    options: Mapping[str, Any] = field(default_factory=dict)
    growth: float = 1.0

    @property
    def label(self) -> str:
        """Name in tables and messages."""
        return " ".join(filter(None, (self.solver, self.method, self.setting)))


Series = tuple[Setting, ...]


def series_of(solver: str, size: float) -> list[Series]:
    """Series of settings of one solver for contact motions of about ``size`` m; a single point is a series of one."""
    declared = SOLVERS[solver].settings
    found: list[Series] = [(Setting(solver, method=name, options=values),) for name, values in declared.options.items()]
    for method in declared.methods:
        given = [
            {"method": method, "rtol": rtol, "atol": ATOL * rtol * size, "limit": declared.limit} for rtol in RTOLS
        ]
        growth = [(looser / rtol) ** (1 / ORDERS[method]) for looser, rtol in _in_turn(RTOLS)]
        names = [f"rtol {rtol:.0e}" for rtol in RTOLS]
        found.append(tuple(Setting(solver, method, *each) for each in zip(names, given, growth, strict=True)))
    if declared.steps:
        turns = _in_turn(STEPS)
        found.append(tuple(Setting(solver, "", f"{n} steps", {"steps": n}, n / before) for before, n in turns))
    return found or [(Setting(solver),)]


def _in_turn(values: Sequence[float]) -> list[tuple[float, float]]:
    """Each value with the one before it, the first with itself."""
    return list(zip([values[0], *values], values, strict=False))


@dataclass(frozen=True)
class Plan:
    """Plan of every run: a sweep up over ``omega`` (rad/s), the state carried, then a path of ``window`` periods.

    ``amplitude``: of the base at each, m.
    Where the motion is aperiodic, ``cloud`` further periods are sampled one by one. ``size``: of the contact, m;
    ``drive`` moves the path.
    """

    omega: Array
    amplitude: Array
    settle: int
    hold: int
    output: str
    cloud: int
    window: int
    size: float
    drive: Drive

    def at(self, index: int) -> Plan:
        """Plan for one of its frequencies alone."""
        return replace(self, omega=self.omega[index : index + 1], amplitude=self.amplitude[index : index + 1])


@dataclass(frozen=True)
class AperiodicSample:
    """Sample of an aperiodic motion, period by period: amplitudes (periods,) and impact velocities (impacts,)."""

    amplitude: Array
    velocity: Array
    impacts: int = 0
    evaluations: int = 0


@dataclass(frozen=True)
class Measurement:
    """Measurements of a run; ``clouds`` by the index of their frequency, ``path`` None where the solver keeps none."""

    response: FrequencyResponse
    clouds: Mapping[int, AperiodicSample] = field(default_factory=dict)
    path: ComparedPath | None = None
    periods: int = 0

    @property
    def impacts(self) -> int:
        """Number of impacts computed: of the sweep, the samples and the path."""
        pathed = 0 if self.path is None else len(self.path.impact_times)
        return int(np.sum(self.response.impacts)) + sum(each.impacts for each in self.clouds.values()) + pathed

    @property
    def evaluations(self) -> int:
        """Number of evaluations of the same."""
        pathed = 0 if self.path is None else self.path.evaluations
        clouded = sum(each.evaluations for each in self.clouds.values())
        return int(np.sum(self.response.evaluations)) + clouded + pathed

    @property
    def failure(self) -> str:
        """Reason why a point failed; empty where none did. A motion of another kind is no failure."""
        fine = (Ended.COMPLETE.code, Ended.NO_ORBIT.code)
        broken = [int(code) for code in self.response.ended if code not in fine]
        if not broken:
            return ""
        reason = Ended.of_code(broken[0]).value.partition(":")[0]  # the cure after the colon does not apply here
        return f"{len(broken)} of {len(self.response)} points: {reason}"


def measure(
    system: ImpactSystem, setting: Setting, plan: Plan, clock: Clock = lambda: 0.0, deadline: float = np.inf
) -> Measurement:
    """Run the plan; ValueError where the solver cannot take the system, OutOfTime soon after ``clock`` passes
    ``deadline``.
    """
    parts: list[FrequencyResponse] = []
    try:
        with ending_at(clock, deadline):
            return _measured(system, setting, plan, parts)
    except OutOfTime as up:
        raise OutOfTime(f"stopped after {len(parts)} of {len(plan.omega)} points: {up}") from None


def _measured(system: ImpactSystem, setting: Setting, plan: Plan, parts: list[FrequencyResponse]) -> Measurement:
    """Run the plan; ``parts`` takes the points as they are done."""
    runner = solver(setting.solver, system, float(np.min(plan.omega)), **setting.options)
    clouds: dict[int, AperiodicSample] = {}
    state: State | None = None
    for index, omega in enumerate(plan.omega):
        pause()
        one = np.array([omega])
        base = float(plan.amplitude[index])
        part, state = runner.steady(one, base, state, plan.settle, plan.hold, plan.output)
        parts.append(part)
        if part.period[0] == 0 and part.ended[0] == Ended.COMPLETE.code and plan.cloud:
            each = np.full(plan.cloud, omega)
            watched, state = runner.steady(each, base, state, 0, 1, plan.output)
            clouds[index] = _cloud(watched)
    path = _path(runner, SOLVERS[setting.solver].motion, system, plan) if plan.window else None
    periods = len(plan.omega) * (plan.settle + plan.hold) + len(clouds) * plan.cloud + plan.window * (path is not None)
    return Measurement(join(parts), clouds, path, periods)


def _cloud(watched: FrequencyResponse) -> AperiodicSample:
    velocities, amplitudes = watched.impact_velocities.ravel(), watched.amplitude
    counts = int(np.sum(watched.impacts)), int(np.sum(watched.evaluations))
    return AperiodicSample(amplitudes[np.isfinite(amplitudes)], velocities[np.isfinite(velocities)], *counts)


def _path(runner: object, motion: str, system: ImpactSystem, plan: Plan) -> ComparedPath | None:
    end = plan.window * 2 * np.pi / plan.drive.omega
    try:
        return path_of(runner, motion, plan.drive, released(system, plan.size), end, plan.output)
    except ValueError:  # averaging has no motion at this frequency: no path to be compared
        return None
