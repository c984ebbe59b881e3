"""The solver of systems with more than one coefficient of restitution and modes by themselves: the same calls."""

from __future__ import annotations

import numpy as np

from vibeam.flight.engine.entries import regimes_cover, regimes_move, regimes_poses_at
from vibeam.flight.engine.threads import PerThread
from vibeam.flight.event_driven import EventDrivenSolver
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.kernels.regimes.layout import RegimeEngine
from vibeam.flight.linear.block_regime import set_derivative
from vibeam.flight.linear.packing import slowest_rate
from vibeam.flight.linear.regimes import plan
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array


class RegimeSolver(EventDrivenSolver):
    """One system, made ready once for drives of ``slowest`` rad/s and more; takes a state and gives one back.

    What it finds is exact between events as in ``FlightSolver``; a stop that is not linear is integrated while it is
    touched, to 1e-12 a step. ``FrequencyResponse.rest`` is the share of time in contact, resting or pushed.
    """

    _move, _poses_at, _cover = staticmethod(regimes_move), staticmethod(regimes_poses_at), staticmethod(regimes_cover)
    _status_rows, _trace_columns = regime_layout.STATUS_ROWS, regime_layout.TRACE_COLUMNS

    def __init__(self, system: ImpactSystem, slowest: float, span: float = 0.0, limit: int = 100_000) -> None:
        """``limit``: impacts a drive period (or a call of ``simulate``) after which it gives up."""
        super().__init__(system, limit)
        self._plans = PerThread(plan(system, slowest_rate(system, slowest, span)))

    @property
    def plan(self) -> RegimeEngine:
        """The calling thread's arrays."""
        return self._plans.own()

    def _engine_for(self, size: float) -> RegimeEngine:
        own = self.plan
        own.drive[layout.MOTION] = size
        return own

    def _regimes(self) -> tuple[Regime, ...]:
        own = self.plan
        return own.free, own.upper, own.lower

    def _restart(self, pose: Array, status: Array, kind: float) -> None:
        super()._restart(pose, status, kind)
        status[layout.ORDER], status[regime_layout.SIDE] = regime_layout.UNKNOWN, self._nearer(pose[0])

    def _nearer(self, displacement: Array) -> int:
        """The stop that is nearer."""
        place, second = float(self.system.contact @ displacement), self.system.second_gap
        return int(second is not None and place + second < self.system.gap - place)

    def _watch(self, output: str | None) -> Array:
        wanted = None if output is None else self.system.derivative(output)
        if wanted is None:
            return super()._watch(output)
        if self.system.contact_law.integrated:
            said = f"output {output!r}: the {wanted.called} in a contact that is integrated is not read"
            raise ValueError(f"{said}, {self.system.contact_law.name!r}: take a linear stop, or one with a restitution")
        for regime in self._regimes():
            set_derivative(regime, wanted)
        return np.array(wanted.row)
