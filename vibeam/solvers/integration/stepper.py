"""Base class of time-stepping solvers: steady points and motions from their ``run``."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.equilibrium import equilibrium
from vibeam.solvers.integration.samples import Motion, Outcome, Piece, Reading
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Ended, FrequencyResponse
from vibeam.system.state import State

Array = NDArray[np.float64]

Watch = Callable[[Piece], None]

BEYOND = 1e-9  # tolerance for a start beyond the stop, as a share of the contact displacement's size

NO_MARKS = np.empty(0)


class Stepper(ABC):
    """Time-stepping solver: subclasses define ``run``; ``steady`` and ``motion`` are built on it."""

    system: ImpactSystem
    repeats: float  #: tolerance between states a period apart, as a share of the motion's size

    @abstractmethod
    def run(
        self, drive: Drive, state: State, start: float, end: float, watch: Watch | None = None, marks: Array = NO_MARKS
    ) -> Outcome:
        """Run from ``start`` to ``end`` (s); ``watch`` receives the motion in pieces, with a sample at all ``marks``.

        Without ``watch`` nothing is sampled.
        """

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

        The state is carried from each to the next. Where scipy gives up, the point ends with Ended.NOT_FINITE.
        """
        response = FrequencyResponse.empty(np.asarray(omegas, dtype=float) / (2 * np.pi), self.system.size)
        state = first_state(self.system, state)
        for i, omega in enumerate(omegas):
            begun = time.thread_time()
            state = steady_point(self, Drive(float(omega), amplitude), state, settle, hold, output, response, i)
            response.cpu_seconds[i] = time.thread_time() - begun
        return response, state

    def motion(self, drive: Drive, state: State | None, t_start: float, t_end: float) -> Motion:
        """Motion from ``t_start`` to ``t_end`` (s) at the solver's own samples; ``state`` None: static equilibrium.

        ValueError for times that do not ascend or a state of the wrong shape.
        """
        return sampled_motion(self, drive, state, t_start, t_end)


def steady_point(
    solver: Stepper,
    drive: Drive,
    state: State,
    settle: int,
    hold: int,
    output: str,
    response: FrequencyResponse,
    i: int,
) -> State:
    """Compute point ``i`` from ``state``; return the state after it, equilibrium where it failed."""
    period = 2 * np.pi / drive.omega
    settled = solver.run(drive, state, 0.0, settle * period)
    reading = Reading(solver.system, drive, output, hold, settled.state)
    outcomes = [settled]
    if settled.ended is Ended.COMPLETE:
        outcomes.append(solver.run(drive, settled.state, 0.0, hold * period, reading.add, reading.marks))
    last = outcomes[-1]
    response.ended[i] = last.ended.code
    response.impacts[i] = sum(outcome.impacts for outcome in outcomes)
    response.evaluations[i] = sum(outcome.evaluations for outcome in outcomes)
    if last.ended is not Ended.COMPLETE:
        return equilibrium(solver.system)
    reading.write(response, i, solver.repeats)
    return last.state


def sampled_motion(solver: Stepper, drive: Drive, state: State | None, start: float, end: float) -> Motion:
    """See ``Stepper.motion``."""
    if not (np.isfinite(start) and np.isfinite(end) and end > start >= 0):
        raise ValueError(f"times: t_end {end} must be finite and after t_start {start} ≥ 0")
    begun = time.thread_time()
    first = first_state(solver.system, state)
    pose = np.stack([first.displacement, first.velocity])[None]
    pieces = [Piece(np.array([start]), pose, NO_MARKS, NO_MARKS)]
    outcome = solver.run(drive, first, start, end, pieces.append)
    stats = {
        "impacts": outcome.impacts,
        "evaluations": outcome.evaluations,
        "cpu_seconds": time.thread_time() - begun,
    }
    return Motion(
        solver.system,
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
    )


def first_state(system: ImpactSystem, state: State | None) -> State:
    """Initial state, static equilibrium for None; ValueError where its shape is wrong."""
    if state is None:
        return equilibrium(system)
    both = [np.asarray(row, dtype=float) for row in (state.displacement, state.velocity)]
    if any(row.shape != (system.size,) or not np.all(np.isfinite(row)) for row in both):
        raise ValueError(f"state: displacement and velocity must be {system.size} finite numbers each")
    return State(both[0], both[1], state.resting)


def slack(system: ImpactSystem, displacement: Array) -> float:
    """Tolerance of the contact displacement beyond the gap that still counts as on the stop, m."""
    return BEYOND * (abs(system.gap) + float(np.abs(system.contact) @ np.abs(displacement)))


def onto_stop(system: ImpactSystem, displacement: Array) -> Array:
    """Displacement (n,), projected onto the stop by the shortest way where it lies beyond."""
    beyond = float(system.contact @ displacement) - system.gap
    return displacement - system.contact * (max(beyond, 0.0) / float(system.contact @ system.contact))


def cycle(system: ImpactSystem, drive: Drive) -> float:
    """Drive period in s, the slowest mode's without a drive."""
    rates = [drive.omega] if drive.omega > 0 else [*system.omega[system.omega > 0], np.inf]
    return float(2 * np.pi / min(rates)) if np.isfinite(min(rates)) else 1.0
