"""The flight solver: exact closed form between events, certified first roots, impulses on all modes."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.compilation import announce
from vibeam.flight.equilibrium import equilibrium, size_of_motion
from vibeam.flight.kernels.entry import move, poses_at
from vibeam.flight.kernels.layout import (
    AT_CLOCK,
    CLOCK,
    COMPLETE,
    COUNT_ROWS,
    DURATION,
    EVERYTHING,
    FULL,
    IMPACTS,
    KIND,
    ORDER,
    PANELS,
    REACH_TOO,
    RESTING,
    RESULT_ROWS,
    SEGMENTS,
    SPEED,
    START,
    STATUS_ROWS,
    TRACE_COLUMNS,
    WHAT,
    Watch,
)
from vibeam.flight.linear.packing import PackedSystem, pack
from vibeam.flight.pause import unpaused
from vibeam.flight.readout import OUTCOMES, PointReadout
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Ended, FrequencyResponse
from vibeam.system.state import State
from vibeam_models.arguments import count, refuse

announce()


Array = NDArray[np.float64]

LONGEST_PERIOD = 16

MOST_IMPACTS = 10**9  # a drive period: with 10⁹ periods that still fits an int64

ROWS = 256  # segments traced before they are read off


@dataclass(frozen=True)
class Segments:
    """The segments of a motion, in the user's order of modes: trace rows (see ``kernels.layout``) and first poses."""

    trace: Array  # (m, TRACE_COLUMNS), START in s
    poses: Array  # (m, 2, n)
    size: float  # about the largest modal displacement, see ``start.size_of_motion``


def impact_limit(limit: object) -> int:
    """``limit`` as an int; ValueError where it is no whole number of impacts."""
    faults: list[str] = []
    found = count("limit", limit, faults, least=1, most=MOST_IMPACTS)
    refuse("solver", faults)
    return found


class FlightSolver:
    """One system, packed once for drives of ``slowest`` rad/s and more; its methods take a state and give one back."""

    def __init__(self, system: ImpactSystem, slowest: float, span: float = 0.0, limit: int = 100_000) -> None:
        """``limit``: impacts a drive period (or a call of ``simulate``) after which it gives up."""
        system.require_plain("the flight kernels")
        self.packed: PackedSystem = pack(system, slowest, span)
        self.system, self.limit = system, impact_limit(limit)

    def pose(self, state: State | None) -> tuple[Array, Array]:
        """The kernels' pose and status of a state; None: equilibrium. ValueError where its shape is wrong."""
        start = equilibrium(self.system) if state is None else state
        both = np.array([start.displacement, start.velocity], dtype=float)
        if both.shape != (2, self.system.size) or not np.all(np.isfinite(both)):
            raise ValueError(f"state: displacement and velocity must be {self.system.size} finite numbers each")
        status = np.zeros(STATUS_ROWS)
        status[KIND] = RESTING if start.resting else 0.0
        return self.packed.inward(both), status

    def state(self, pose: Array, status: Array) -> State:
        """The public state of a pose."""
        values = self.packed.outward(pose)
        return State.reached(values[0], values[1], bool(status[KIND] == RESTING))

    def simulate(
        self, drive: Drive, state: State | None, start: float, end: float, limit: int
    ) -> tuple[Ended, float, State, Segments, dict[str, float]]:
        """The motion from time ``start`` to ``end``: why it ended, when, its last state, all segments, stats."""
        begun = time.thread_time()
        pose, status = self.pose(state)
        status[CLOCK] = start
        size = size_of_motion(self.system, drive, self.packed.outward(pose))
        desk = self.packed.desk_for(size)
        rows, done, kept = ROWS, 0.0, []
        counts = np.zeros(COUNT_ROWS, dtype=np.int64)
        outcome, span = FULL, end - start
        while outcome == FULL:
            trace, poses = np.zeros((rows, TRACE_COLUMNS)), np.zeros((rows, 2, self.system.size))
            counts[SEGMENTS] = 0
            outcome, step = unpaused(
                move, desk, drive.omega, drive.amplitude, pose, status, float(span - done), 0, 0, limit,
                self._room(None, 0, trace, poses), counts, 0,
            )  # fmt: skip
            count = int(counts[SEGMENTS])
            trace[:count, START] += start + done
            kept.append(Segments(trace[:count], self.packed.outward(poses[:count]), size))
            done += step
            rows = min(2 * rows, 65536)
        segments = Segments(np.concatenate([s.trace for s in kept]), np.concatenate([s.poses for s in kept]), size)
        if not len(segments.trace):  # ended where it began: the start is all there is
            segments = self._instant(start, pose, status, size)
        stats = {
            "impacts": int(counts[IMPACTS]),
            "evaluations": int(counts[PANELS]),
            "cpu_seconds": time.thread_time() - begun,
        }
        last = end if outcome == COMPLETE else float(segments.trace[-1, START] + segments.trace[-1, DURATION])
        return OUTCOMES[outcome], last, self.state(pose, status), segments, stats

    def _instant(self, time: float, pose: Array, status: Array, size: float) -> Segments:
        """A segment without duration."""
        trace = np.zeros((1, TRACE_COLUMNS))
        trace[0, START], trace[0, AT_CLOCK], trace[0, WHAT] = time, status[CLOCK], status[KIND]
        return Segments(trace, self.packed.outward(pose[None]), size)

    def poses_at(self, drive: Drive, segments: Segments, times: Array) -> Array:
        """Modal displacements and velocities (m, 2, n) at times (m,) within the segments."""
        starts = segments.trace[:, START]
        which = np.maximum(np.searchsorted(starts, times, side="right") - 1, 0)
        out = np.empty((len(times), 2, self.system.size))
        poses_at(
            self.packed.desk_for(segments.size), drive.omega, drive.amplitude, segments.trace,
            self.packed.inward(segments.poses), which, times - starts[which], np.zeros((2, self.system.size)),
            np.zeros(STATUS_ROWS), out,
        )  # fmt: skip
        return self.packed.outward(out)

    def steady(
        self,
        omegas: Sequence[float] | Array,
        amplitude: float,
        state: State | None,
        settle: int,
        hold: int,
        output: str,
        reading: int = EVERYTHING,
        states: list[State] | None = None,
    ) -> tuple[FrequencyResponse, State]:
        """Steady points at ``omegas`` in turn, the state carried from each to the next; and the last state.

        ``reading``: how much is read off, see ``kernels.layout``; what is not is NaN. ``states``: a list to which the
        state after each point is added.
        """
        pose, status = self.pose(state)
        trace, poses = np.zeros((ROWS, TRACE_COLUMNS)), np.zeros((ROWS, 2, self.system.size))
        room, counts = self._room(output, hold, trace, poses, reading), np.zeros(COUNT_ROWS, dtype=np.int64)
        tally = PointReadout(len(omegas), self.system.size)
        desk, begun = self.packed.desk_for(np.inf), time.thread_time()
        for index, omega in enumerate(omegas):
            counts[:], status[ORDER], status[SPEED] = 0, 0.0, 0.0  # a point knows no more of the last than a State says
            outcome, period = unpaused(
                move, desk, float(omega), float(amplitude), pose, status, 0.0, settle, hold, self.limit, room, counts,
                LONGEST_PERIOD,
            )  # fmt: skip
            tally.note(index, outcome, int(period), room.result, room.energy, counts)
            if outcome != COMPLETE:
                pose, status = self.pose(None)
            if states is not None:
                states.append(self.state(pose, status))
            begun = tally.time(index, begun)
        return self._response(np.asarray(omegas, dtype=float), tally, hold, reading), self.state(pose, status)

    def rounds(
        self, omegas: Array, amplitudes: Array, states: Array, output: str, reading: int = EVERYTHING
    ) -> tuple[FrequencyResponse, Array]:
        """One drive period at each of ``omegas`` (points,) from a state (points, 2, n) of its own, all off the stop.

        And the states after it, (points, 2, n): where they are those before, the motion has the drive's period.
        """
        n = self.system.size
        after, status, tally = (
            self.packed.inward(states),
            np.zeros((len(omegas), STATUS_ROWS)),
            PointReadout(len(omegas), n),
        )
        trace, poses = np.zeros((ROWS, TRACE_COLUMNS)), np.zeros((ROWS, 2, n))
        room, counts = self._room(output, 1, trace, poses, reading), np.zeros(COUNT_ROWS, dtype=np.int64)
        desk, limit, begun = self.packed.desk_for(np.inf), self.limit, time.thread_time()
        for index, (omega, amplitude) in enumerate(zip(omegas.tolist(), amplitudes.tolist(), strict=True)):
            counts[:] = 0
            outcome, period = unpaused(
                move, desk, omega, amplitude, after[index], status[index], 0.0, 0, 1, limit, room, counts, 0
            )
            tally.note(index, outcome, int(period), room.result, room.energy, counts)
            begun = tally.time(index, begun)
        return self._response(omegas, tally, 1, reading), self.packed.outward(after)

    def _response(self, omegas: Array, tally: PointReadout, hold: int, reading: int) -> FrequencyResponse:
        """What was noted, in the user's order of modes; what was not read off is NaN."""
        response = tally.response(omegas, hold, self.system.gap)
        if reading < REACH_TOO:
            response.reach[:] = np.nan
        response.mode_energy[:] = self.packed.outward(response.mode_energy) if reading >= EVERYTHING else np.nan
        return response

    def _room(self, output: str | None, hold: int, trace: Array, poses: Array, reading: int = EVERYTHING) -> Watch:
        n = self.system.size
        row = self.packed.inward(self.system.contact if output is None else self.system.output(output))
        rest_row = np.ascontiguousarray((row @ self.packed.desk.from_blocks[:n]).reshape(-1, 2).T)
        nothing, strobes = np.zeros((0, TRACE_COLUMNS)), np.zeros((hold + 1, 2, n))
        scratch, frame = np.zeros((2, n)), np.zeros((2, n))
        result, energy, share = np.zeros(RESULT_ROWS), np.zeros(n), np.zeros(n + 1)
        return Watch(row, rest_row, nothing, trace, poses, strobes, scratch, frame, result, energy, share, reading)
