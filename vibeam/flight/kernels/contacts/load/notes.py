"""Notes of a walk under a load: the largest push so far, and the intervals of a certificate."""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.contacts import course as row
from vibeam.flight.kernels.contacts import layout as contact_row
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.contacts.load.peaks import note_push
from vibeam.flight.kernels.contacts.reactions import each
from vibeam.flight.kernels.contacts.signals import FORCE
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.kernels.regimes import layout as regime_row
from vibeam.flight.kernels.roots.bounds import SPLIT
from vibeam_models.arrays import Array


@kernel
def note_pushes(engine: ContactEngine, regime: Regime, status: Array, number: int, h: float) -> None:
    """status[PEAKED]: the largest force of the stops that push."""
    k = engine.rows.shape[0]
    for place in range(number):
        which = engine.watched[place]
        if which // k == FORCE and status[each(engine, contact_row.CONDITION, which % k)] == contact_row.PUSHING:
            most = note_push(engine, regime, place, which, h, status[regime_row.PEAKED])
            status[regime_row.PEAKED] = most


@kernel
def is_roomy(engine: ContactEngine) -> bool:
    """True where there is room for the intervals of a segment, or none are asked for."""
    course, number = engine.course, 2 * engine.rows.shape[0]
    most = course.numbers[row.WRITTEN] + number * (row.LONG + row.STRIDE)
    return bool(course.numbers[row.CERTIFIED] == 0.0 or most <= course.intervals.shape[0])


@kernel
def note_all(engine: ContactEngine, number: int, segment: int, begin: float, length: float) -> None:
    """Intervals of a certificate: every signal is positive there."""
    note_last(engine, number, segment, begin, length, contact_row.NONE)


@kernel
def note_last(engine: ContactEngine, number: int, segment: int, begin: float, length: float, met: int) -> None:
    """The same up to a root of signal ``met``."""
    course = engine.course
    if course.numbers[row.CERTIFIED] == 0.0:
        return
    for place in range(number):
        which, at = engine.watched[place], int(course.numbers[row.WRITTEN])
        doubt = course.watch[row.ADDED, place] != 0.0 or course.watch[row.FOUND, place] == SPLIT
        claim = layout.UNPROVED if doubt else layout.CLOSES if which == met else layout.OPEN
        interval = course.intervals[at]
        interval[layout.PIECE_SEGMENT], interval[layout.PIECE_SIGNAL] = segment, which
        interval[layout.BEGIN], interval[layout.LENGTH], interval[layout.CLAIM] = begin, length, claim
        course.numbers[row.WRITTEN] += 1.0
