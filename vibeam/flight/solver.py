"""The flight solver: exact closed form between events, certified first roots, impulses on all modes."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from vibeam.flight.engine.entries import cover, move, poses_at
from vibeam.flight.event_driven import EventDrivenSolver
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.layout import Engine, Regime
from vibeam.flight.linear.packing import PackedSystem, pack
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.flight.regime_solver import RegimeSolver
    from vibeam.system.response import FrequencyResponse
    from vibeam.system.state import State


def reading_of(quantity: str) -> int:
    """Level of detail in which a steady point must be read off for a ``quantity``: the amplitude, or the reach too."""
    return layout.REACH_TOO if quantity == "reach" else layout.OUTPUT_ALONE


class FlightSolver(EventDrivenSolver):
    """One system, packed once for drives of ``slowest`` rad/s and more; its methods take a state and give one back."""

    _move, _poses_at, _cover = staticmethod(move), staticmethod(poses_at), staticmethod(cover)

    def __init__(self, system: ImpactSystem, slowest: float, span: float = 0.0, limit: int = 100_000) -> None:
        """``limit``: impacts a drive period (or a call of ``simulate``) after which it gives up."""
        system.require_plain("the flight kernels")
        self._made_for = slowest, span
        self.packed: PackedSystem = pack(system, slowest, span)
        super().__init__(system, limit)

    def _engine_for(self, size: float) -> Engine:
        return self.packed.engine_for(size)

    def _still_pose(self) -> tuple[Array, Array]:
        if self.packed.still is None:
            self.packed.still = super()._still_pose()
        pose, status = self.packed.still
        return pose.copy(), status.copy()

    def _regimes(self) -> tuple[Regime, ...]:
        return (self.packed.engine.rest,)

    def _carries(self) -> bool:
        return super()._carries() or bool(self.packed.engine.signal[layout.ATTACHED] > 0.0)

    def _scratch(self) -> tuple[Array, ...]:
        return *super()._scratch(), np.zeros(layout.STATUS_ROWS)

    def _inward(self, values: Array) -> Array:
        return self.packed.inward(values)

    def _outward(self, values: Array) -> Array:
        return self.packed.outward(values)

    def steady(
        self,
        omegas: Sequence[float] | Array,
        amplitude: float | Array,
        state: State | None,
        settle: int,
        hold: int,
        output: str,
        reading: int = layout.EVERYTHING,
        states: list[State] | None = None,
        strobes: list[Array] | None = None,
    ) -> tuple[FrequencyResponse, State]:
        """As ``EventDrivenSolver.steady``; by the engine of regimes where the output is a velocity or acceleration."""
        if self.system.derivative(output) is not None:
            return self._in_regimes.steady(omegas, amplitude, state, settle, hold, output, reading, states, strobes)
        return super().steady(omegas, amplitude, state, settle, hold, output, reading, states, strobes)

    def rounds(
        self, omegas: Array, amplitudes: Array, states: Array, output: str, reading: int = layout.EVERYTHING
    ) -> tuple[FrequencyResponse, Array]:
        """As ``EventDrivenSolver.rounds``; of a velocity or acceleration as ``steady``."""
        if self.system.derivative(output) is not None:
            return self._in_regimes.rounds(omegas, amplitudes, states, output, reading)
        return super().rounds(omegas, amplitudes, states, output, reading)

    @cached_property
    def _in_regimes(self) -> RegimeSolver:
        """The solver whose kernels read derivatives too: the same motion at several times the cost an impact."""
        from vibeam.flight.regime_solver import RegimeSolver

        return RegimeSolver(self.system, *self._made_for, limit=self.limit)
