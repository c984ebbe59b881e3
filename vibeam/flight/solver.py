"""The flight solver: exact closed form between events, certified first roots, impulses on all modes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.entries import cover, move, poses_at
from vibeam.flight.event_driven import EventDrivenSolver
from vibeam.flight.kernels.layout import STATUS_ROWS, Engine, Regime
from vibeam.flight.linear.packing import PackedSystem, pack
from vibeam.system.impact_system import ImpactSystem

Array = NDArray[np.float64]


class FlightSolver(EventDrivenSolver):
    """One system, packed once for drives of ``slowest`` rad/s and more; its methods take a state and give one back."""

    _move, _poses_at, _cover = staticmethod(move), staticmethod(poses_at), staticmethod(cover)

    def __init__(self, system: ImpactSystem, slowest: float, span: float = 0.0, limit: int = 100_000) -> None:
        """``limit``: impacts a drive period (or a call of ``simulate``) after which it gives up."""
        system.require_plain("the flight kernels")
        self.packed: PackedSystem = pack(system, slowest, span)
        super().__init__(system, limit)

    def _engine_for(self, size: float) -> Engine:
        return self.packed.desk_for(size)

    def _regimes(self) -> tuple[Regime, ...]:
        return (self.packed.desk.rest,)

    def _scratch(self) -> tuple[Array, ...]:
        return *super()._scratch(), np.zeros(STATUS_ROWS)

    def _inward(self, values: Array) -> Array:
        return self.packed.inward(values)

    def _outward(self, values: Array) -> Array:
        return self.packed.outward(values)
