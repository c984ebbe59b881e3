"""Exact event-driven solvers: what those of plain systems and of any regime and contact law have in common."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from vibeam.flight.engine.threads import pause, unpaused
from vibeam.flight.equilibrium import equilibrium, size_of_motion
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.layout import Regime, watch_of
from vibeam.flight.linear.block_regime import set_output
from vibeam.flight.readout import OUTCOMES, PointReadout
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Ended, FrequencyResponse
from vibeam.system.state import State
from vibeam_models.arguments import count, counted, refuse
from vibeam_models.arrays import Array, Index

LONGEST_PERIOD = 16
MOST_IMPACTS = 10**9  # a drive period: with 10⁹ periods that still fits an int64
POSES = 2_000_000  # made at once, over the square of modes and a few: in integrated contact they take a second
LONG_LOOK = 50_000_000  # panels, times modes and a few, of one call, after which the next one has fewer segments
ROWS = 256  # segments traced before they are read off


@dataclass(frozen=True)
class Segments:
    """The segments of a motion, in the user's order of modes: trace rows (see ``kernels.layout``) and first poses."""

    trace: Array  # (m, TRACE_COLUMNS), START in s
    poses: Array  # (m, 2, n)
    size: float  # about the largest modal displacement, see ``equilibrium.size_of_motion``


def modal_values(system: ImpactSystem, state: State) -> Array:
    """Displacement and velocity (2, n) of a state. ValueError where its shape is wrong."""
    both = np.array([state.displacement, state.velocity], dtype=float)
    if both.shape != (2, system.size) or not np.isfinite(both).all():
        raise ValueError(f"state: displacement and velocity must be {counted(system.size, 'finite number')} each")
    return both


def stats_of(counts: Index, begun: float) -> dict[str, float]:
    """Stats of a motion whose flight has begun at that CPU time."""
    impacts, evaluations = int(counts[layout.IMPACTS]), int(counts[layout.PANELS])
    return {"impacts": impacts, "evaluations": evaluations, "cpu_seconds": time.thread_time() - begun}


class EventDrivenSolver(ABC):
    """One system, made ready once; its methods take a state and give one back.

    An engine is the kernels' arrays, ``_move``, ``_poses_at`` and ``_cover`` their entry points.
    """

    _move: ClassVar[Callable[..., tuple[int, float]]]
    _poses_at: ClassVar[Callable[..., None]]
    _cover: ClassVar[Callable[..., tuple[int, int]]]
    _status_rows: int = layout.STATUS_ROWS
    _trace_columns: int = layout.TRACE_COLUMNS
    _first_rows: ClassVar[int] = ROWS

    def __init__(self, system: ImpactSystem, limit: int) -> None:
        """``limit``: impacts a drive period (or a call of ``simulate``) after which it gives up."""
        faults: list[str] = []
        self.system, self.limit = system, count("limit", limit, faults, least=1, most=MOST_IMPACTS)
        refuse("solver", faults)

    @abstractmethod
    def _engine_for(self, size: float) -> Any:
        """The calling thread's arrays, for modal displacements of about ``size``; inf where that is not known."""

    @abstractmethod
    def _regimes(self) -> Sequence[Regime]:
        """Those of the calling thread's regimes that have an output."""

    def _reader(self, output: str) -> EventDrivenSolver:
        """The solver that reads an output: another one where these kernels do not."""
        return self

    def _still_pose(self) -> tuple[Array, Array]:
        """Pose and status of the equilibrium, a copy."""
        return self.pose(equilibrium(self.system))

    def _inward(self, values: Array) -> Array:
        """Values (…, n) of the user's modes in the kernels' order, a copy."""
        return np.array(values, dtype=float, order="C")

    def _outward(self, values: Array) -> Array:
        """Values (…, n) in the kernels' order as the user's modes, a copy."""
        return np.array(values)

    def _restart(self, pose: Array, status: Array, kind: float) -> None:
        """Set ``status`` as at the start from a state, ``kind`` RESTING or FREE."""
        status.fill(0.0)
        status[layout.KIND] = kind

    def pose(self, state: State | None) -> tuple[Array, Array]:
        """The kernels' pose and status of a state; None: equilibrium. ValueError where its shape is wrong."""
        if state is None:
            return self._still_pose()
        pose, status = self._inward(modal_values(self.system, state)), np.empty(self._status_rows)
        self._restart(pose, status, layout.RESTING if state.resting else layout.FREE)
        return pose, status

    def state(self, pose: Array, status: Array) -> State:
        """The public state of a pose."""
        values = self._outward(pose)
        return State.reached(values[0], values[1], float(status[layout.KIND]) == layout.RESTING)

    def simulate(
        self, drive: Drive, state: State | None, start: float, end: float, limit: int
    ) -> tuple[Ended, float, State, Segments, dict[str, float]]:
        """The motion from time ``start`` to ``end``: why it ended, when, its last state, all segments, stats.

        Where modes that are far from a small motion (``size_of_motion``) take too many panels, it is flown anew with
        their steady response taken out.
        """
        begun = time.thread_time()
        pose, status = self.pose(state)
        status[layout.CLOCK] = start
        size = size_of_motion(self.system, drive, self._outward(pose))
        first = pose.copy(), status.copy()
        outcome, segments, counts = self._flown(drive, pose, status, start, end, limit, size)
        if outcome == layout.UNRESOLVED and size < np.inf and self._carries():
            pose, status = first
            outcome, segments, counts = self._flown(drive, pose, status, start, end, limit, np.inf)
        last = float(segments.trace[-1, layout.START] + segments.trace[-1, layout.DURATION])
        last = end if outcome == layout.COMPLETE else last
        return OUTCOMES[outcome], last, self.state(pose, status), segments, stats_of(counts, begun)

    def _carries(self) -> bool:
        """True where the last motion carried modes along without their steady response."""
        return any(bool(regime.blocks[layout.CARRIED].any()) for regime in self._regimes())

    def _flown(
        self, drive: Drive, pose: Array, status: Array, start: float, end: float, limit: int, size: float
    ) -> tuple[int, Segments, Index]:
        """Carry ``pose`` and ``status`` on to time ``end``: outcome, segments, counts."""
        engine, span = self._engine_for(size), end - start
        rows, done, kept = self._first_rows, 0.0, list[Segments]()
        counts = np.zeros(layout.COUNT_ROWS, dtype=np.int64)
        outcome = layout.FULL
        while outcome == layout.FULL and done < span:
            trace, poses = np.zeros((rows, self._trace_columns)), np.zeros((rows, 2, self.system.size))
            counts[layout.SEGMENTS], before = 0, int(counts[layout.PANELS])
            outcome, step = unpaused(
                self._move, engine, drive.omega, drive.amplitude, pose, status, float(span - done), 0, 0, limit,
                watch_of(self._watch(None), 0, trace, poses), counts, 0,
            )  # fmt: skip
            count = int(counts[layout.SEGMENTS])
            trace[:count, layout.START] += start + done
            self._traced(sum(len(part.trace) for part in kept))
            kept.append(Segments(trace[:count].copy(), self._outward(poses[:count]), size))
            done += step
            looked = (int(counts[layout.PANELS]) - before) * (self.system.size + 8)
            rows = min(2 * rows, 65536) if looked < LONG_LOOK else max(rows // 2, 1)
        if not any(len(part.trace) for part in kept):  # ended where it began: the start is all there is
            kept = [self._instant(start, pose, status, size)]
        segments = Segments(np.concatenate([s.trace for s in kept]), np.concatenate([s.poses for s in kept]), size)
        return layout.COMPLETE if outcome == layout.FULL else outcome, segments, counts

    def _traced(self, before: int) -> None:  # noqa: B027
        """A part of the trace, with so many segments before it, is there."""

    def _instant(self, time: float, pose: Array, status: Array, size: float) -> Segments:
        """A segment without duration."""
        trace = np.zeros((1, self._trace_columns))
        trace[0, [layout.START, layout.AT_CLOCK, layout.WHAT]] = time, status[layout.CLOCK], status[layout.KIND]
        return Segments(trace, self._outward(pose[None]), size)

    def poses_at(self, drive: Drive, segments: Segments, times: Array) -> Array:
        """Modal displacements and velocities (m, 2, n) at times (m,) within the segments."""
        starts = segments.trace[:, layout.START]
        which = np.maximum(np.searchsorted(starts, times, side="right") - 1, 0)
        out = np.empty((len(times), 2, self.system.size))
        kept = self._engine_for(segments.size), drive.omega, drive.amplitude, segments.trace
        poses, after = self._inward(segments.poses), times - starts[which]
        step = 1 + POSES // (self.system.size + 8) ** 2
        for part in (slice(first, first + step) for first in range(0, len(times), step)):
            pause()
            self._poses_at(*kept, poses, which[part], after[part], *self._scratch(), out[part])
        return self._outward(out)

    def cover(
        self, drive: Drive, trace: Array, poses: Array, size: float, tasks: Array, first: int, pieces: Array
    ) -> tuple[int, int]:
        """Fill ``pieces`` from task ``first`` on, see ``kernels.entry``: pieces written, first task without room."""
        return self._cover(
            self._engine_for(size), drive.omega, drive.amplitude, trace, self._inward(poses), tasks, first, pieces
        )

    def _scratch(self) -> tuple[Array, ...]:
        """Room for a pose, and what else ``_poses_at`` needs."""
        return (np.zeros((2, self.system.size)),)

    def steady(
        self,
        omegas: Sequence[float] | Array,
        amplitude: float | Array,
        state: State | Sequence[State] | None,
        settle: int,
        hold: int,
        output: str,
        reading: int = layout.EVERYTHING,
        states: list[State] | None = None,
        strobes: list[Array] | None = None,
    ) -> tuple[FrequencyResponse, State]:
        """Steady points at ``omegas`` in turn, the state carried from each to the next; and the last state.

        ``state``: of the start; with one for each point they are flown apart, and nothing is carried.
        ``amplitude``: of the base, m, one for all or one each. ``reading``: how much is read off, see
        ``kernels.layout``; what is not is NaN. ``states``: a list to which the state after each point is added;
        ``strobes``: its states (hold + 1, 2, n) at the ends of the periods, from the end of the settling on.
        """
        if (reader := self._reader(output)) is not self:
            return reader.steady(omegas, amplitude, state, settle, hold, output, reading, states, strobes)
        starts = () if state is None or isinstance(state, State) else state
        pose, status = self.pose(state if isinstance(state, State) else None)
        trace, poses = np.zeros((ROWS, self._trace_columns)), np.zeros((ROWS, 2, self.system.size))
        watch = watch_of(self._watch(output), hold, trace, poses, reading)
        counts = np.zeros(layout.COUNT_ROWS, dtype=np.int64)
        readout = PointReadout(len(omegas), self.system.size)
        engine, begun = self._engine_for(np.inf), time.thread_time()
        drives = [amplitude] * len(omegas) if isinstance(amplitude, float) else np.broadcast_to(amplitude, len(omegas))
        for index, (omega, drive) in enumerate(zip(omegas, drives, strict=True)):
            counts[:] = 0  # a point knows no more of the last than a State says
            if starts:
                pose[:], status[:] = self.pose(starts[index])
            self._restart(pose, status, layout.RESTING if status[layout.KIND] == layout.RESTING else layout.FREE)
            outcome, period = unpaused(
                self._move, engine, float(omega), float(drive), pose, status, 0.0, settle, hold, self.limit, watch,
                counts, LONGEST_PERIOD,
            )  # fmt: skip
            readout.note(index, outcome, int(period), watch.result, watch.energy, counts)
            if outcome != layout.COMPLETE:
                pose, status = self.pose(None)
            if states is not None:
                states.append(self.state(pose, status))
            if strobes is not None:
                strobes.append(self._outward(watch.strobes))
            begun = readout.time(index, begun)
        last = states[-1] if states else self.state(pose, status)
        response = readout.response(np.asarray(omegas, dtype=float), hold, self.system.gap, reading)
        response.mode_energy[:] = self._outward(response.mode_energy)
        return response, last

    def _watch(self, output: str | None) -> Array:
        """Set the signal of an output (None: the contact) in every regime; its row in the kernels' order of modes."""
        row = self._inward(self.system.contact if output is None else self.system.output(output))
        for regime in self._regimes():
            set_output(regime, row)
        return row
