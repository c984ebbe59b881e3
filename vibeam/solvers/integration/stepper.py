"""Base classes of time-stepping solvers: steady points and motions from their ``run``; options of scipy's."""

from __future__ import annotations

import time
from abc import abstractmethod
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np

from vibeam.flight.engine.threads import pause
from vibeam.flight.equilibrium import equilibrium
from vibeam.flight.event_driven import modal_values
from vibeam.solvers.integration.coordinates import EXPLICIT, IntegrationSettings, chosen
from vibeam.solvers.integration.samples import SampledMotion, SampledPiece, SampledReading, SteppedOutcome, merged
from vibeam.solvers.steady import SteadySolver
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.record import Record
from vibeam.system.response import Ended, FrequencyResponse
from vibeam.system.state import State
from vibeam_models.arrays import Array

Watch = Callable[[SampledPiece], None]
BEYOND = 1e-9  # tolerance for a start beyond the stop, as a share of the contact displacement's size
NO_MARKS = np.empty(0)
EACH = 64  # calls between two readings of the clock, which costs about as much as an evaluation of a small system


class Stepper(SteadySolver):
    """Time-stepping solver: subclasses define ``run``; steady points and ``motion`` are built on it.

    Where scipy gives up, a point ends with Ended.NOT_FINITE.
    """

    records: ClassVar[bool] = False  #: whether it moves under a ``Record``, as its declaration says
    repeats: float  #: tolerance between states a period apart, as a share of the motion's size

    @abstractmethod
    def run(
        self, drive: Any, state: State, start: float, end: float, watch: Watch | None = None, marks: Array = NO_MARKS
    ) -> SteppedOutcome:
        """Run from ``start`` to ``end`` (s) under a ``Drive``, or a ``Record`` where the solver takes one.

        ``watch`` receives the motion in pieces, with a sample at all ``marks``. Without ``watch`` nothing is sampled.
        """

    def begin(self, state: State | None) -> State:
        """As ``SteadySolver.begin``; ValueError where its shape is wrong."""
        if state is None:
            return equilibrium(self.system)
        modal_values(self.system, state)
        return state

    def point(
        self, response: FrequencyResponse, index: int, drive: Drive, carried: State, settle: int, hold: int, output: str
    ) -> State:
        """As ``SteadySolver.point``: the last state, equilibrium where the point failed."""
        period = 2 * np.pi / drive.omega
        settled = self.run(drive, carried, 0.0, settle * period)
        reading = SampledReading(self.system, drive, output, hold, settled.state)
        outcomes = [settled]
        if settled.ended is Ended.COMPLETE:
            outcomes.append(self.run(drive, settled.state, 0.0, hold * period, reading.add, reading.marks))
        last = outcomes[-1]
        response.ended[index] = last.ended.code
        response.impacts[index] = sum(outcome.impacts for outcome in outcomes)
        response.evaluations[index] = sum(outcome.evaluations for outcome in outcomes)
        if last.ended is not Ended.COMPLETE:
            return equilibrium(self.system)
        reading.write(response, index, self.repeats)
        return last.state

    def record_motion(self, record: Record, state: State | None, t_start: float, t_end: float) -> SampledMotion:
        """Motion under a record, as ``motion``; ValueError of a solver that is made for one frequency."""
        if not self.records:
            raise ValueError(f"{type(self).__name__} cannot move under a record: flight, direct and moreau can")
        return self.motion(record, state, t_start, t_end)

    def motion(self, drive: Drive | Record, state: State | None, t_start: float, t_end: float) -> SampledMotion:
        """Motion from ``t_start`` to ``t_end`` (s) at the solver's own samples; ``state`` None: static equilibrium.

        ValueError for times that do not ascend or a state of the wrong shape.
        """
        if not (np.isfinite(t_start) and np.isfinite(t_end) and t_end > t_start >= 0):
            raise ValueError(f"times: t_end {t_end} must be finite and after t_start {t_start} ≥ 0")
        begun = time.thread_time()
        first = self.begin(state)
        pose = np.stack([first.displacement, first.velocity])[None]
        pieces = [SampledPiece(np.array([t_start]), pose, NO_MARKS, NO_MARKS)]
        outcome = self.run(drive, first, t_start, t_end, pieces.append)
        stats = {
            "impacts": outcome.impacts,
            "evaluations": outcome.evaluations,
            "cpu_seconds": time.thread_time() - begun,
        }
        return SampledMotion(
            self.system,
            drive,
            np.concatenate([piece.times for piece in pieces]),
            np.concatenate([piece.values for piece in pieces]),
            np.concatenate([piece.impact_times for piece in pieces]),
            np.concatenate([piece.impact_velocities for piece in pieces]),
            float(sum(piece.rest for piece in pieces)),
            outcome.time,
            outcome.state,
            outcome.ended,
            stats,
            merged(np.concatenate([piece.rests for piece in pieces])),
        )


def pause_at(call: int) -> None:
    """Pause at the first of every 64 calls, counted from 0."""
    if call % EACH == 0:
        pause()


def slack(system: ImpactSystem, displacement: Array) -> float:
    """Tolerance of the contact displacement beyond the gap that still counts as on the stop, m."""
    return BEYOND * (abs(system.gap) + float(np.abs(system.contact) @ np.abs(displacement)))


def onto_stop(system: ImpactSystem, displacement: Array) -> Array:
    """Displacement (n,), projected onto the stop by the shortest way where it lies beyond."""
    beyond = float(system.contact @ displacement) - system.gap
    return displacement - system.contact * (max(beyond, 0.0) / system.mobility)


def cycle(system: ImpactSystem, drive: Drive | Record) -> float:
    """Drive period in s, the slowest mode's without a drive."""
    rates = [drive.omega] if drive.omega > 0 else [*system.omega[system.omega > 0], np.inf]
    return float(2 * np.pi / min(rates)) if np.isfinite(min(rates)) else 1.0


class AdaptiveStepper(Stepper):
    """Base class of the solvers by scipy, whose steps follow tolerances."""

    METHODS: tuple[str, ...] = EXPLICIT
    LIMIT = 1000  #: of events or evaluations in a drive period
    REPEATS = 10  #: tolerance between states a period apart, in units of rtol

    def __init__(
        self,
        system: ImpactSystem,
        slowest: float,
        span: float = 0.0,
        *,
        method: str = "RK23",
        rtol: float = 1e-4,
        atol: float = 1e-8,
        limit: int | None = None,
        repeats: float | None = None,
    ) -> None:
        """``slowest`` and ``span`` are ignored.

        ``method``: scipy's name, one of ``METHODS``; "RK23" is the paper's (Matlab's ode23). ``rtol``: a step's; no
        step is longer than an eighth of the drive period.
        ``atol``: of the contact displacement, m; a mode's own is atol/√(Σ contact²), its velocity's ω times that. The
        default is the paper's for displacements near 10⁻²: keep it near 10⁻⁶ of the amplitude. Flights that rise less
        than it count as rest on the stop. ``limit``: events a drive period, None: ``LIMIT``. ``repeats``: how far
        states a period apart may differ, as a share of the motion's size; None: ``REPEATS`` rtol, at least 1e-5
        (settled runs repeat to about rtol). ValueError for others.
        """
        self.takes(system)
        limit = self.LIMIT if limit is None else limit
        self.system, self.settings = system, IntegrationSettings(chosen(method, self.METHODS), rtol, atol, limit)
        self.repeats = max(1e-5, self.REPEATS * rtol) if repeats is None else repeats

    @abstractmethod
    def takes(self, system: ImpactSystem) -> None:
        """Raise ValueError for a system that this solver cannot take."""
