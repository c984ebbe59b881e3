"""Steady points frequency by frequency, the state carried from each to the next: base class of solvers."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any

import numpy as np

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

    @abstractmethod
    def begin(self, state: State | None) -> Any:
        """Quantity carried to the first point: the state, or its reduction to one mode."""

    @abstractmethod
    def point(
        self, response: FrequencyResponse, index: int, drive: Drive, carried: Any, settle: int, hold: int, output: str
    ) -> Any:
        """Write one point of ``response``; return the quantity carried to the next."""

    def end(self, carried: Any) -> State:
        """State after the last point."""
        state: State = carried
        return state
