"""The solver of systems with more than one coefficient of restitution and modes by themselves: the same calls."""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.equilibrium import equilibrium, size_of_motion
from vibeam.flight.kernels.layout import (
    AT_CLOCK,
    CLOCK,
    COMPLETE,
    COUNT_ROWS,
    DURATION,
    FULL,
    IMPACTS,
    KIND,
    MOTION,
    ORDER,
    PANELS,
    RESTING,
    RESULT_ROWS,
    SEGMENTS,
    START,
    WHAT,
)
from vibeam.flight.kernels.regimes.entry import move, poses_at
from vibeam.flight.kernels.regimes.layout import (
    OUTPUT,
    SIDE,
    STATUS_ROWS,
    TRACE_COLUMNS,
    UNKNOWN,
    Regime,
    RegimeEngine,
    RegimeWatch,
)
from vibeam.flight.linear.packing import slowest_rate
from vibeam.flight.linear.regimes import SignalRow, plan, signals
from vibeam.flight.pause import unpaused
from vibeam.flight.per_thread import PerThread
from vibeam.flight.readout import OUTCOMES, PointReadout
from vibeam.flight.solver import Segments, impact_limit
from vibeam.observe.periodicity import repetition
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Ended, FrequencyResponse
from vibeam.system.state import State

Array = NDArray[np.float64]

ROWS = 256  # segments traced before they are read off

REPEATS = 1e-5  # share of the motion's size by which states one period apart may differ


class RegimeSolver:
    """One system, made ready once for drives of ``slowest`` rad/s and more; takes a state and gives one back.

    What it finds is exact between events as in ``FlightSolver``; a stop that is not linear is integrated while it is
    touched, to 1e-12 a step. ``FrequencyResponse.rest`` is the share of time in contact, resting or pushed.
    """

    def __init__(self, system: ImpactSystem, slowest: float, span: float = 0.0, limit: int = 100_000) -> None:
        """``limit``: impacts a drive period (or a call of ``simulate``) after which it gives up."""
        self.system, self.limit = system, impact_limit(limit)
        self._plans = PerThread(plan(system, slowest_rate(system, slowest, span)))

    @property
    def plan(self) -> RegimeEngine:
        """The calling thread's arrays."""
        return self._plans.own()

    def _plan_for(self, size: float) -> RegimeEngine:
        """The same, for a motion with modal displacements of about ``size``; inf where that is not known."""
        own = self.plan
        own.drive[MOTION] = size
        return own

    def pose(self, state: State | None) -> tuple[Array, Array]:
        """The kernels' pose and status of a state; None: equilibrium. ValueError where its shape is wrong."""
        start = equilibrium(self.system) if state is None else state
        both = np.array([start.displacement, start.velocity], dtype=float)
        if both.shape != (2, self.system.size) or not np.all(np.isfinite(both)):
            raise ValueError(f"state: displacement and velocity must be {self.system.size} finite numbers each")
        status = np.zeros(STATUS_ROWS)
        status[KIND], status[ORDER] = RESTING if start.resting else 0.0, UNKNOWN
        status[SIDE] = self._nearer(both[0])
        return np.ascontiguousarray(both), status

    def _nearer(self, displacement: Array) -> int:
        """The stop that is nearer."""
        place, second = float(self.system.contact @ displacement), self.system.second_gap
        return int(second is not None and place + second < self.system.gap - place)

    def simulate(
        self, drive: Drive, state: State | None, start: float, end: float, limit: int
    ) -> tuple[Ended, float, State, Segments, dict[str, float]]:
        """As ``FlightSolver.simulate``."""
        begun = time.thread_time()
        pose, status = self.pose(state)
        status[CLOCK] = self._clock(drive, start)
        size = size_of_motion(self.system, drive, pose)
        own = self._plan_for(size)
        rows, done, kept = ROWS, 0.0, []
        counts = np.zeros(COUNT_ROWS, dtype=np.int64)
        outcome, span = FULL, end - start
        while outcome == FULL:
            trace, poses = np.zeros((rows, TRACE_COLUMNS)), np.zeros((rows, 2, self.system.size))
            counts[SEGMENTS] = 0
            left = max(float(span - done), 5e-324) if done > 0 else float(span)
            outcome, step = unpaused(
                move, own, drive.omega, drive.amplitude, pose, status, left, 0, 0, limit,
                self._room(None, 0, trace, poses), counts,
            )  # fmt: skip
            count = int(counts[SEGMENTS])
            trace[:count, START] += start + done
            kept.append(Segments(trace[:count], poses[:count], size))
            done += step
            rows = min(2 * rows, 65536)
        segments = Segments(np.concatenate([s.trace for s in kept]), np.concatenate([s.poses for s in kept]), size)
        if not len(segments.trace):
            segments = self._instant(start, pose, status, size)
        stats = {
            "impacts": int(counts[IMPACTS]),
            "evaluations": int(counts[PANELS]),
            "cpu_seconds": time.thread_time() - begun,
        }
        last = end if outcome == COMPLETE else float(segments.trace[-1, START] + segments.trace[-1, DURATION])
        return OUTCOMES[outcome], last, self._state(pose, status), segments, stats

    @staticmethod
    def _clock(drive: Drive, start: float) -> float:
        return float(np.fmod(start, 2 * np.pi / drive.omega)) if drive.omega > 0 else start

    def _instant(self, time: float, pose: Array, status: Array, size: float) -> Segments:
        """A segment without duration."""
        trace = np.zeros((1, TRACE_COLUMNS))
        trace[0, START], trace[0, AT_CLOCK], trace[0, WHAT] = time, status[CLOCK], status[KIND]
        return Segments(trace, pose[None].copy(), size)

    @staticmethod
    def _state(pose: Array, status: Array) -> State:
        return State.reached(pose[0].copy(), pose[1].copy(), bool(status[KIND] == RESTING))

    def poses_at(self, drive: Drive, segments: Segments, times: Array) -> Array:
        """Modal displacements and velocities (m, 2, n) at times (m,) within the segments."""
        starts = segments.trace[:, START]
        which = np.maximum(np.searchsorted(starts, times, side="right") - 1, 0)
        out = np.empty((len(times), 2, self.system.size))
        poses_at(
            self._plan_for(segments.size), drive.omega, drive.amplitude, segments.trace, segments.poses, which,
            times - starts[which], np.zeros((2, self.system.size)), out,
        )  # fmt: skip
        return out

    def steady(
        self,
        omegas: Sequence[float] | Array,
        amplitude: float,
        state: State | None,
        settle: int,
        hold: int,
        output: str,
    ) -> tuple[FrequencyResponse, State]:
        """Steady points at ``omegas`` in turn, the state carried from each to the next; and the last state."""
        pose, status = self.pose(state)
        n = self.system.size
        own, tally, begun = self._plan_for(np.inf), PointReadout(len(omegas), n), time.thread_time()
        trace, poses = np.zeros((ROWS, TRACE_COLUMNS)), np.zeros((ROWS, 2, n))
        room, counts = self._room(output, hold, trace, poses), np.zeros(COUNT_ROWS, dtype=np.int64)
        for index, omega in enumerate(omegas):
            room.result[:], room.energy[:], counts[:] = 0.0, 0.0, 0
            pose, status = self.pose(self._state(pose, status))  # a point knows what a State says, no more
            outcome, _ = unpaused(
                move, own, float(omega), float(amplitude), pose, status, 0.0, settle, hold, self.limit, room, counts
            )
            period = repetition(room.strobes, self.system.omega, float(omega), REPEATS)
            tally.note(index, outcome, period, room.result, room.energy, counts)
            if outcome != COMPLETE:
                pose, status = self.pose(None)
            begun = tally.time(index, begun)
        return tally.response(np.asarray(omegas, dtype=float), hold, self.system.gap), self._state(pose, status)

    def _room(self, output: str | None, hold: int, trace: Array, poses: Array) -> RegimeWatch:
        n = self.system.size
        row = np.array(self.system.contact if output is None else self.system.output(output), dtype=float)
        own = self.plan
        for regime in (own.free, own.upper, own.lower):
            self._show(regime, row)
        nothing, strobes = np.zeros((0, TRACE_COLUMNS)), np.zeros((hold + 1, 2, n))
        scratch, frame = np.zeros((2, n)), np.zeros((2, n))
        return RegimeWatch(row, nothing, trace, poses, strobes, frame, scratch, np.zeros(RESULT_ROWS), np.zeros(n))

    @staticmethod
    def _show(regime: Regime, row: Array) -> None:
        regime.signals[OUTPUT] = signals([SignalRow(row, np.zeros_like(row))], regime.outof, regime.held)[0]
