"""A certificate that no event was missed: every segment of a trajectory covered by intervals, each with its claim.

Written down are the segments as they started, to the bit: what each was in (flight, rest, push of a linear stop,
retreat from it), modal displacements and velocities, the drive's time, the order of the root with which one of the
signals watched may start (the gap after an impact: 1), what ended it; and pieces (segment, from, length, claim,
signal). ``watched`` says which signals those are. A piece that is ``OPEN`` claims that its signal is positive on (from,
from + length]; one that ``CLOSES`` that it is positive until the segment's end and passes zero there, once. An
accumulation that was completed by its limit has a line in ``tails``: bounds of what it still takes.

What is not proved is named in ``unproved``, with its time and reason: contact that is integrated (Hertz,
Hunt–Crossley), starts on a stop that is touched with no force beyond round-off, tails without a bound.

What the claims say can be checked without the solver, from the equations of ``ImpactSystem`` alone:
``tests/independent/check_certificate.py`` does so in interval arithmetic.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from vibeam.flight.event_driven import EventDrivenSolver, Segments
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.layout import CLOSES, OPEN, UNPROVED
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.proof.chatter_tail import tails_of
from vibeam.flight.proof.watched import WatchedMotion, motion_of, watch_list
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam_models.arguments import counted
from vibeam_models.arrays import Array, Flags, Index

PIECES_A_TASK = 8
SLIVER = 1e-10  # share of a segment's length: a piece so short that says that a signal closes is one with that before
__all__ = ["CLOSES", "OPEN", "UNPROVED", "Certificate", "UnprovedSpan", "certificate_of"]
_TOUCHING = "touches a stop, pushed or drawn away by no more than round-off"
_UNDECIDED = "no bound excludes another root"
_ENDLESS = "impacts without end (R → 1) are taken as rest from here on: left_out of the motion bounds the difference"
_UNBOUNDED = "what is left of the accumulation of impacts has no bound"


@dataclass(frozen=True)
class UnprovedSpan:
    """A part of a motion that is not proved: times in s, and why."""

    begin: float
    end: float
    reason: str


@dataclass(frozen=True, eq=False, repr=False)
class Certificate:
    """Segments and the pieces that cover them; SI units, times within a segment count from its start."""

    system: ImpactSystem
    drive: Drive
    times: Array  #: (segments,) when each begins
    kinds: Array  #: (segments,) 0 flight, 1 rest, 2 pushed by a stop that yields, 3 in its range but not pushed
    sides: Index  #: (segments,) the stop, 0 or 1: of a flight that ends with an impact the one that is hit
    ends: Array  #: (segments,) what ended it, see ``kernels.layout``
    starts: Array  #: (segments, 2, n) modal displacements and velocities
    clocks: Array  #: (segments,) drive time at the start, within one period
    durations: Array  #: (segments,)
    orders: Array  #: (segments,) order of the root with which a signal starts, 0 where all start positive
    roots: Array  #: (segments,) which signal that is, −1: none
    pieces: Array  #: (m, 5): segment, from, length, claim, signal: 0, 1 gaps, 2, 3 forces, 4 … 7 their negatives
    tails: Array  #: (k, 3): segment that ends with an accumulation, least and most time that it still takes

    def __repr__(self) -> str:
        said = "complete" if self.complete else f"{counted(len(self.unproved), 'span')} not proved"
        return f"{type(self).__name__}({counted(len(self.times), 'segment')}, {said})"

    @property
    def complete(self) -> bool:
        """True where the bounds prove all of the motion."""
        return not self.unproved

    @property
    def resting(self) -> Flags:
        """(segments,) whether it is a rest on a hard stop."""
        return np.asarray(self.kinds == layout.RESTING)

    @property
    def unproved(self) -> tuple[UnprovedSpan, ...]:
        """The spans that are not proved, in the order of time."""
        found = [*self._integrated(), *self._undecided(), *self._unbounded()]
        return tuple(sorted(found, key=lambda stretch: stretch.begin))

    def _integrated(self) -> list[UnprovedSpan]:
        law = self.system.contact_law
        which = np.flatnonzero((self.kinds == regime_layout.CONTACT) & (self.durations > 0))
        return self._spans_of(which, f'the law "{law.name}"') if law.integrated else []

    def _spans_of(self, which: Index, laws: str) -> list[UnprovedSpan]:
        """Spans of the segments ``which``, in contact that is integrated, those that follow each other as one."""
        first, last = np.diff(which, prepend=-2) > 1, np.diff(which, append=len(self.times) + 1) > 1
        begins, ends = self.times[which[first]], (self.times + self.durations)[which[last]]
        reason = f"contact by {laws} is integrated, to 1e-12 a step"
        return [UnprovedSpan(float(a), float(b), reason) for a, b in zip(begins, ends, strict=True)]

    def _undecided(self) -> list[UnprovedSpan]:
        open_yet = self.pieces[self.pieces[:, layout.CLAIM] == UNPROVED]
        found: list[UnprovedSpan] = []
        columns = [layout.PIECE_SEGMENT, layout.BEGIN, layout.LENGTH, layout.PIECE_SIGNAL]
        for segment, start, length, signal in open_yet[:, columns]:
            begin = float(self.times[int(segment)] + start)
            if found and begin <= found[-1].end:  # goes on with the same one
                found[-1] = replace(found[-1], end=max(begin + float(length), found[-1].end))
            else:
                touching = start == 0 and self.roots[int(segment)] != signal
                found.append(UnprovedSpan(begin, begin + float(length), _TOUCHING if touching else _UNDECIDED))
        return found

    def _unbounded(self) -> list[UnprovedSpan]:
        open_yet = self.tails[~np.isfinite(self.tails[:, 2])]
        ends = (self.times + self.durations)[open_yet[:, 0].astype(np.int64)]
        reasons = np.where(np.isinf(open_yet[:, 1]), _ENDLESS, _UNBOUNDED)
        return [UnprovedSpan(float(end), float(end), str(reason)) for end, reason in zip(ends, reasons, strict=True)]


def certificate_of(solver: EventDrivenSolver, drive: Drive, segments: Segments) -> Certificate:
    """The certificate of a motion that was flown."""
    motion = motion_of(solver.system, drive, segments.trace, segments.poses)
    tasks, trace = watch_list(motion), segments.trace
    orders, roots = np.zeros(len(trace)), np.full(len(trace), -1.0)
    starting = np.flatnonzero(tasks[:, layout.TASK_ORDER] > 0)
    which = tasks[starting, layout.TASK_SEGMENT].astype(np.int64)
    orders[which], roots[which] = tasks[starting, layout.TASK_ORDER], tasks[starting, layout.TASK_SIGNAL]
    return Certificate(
        solver.system, drive, trace[:, layout.START], motion.kinds, motion.sides, trace[:, layout.END], segments.poses,
        trace[:, layout.AT_CLOCK], trace[:, layout.DURATION], orders, roots,
        pieces_of(solver, motion, tasks, segments.size), tails_of(motion),
    )  # fmt: skip


def pieces_of(solver: EventDrivenSolver, motion: WatchedMotion, tasks: Array, size: float) -> Array:
    """The pieces (m, PIECE_COLUMNS) that cover all tasks."""
    found, first, a_task = list[Array](), 0, PIECES_A_TASK
    while first < len(tasks):
        rows = a_task * max(len(tasks) - first, 8)  # kept: what is not written costs nothing
        watch = np.empty((rows, layout.PIECE_COLUMNS))
        count, reached = solver.cover(motion.drive, motion.trace, motion.poses, size, tasks, first, watch)
        found.append(watch[:count])
        first, a_task = reached, 2 * a_task
    pieces = found[0] if len(found) == 1 else np.concatenate([np.empty((0, layout.PIECE_COLUMNS)), *found])
    return _without_slivers(pieces, motion.trace[:, layout.DURATION])


def _without_slivers(pieces: Array, durations: Array) -> Array:
    """The pieces, a last one that is a sliver joined to that before: where the panel ended on the root, to round-off.

    On which side of the panel's end the root lies, and whether the signal is positive there, doubles cannot say.
    """
    whole = durations[pieces[:, layout.PIECE_SEGMENT].astype(np.int64)]
    sliver = (pieces[:, layout.CLAIM] == CLOSES) & (pieces[:, layout.BEGIN] > 0)
    sliver &= pieces[:, layout.LENGTH] <= SLIVER * whole
    last = np.flatnonzero(sliver)
    before = last[pieces[last - 1, layout.CLAIM] == OPEN] - 1
    pieces[before, layout.CLAIM] = CLOSES
    pieces[before, layout.LENGTH] = whole[before] - pieces[before, layout.BEGIN]
    return np.delete(pieces, before + 1, axis=0) if len(before) else pieces
