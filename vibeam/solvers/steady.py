"""Base class of solvers: steady points frequency by frequency, the state carried on; and warm-up runs.

Loading and compiling at a solver's first call are no part of its cost. That call reads its kernels from numba's cache
(0.15 s, as much as a short sweep), imports what scipy loads late and touches its memory for the first time; all that
counts as CPU time of the thread.
"""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Hashable, Mapping, Sequence
from typing import Any

import numpy as np

from vibeam.flight.equilibrium import equilibrium
from vibeam.flight.solver import kind_of
from vibeam.solvers import solver
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import FrequencyResponse
from vibeam.system.state import State
from vibeam_models.arrays import Array


class SteadySolver(ABC):
    """Solver built as ``Class(system, slowest, span, **options)``; subclasses compute one ``point`` at a time.

    ValueError on construction for a system or an option that it cannot take.
    """

    system: ImpactSystem

    def steady(
        self,
        omegas: Sequence[float] | Array,
        amplitude: float,
        state: State | None,
        settle: int,
        hold: int,
        output: str,
    ) -> tuple[FrequencyResponse, State]:
        """Steady points at ``omegas`` (rad/s), in order, under base motion of ``amplitude`` m; and the last state.

        ``settle`` and ``hold``: drive periods left out and read; ``state`` None: static equilibrium.
        """
        self.system.derivative(output)  # KeyError for an unknown one
        response = FrequencyResponse.empty(np.asarray(omegas, dtype=float) / (2 * np.pi), self.system.size)
        carried = self.begin(state)
        for index, omega in enumerate(omegas):
            begun = time.thread_time()
            carried = self.point(response, index, Drive(float(omega), amplitude), carried, settle, hold, output)
            response.cpu_seconds[index] = time.thread_time() - begun
        return response, self.end(carried)

    def begin(self, state: State | None) -> Any:
        """Quantity carried to the first point: the state, or its reduction to one mode; None: of static equilibrium."""
        return equilibrium(self.system) if state is None else state

    @abstractmethod
    def point(
        self, response: FrequencyResponse, index: int, drive: Drive, carried: Any, settle: int, hold: int, output: str
    ) -> Any:
        """Write one point of ``response``; return the quantity carried to the next."""

    def end(self, carried: Any) -> State:
        """State after the last point."""
        state: State = carried
        return state


Options = Mapping[str, Any]
SETTLE, HOLD = 1, 2  # drive periods: the smallest number in which a motion can repeat


_READY: set[tuple[Hashable, ...]] = set()


def warm_up(name: str, system: ImpactSystem, omega: float, amplitude: float, output: str, options: Options) -> None:
    """Run one short point with a solver of its own, at ``omega`` rad/s and base ``amplitude`` m; discard the result."""
    made = solver(name, system, omega, **options)
    made.steady(np.array([omega]), amplitude, None, SETTLE, HOLD, output)
    _READY.add(_kind(name, system, options))


def warm_up_once(
    name: str, system: ImpactSystem, omega: float, amplitude: float, output: str, options: Options
) -> None:
    """Warm up once in this process for each solver and type of system."""
    if _kind(name, system, options) not in _READY:
        warm_up(name, system, omega, amplitude, output, options)


def _kind(name: str, system: ImpactSystem, options: Options) -> tuple[Hashable, ...]:
    """Key of the code that a run executes: the solver, its methods, and the system's features beyond plain modes."""
    methods = tuple(sorted(item for item in options.items() if isinstance(item[1], str)))
    return name, methods, *kind_of(system)
