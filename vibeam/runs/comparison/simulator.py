"""Steady points of a model one at a time, from given states: by the solver of a fidelity, or exactly."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from vibeam.case.fidelity import gap_drift, gap_wear
from vibeam.runs.comparison.work import Work, WorkRate
from vibeam.runs.sweep import march
from vibeam.solvers import solver
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import FrequencyResponse
from vibeam.system.state import State
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.case.case import Case

PIECE = 300  # drive periods after which a point may be broken off


class CaseSimulator:
    """Steady points of the sweep of one fidelity of a case, of its own system or of a ``system`` in its place.

    ``work``: what they may take, to which each is added. Without any point the fidelity's system is not made.
    """

    def __init__(self, case: Case, name: str, system: ImpactSystem | None = None, work: Work | None = None) -> None:
        self._case, self._name, self._given, self._work = case, name, system, work or Work()
        self._scene, self._plan = case.scene_of(name), case.sweep
        own = case.fidelities[name]
        self._solver, self._options = (own.solver, own.options) if system is None else ("flight", {})
        self._slowest = 2 * np.pi * float(self._plan.frequency.min())
        self._rate = WorkRate.of(self._scene)

    @cached_property
    def _system(self) -> ImpactSystem:
        return self._given or self._case.system(self._name)

    @cached_property
    def _runner(self) -> Any:
        """The solver, made once; None where each point needs one of its own: the gap moves, the drive has harmonics."""
        grid, options = 2 * np.pi * self._plan.frequency, cast("Any", self._options)
        plain = gap_drift(self._scene, grid) is None and not self._scene.harmonics
        return solver(self._solver, self._system, self._slowest, **options) if plain else None

    @property
    def done(self) -> bool:
        """See ``Simulator``."""
        return self._work.done

    def at(self, frequency: float, state: State | None, settle: bool = True) -> tuple[FrequencyResponse, State]:
        """See ``Simulator``."""
        omega, left = np.array([2 * np.pi * frequency]), settle * self._plan.settle
        while self._work.breaks and left > PIECE:
            _, state = self._steady(omega, state, PIECE - 1, 1)
            left -= PIECE
        return self._steady(omega, state, left, self._plan.hold)

    def _steady(self, omega: Array, state: State | None, settle: int, hold: int) -> tuple[FrequencyResponse, State]:
        found = self._simulated(omega, state, settle, hold)
        counted, measured = self._rate.seconds(found[0], settle + hold), found[0].cpu_seconds
        self._work.add(float(counted.sum()), float(np.nansum(measured)))
        return found

    def _simulated(self, omega: Array, state: State | None, settle: int, hold: int) -> tuple[FrequencyResponse, State]:
        base, plan = float(np.ravel(self._case.amplitude_of(self._name, omega))[0]), self._plan
        if self._runner is not None:
            return self._runner.steady(omega, base, state, settle, hold, plan.output)  # type: ignore[no-any-return]
        settings: Mapping[str, Any] = {
            "settle": settle, "hold": hold, "output": plan.output, "solver": self._solver,
            "options": self._options, "harmonics": self._scene.harmonics, "slowest": self._slowest,
        }  # fmt: skip
        [found] = march(self._system, omega, base, state=state, drift=gap_drift(self._scene, omega), **settings)
        return found


def simulator_of(
    case: Case, name: str, system: ImpactSystem | None = None, work: Work | None = None
) -> CaseSimulator | None:  # fmt: skip
    """Steady points of a fidelity; None where its points hang on those before them, by wear."""
    return None if gap_wear(case.scene_of(name)) is not None else CaseSimulator(case, name, system, work)
