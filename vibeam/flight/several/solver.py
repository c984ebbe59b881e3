"""Solver of systems with contacts in several places, with the calls of the others."""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np

from vibeam.flight.engine.threads import pause
from vibeam.flight.equilibrium import Contacts, equilibrium, size_of_motion
from vibeam.flight.event_driven import LONGEST_PERIOD, Segments, impact_limit, modal_values
from vibeam.flight.kernels import layout
from vibeam.flight.linear.packing import slowest_rate
from vibeam.flight.readout import OUTCOMES, PointReadout
from vibeam.flight.several.motion import COLUMNS, ContactFlights, ContactMotion
from vibeam.flight.several.readout import PointReader, held_in, repetition
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Ended, FrequencyResponse
from vibeam.system.state import State
from vibeam_models.arrays import Array


class ContactsSolver:
    """One system with contacts in several places; its methods take a state and give one back.

    Flights, holds and their first roots are the closed forms of ``RegimeSolver``, between them is Python. Impacts in
    one instant follow ``several.impact``. ``FrequencyResponse.rest`` is the share of time in which any contact is held.
    """

    def __init__(self, system: ImpactSystem, slowest: float, span: float = 0.0, limit: int = 100_000) -> None:
        """``limit``: impacts a drive period (or a call of ``simulate``) after which it gives up."""
        self.system, self.limit = system, impact_limit(limit)
        self.contacts = Contacts.of(system)
        self.flights = ContactFlights(self.contacts, slowest_rate(system, slowest, span))

    def simulate(
        self, drive: Drive, state: State | None, start: float, end: float, limit: int
    ) -> tuple[Ended, float, State, Segments, dict[str, float]]:
        """The motion from time ``start`` to ``end``: why it ended, when, its last state, all segments, stats."""
        begun, pose = time.thread_time(), self._pose(state)
        size = size_of_motion(self.system, drive, pose)
        self.flights.for_size(size)
        clock = start % (2 * np.pi / drive.omega) if drive.omega > 0 else start
        motion, outcome = self.flights.begin(drive, pose, clock)
        done = 0.0
        if outcome == layout.COMPLETE:
            outcome, done = self.flights.advance(drive, motion, end - start, limit)
        segments = _packed(motion, start, size)
        stats = {"impacts": motion.impacts, "evaluations": motion.panels, "cpu_seconds": time.thread_time() - begun}
        last = end if outcome == layout.COMPLETE else start + done
        return OUTCOMES[outcome], last, _state(motion), segments, stats

    def _pose(self, state: State | None) -> Array:
        return modal_values(self.system, equilibrium(self.system) if state is None else state)

    def poses_at(self, drive: Drive, segments: Segments, times: Array) -> Array:
        """Modal displacements and velocities (m, 2, n) at times (m,) within the segments."""
        self.flights.for_size(segments.size)
        starts = segments.trace[:, layout.START]
        which = np.maximum(np.searchsorted(starts, times, side="right") - 1, 0)
        out = np.empty((len(times), 2, self.system.size))
        for segment in np.unique(which):
            here, row = which == segment, segments.trace[segment]
            out[here] = self._within(drive, row, segments.poses[segment], times[here] - row[layout.START])
        return out

    def _within(self, drive: Drive, row: Array, pose: Array, after: Array) -> Array:
        """Poses times ``after`` into a segment."""
        regime = self.flights.regime(held_in(row, len(self.contacts.gaps)))
        found = regime.poses(drive.omega, drive.amplitude, regime.inward(pose), float(row[layout.AT_CLOCK]), after)
        out = regime.outward(found)
        out[after <= 0] = pose
        return out

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
        """Steady points at ``omegas`` in turn, the state carried from each to the next; and the last state.

        As ``EventDrivenSolver.steady``.
        """
        if self.system.derivative(output) is not None:
            raise ValueError(f"output {output!r}: with several contacts a sweep reads displacements alone")
        pose, row = self._pose(state), self.system.output(output)
        readout, after = PointReadout(len(omegas), self.system.size), list[State]()
        self.flights.for_size(np.inf)
        begun = time.thread_time()
        for index, (omega, size) in enumerate(zip(omegas, np.broadcast_to(amplitude, len(omegas)), strict=True)):
            reader = PointReader(self.flights, Drive(float(omega), float(size)), row, reading)
            motion, outcome, period, passed = self._point(reader, pose, settle, hold)
            counts = np.zeros(layout.COUNT_ROWS, dtype=np.int64)
            counts[layout.IMPACTS], counts[layout.PANELS] = motion.impacts, motion.panels
            readout.note(index, outcome, period, reader.result, reader.energy, counts)
            after.append(_state(motion) if outcome == layout.COMPLETE else equilibrium(self.system))
            pose = self._pose(after[-1])
            if strobes is not None:
                strobes.append(passed)
            begun = readout.time(index, begun)
        if states is not None:
            states.extend(after)
        return readout.response(np.asarray(omegas, dtype=float), hold, self.system.gap, reading), after[-1]

    def _point(self, reader: PointReader, pose: Array, settle: int, hold: int) -> tuple[ContactMotion, int, int, Array]:
        """Settle and watch: the motion at the end, the outcome, the period, the states at the ends of periods."""
        drive = reader.drive
        motion, outcome = self.flights.begin(drive, pose, 0.0)
        turn = 2 * np.pi / drive.omega
        strobes = [motion.pose]
        for period in range(settle + hold):
            pause()
            if outcome != layout.COMPLETE:
                return motion, outcome, 0, np.array(strobes)
            motion.segments, motion.clock = [], 0.0
            outcome, _ = self.flights.advance(drive, motion, turn, self.limit)
            if period >= settle and outcome == layout.COMPLETE:
                outcome = reader.note(motion, strobes)
            if period + 1 == settle:
                strobes = [motion.pose]
            elif period >= settle:
                strobes.append(motion.pose)
        passed = np.array(strobes)
        return motion, outcome, repetition(self.system.omega, drive.omega, passed, LONGEST_PERIOD), passed


def _state(motion: ContactMotion) -> State:
    return State.reached(motion.pose[0].copy(), motion.pose[1].copy(), bool(motion.state.held))


def _packed(motion: ContactMotion, start: float, size: float) -> Segments:
    """The segments traced; a motion that ended where it began is one without duration."""
    if not motion.segments:
        row = np.zeros((1, COLUMNS))
        row[0, layout.START], row[0, layout.AT_CLOCK] = start, motion.clock
        return Segments(row, motion.pose[None].copy(), size)
    trace = np.array([each.row for each in motion.segments])
    trace[:, layout.START] += start
    return Segments(trace, np.array([each.pose for each in motion.segments]), size)
