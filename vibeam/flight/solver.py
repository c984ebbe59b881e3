"""Flight solvers of systems with one contact: exact closed form between events, certified first roots, impulses.

Plain modes with one coefficient of restitution have a solver of their own; any law, a second stop and damping that
couples the modes go by regimes. ``exact_solver`` chooses, and what an engine loads at its first call is no cost of a
motion: a motion of no duration is run unmeasured.
"""

from __future__ import annotations

from collections.abc import Hashable
from functools import cached_property
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from vibeam.flight.engine.entries import cover, move, poses_at, regimes_cover, regimes_move, regimes_poses_at
from vibeam.flight.engine.threads import PerThread
from vibeam.flight.event_driven import EventDrivenSolver
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.layout import Engine, Regime
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.kernels.regimes.layout import RegimeEngine
from vibeam.flight.linear.block_regime import derivative_signal
from vibeam.flight.linear.packing import PackedSystem, pack, slowest_rate
from vibeam.flight.linear.regimes import plan
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.flight.contacts.solver import ContactsSolver


def reading_of(quantity: str) -> int:
    """Level of detail in which a steady point must be read off for a ``quantity``: the amplitude, or the reach too."""
    return layout.REACH_TOO if quantity == "reach" else layout.OUTPUT_ALONE


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
            signal = derivative_signal(regime.blocks, regime.outof, wanted.row, wanted.order, wanted.base)
            regime.signals[layout.OUTPUT_SIGNAL] = signal
        return np.array(wanted.row)


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

    def _reader(self, output: str) -> EventDrivenSolver:
        return self if self.system.derivative(output) is None else self._in_regimes

    @cached_property
    def _in_regimes(self) -> RegimeSolver:
        """The solver whose kernels read derivatives too: the same motion at several times the cost an impact."""
        return RegimeSolver(self.system, *self._made_for, limit=self.limit)


ExactSolver: TypeAlias = "FlightSolver | RegimeSolver | ContactsSolver"


def exact_solver(system: ImpactSystem, slowest: float, span: float = 0.0) -> ExactSolver:
    """The engine that takes ``system``, made for drives of ``slowest`` rad/s and more."""
    if system.further is not None:
        from vibeam.flight.contacts.solver import ContactsSolver

        return ContactsSolver(system, slowest, span)
    if system.beyond_plain:
        return RegimeSolver(system, slowest, span)
    return FlightSolver(system, slowest, span)


_READY: set[tuple[Hashable, ...]] = set()


def warm_up_motion(system: ImpactSystem, drive: Drive) -> None:
    """Run a motion of next to no duration, once a process for systems of the same kind."""
    kind = kind_of(system)
    if kind not in _READY:
        exact_solver(system, drive.omega, 1.0).simulate(drive, None, 0.0, 1e-9, 1)
        _READY.add(kind)


def kind_of(system: ImpactSystem) -> tuple[Hashable, ...]:
    """Features of the system beyond plain modes, which decide the code that runs."""
    law = None if system.law is None else system.law.name
    return law, system.coupling is None, system.second_gap is None, system.further is None
