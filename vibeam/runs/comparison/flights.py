"""Steady points of a model one at a time, from given states: by the solver of a fidelity, or exactly."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.fidelity import gap_drift, gap_wear
from vibeam.runs.sweep import march
from vibeam.solvers import solver
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import FrequencyResponse
from vibeam.system.state import State
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.case.case import Case


@dataclass
class Work:
    """CPU seconds that may still be spent."""

    left: float = inf

    @property
    def done(self) -> bool:
        """True where nothing is left."""
        return self.left <= 0


class CaseFlights:
    """Steady points of the sweep of one fidelity of a case, of its own system or of a ``system`` in its place.

    ``work``: what they may take, from which each is taken.
    """

    def __init__(self, case: Case, name: str, system: ImpactSystem | None = None, work: Work | None = None) -> None:
        self._work = work or Work()
        own, plan = case.fidelities[name], case.sweep
        self._scene = case.scene_of(name)
        self._base: Callable[[Array], Any] = lambda omega: case.amplitude_of(name, omega)
        self._settle, self._hold, self._output = plan.settle, plan.hold, plan.output
        self._system, self._slowest = system or case.system(name), 2 * np.pi * float(plan.frequency.min())
        self._solver, self._options = (own.solver, own.options) if system is None else ("flight", {})
        grid = 2 * np.pi * plan.frequency
        plain = gap_drift(self._scene, grid) is None and not self._scene.harmonics
        own_options: Any = self._options
        self._runner = solver(self._solver, self._system, self._slowest, **own_options) if plain else None

    @property
    def done(self) -> bool:
        """See ``Flights``."""
        return self._work.done

    def at(self, frequency: float, state: State | None, settle: bool = True) -> tuple[FrequencyResponse, State]:
        """See ``Flights``."""
        found = self._steady(np.array([2 * np.pi * frequency]), state, self._settle if settle else 0)
        self._work.left -= float(np.nansum(found[0].cpu_seconds))
        return found

    def _steady(self, omega: Array, state: State | None, settle: int) -> tuple[FrequencyResponse, State]:
        base = float(np.ravel(self._base(omega))[0])
        if self._runner is not None:
            return self._runner.steady(omega, base, state, settle, self._hold, self._output)  # type: ignore[no-any-return]
        settings: Mapping[str, Any] = {
            "settle": settle, "hold": self._hold, "output": self._output, "solver": self._solver,
            "options": self._options, "harmonics": self._scene.harmonics, "slowest": self._slowest,
        }  # fmt: skip
        [found] = march(self._system, omega, base, state=state, drift=gap_drift(self._scene, omega), **settings)
        return found


def flights_of(
    case: Case, name: str, system: ImpactSystem | None = None, work: Work | None = None
) -> CaseFlights | None:  # fmt: skip
    """Steady points of a fidelity; None where its points hang on those before them, by wear."""
    return None if gap_wear(case.scene_of(name)) is not None else CaseFlights(case, name, system, work)
