"""Solver of motions under a record: every system as one of several contacts, whose kernels know loads."""

from __future__ import annotations

import time
from threading import local
from typing import Any

import numpy as np

from vibeam.flight.contacts.sets import FIRST, ContactSets
from vibeam.flight.contacts.solver import ContactsSolver
from vibeam.flight.event_driven import Segments, stats_of
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.contacts import course as load_layout
from vibeam.flight.kernels.contacts import layout as contact_layout
from vibeam.flight.kernels.contacts.course import course_of
from vibeam.flight.readout import OUTCOMES
from vibeam.flight.record.course import RecordCourse
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.record import Record
from vibeam.system.state import State
from vibeam_models.arrays import Array

SEGMENTS = 8  # of the longest, for whose intervals there is room
NO_INTERVALS = np.zeros((0, layout.PIECE_COLUMNS))
STILL = Drive(0.0, 0.0)  # the load is the record's


class _Own(local):
    """Sets of one thread; the course of the solver that was last at work in it, and the one that the sets are under."""

    sets: ContactSets | None = None
    solver: RecordSolver | None = None
    course: RecordCourse | None = None
    under: RecordCourse | None = None
    intervals: list[Array]


class RecordSolver(ContactsSolver):
    """One system and the record that it is under from ``start`` to ``end``, s.

    Between the points that are kept, events and every 256th piece of the record, the motion is made anew where it is
    asked for.
    """

    _first_rows = 4096
    _a_thread = _Own
    _own: _Own

    def __init__(self, system: ImpactSystem, record: Record, start: float, end: float, limit: int = 100_000) -> None:
        """``limit``: as of ``ContactsSolver``."""
        super().__init__(system, 0.0, end - start, limit)
        self._known = record, start, end

    def sibling(self, record: Record, start: float, end: float) -> RecordSolver:
        """The solver of the same system under another record of about the same span; both use the same sets."""
        found: RecordSolver = object.__new__(type(self))  # no copy, which would leave the sets behind
        vars(found).update(vars(self), _known=(record, start, end))
        return found

    @property
    def course(self) -> RecordCourse:
        """The record's course; many motions of one batch hold none, but make it anew where they are read."""
        own = self._own
        if own.course is None or own.solver is not self:
            own.solver, own.course = self, RecordCourse.of(*self._known)
        return own.course

    @property
    def sets(self) -> ContactSets:
        """The calling thread's sets, under this record's course."""
        own, course = self._own, self.course
        if own.sets is not None and own.under is course:
            return own.sets
        if own.sets is None:
            own.sets = ContactSets(self.contacts, self._slowest, self._top)
            load = course_of(course.pieces, course.lengths, course.peaks, FIRST, *self.contacts.rows.shape[::-1])
        else:
            load = own.sets.engine.course._replace(
                pieces=course.pieces, lengths=course.lengths, peaks=course.peaks, intervals=NO_INTERVALS
            )
        own.sets.engine, own.under = own.sets.engine._replace(course=load), course
        return own.sets

    def fly(self, state: State | None, limit: int, certify: bool) -> dict[str, Any]:
        """The fields of the trajectory from ``start`` to ``end``; its certificate where asked for."""
        begun, (record, start, end) = time.thread_time(), self._known
        pose, status = self.pose(state)
        status[contact_layout.PIECE], status[layout.CLOCK] = (float(part) for part in self.course.place(start))
        self._certify(certify)
        outcome, segments, counts = self._flown(STILL, pose, status, 0.0, end - start, limit, np.inf)
        trace = segments.trace
        trace[:, layout.START] = self.times_of(trace)
        last = end if outcome == layout.COMPLETE else float(trace[-1, layout.START] + trace[-1, layout.DURATION])
        found: dict[str, Any] = {
            "system": self.system, "drive": record, "t_start": start, "t_end": last, "state": self.state(pose, status),
            "ended": OUTCOMES[outcome], "stats": stats_of(counts, begun), "_solver": self, "segments": segments,
        }  # fmt: skip
        if certify:
            from vibeam.flight.record.certificate import certificate_of_record

            intervals = np.concatenate([NO_INTERVALS, *self._own.intervals])
            found["certificate"] = certificate_of_record(self.system, record, self.course, segments, intervals)
        return found

    def times_of(self, trace: Array) -> Array:
        """Times at which the segments begin, s: by the record's own knots, so that they do not drift."""
        return np.asarray(
            self.course.knots[trace[:, contact_layout.PIECE_AT].astype(np.int64)] + trace[:, layout.AT_CLOCK]
        )

    def _certify(self, asked: bool) -> None:
        course = self.sets.engine.course
        course.numbers[load_layout.CERTIFIED], course.numbers[load_layout.WRITTEN] = float(asked), 0.0
        most = 2 * len(self.contacts.gaps) * (load_layout.LONG + load_layout.STRIDE)
        room, self._own.intervals = np.zeros((SEGMENTS * most if asked else 0, layout.PIECE_COLUMNS)), []
        self.sets.engine = self.sets.engine._replace(course=course._replace(intervals=room))

    def _traced(self, before: int) -> None:
        """Keep the intervals written, of segments counted from ``before`` on; there is room for others then."""
        course = self.sets.engine.course
        found = course.intervals[: int(course.numbers[load_layout.WRITTEN])].copy()
        found[:, layout.PIECE_SEGMENT] += before
        self._own.intervals.append(found)
        course.numbers[load_layout.WRITTEN] = 0.0

    def _instant(self, time: float, pose: Array, status: Array, size: float) -> Segments:
        found = super()._instant(time, pose, status, size)
        found.trace[0, contact_layout.PIECE_AT] = status[contact_layout.PIECE]
        return found

    def poses_at(self, drive: Any, segments: Segments, times: Array) -> Array:
        """Modal displacements and velocities (m, 2, n) at times (m,) within the segments."""
        return super().poses_at(STILL, segments, times)
