"""To the end of a segment under a load: a root, the span's end, or a point that is kept."""

from __future__ import annotations

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.contacts import layout as row
from vibeam.flight.kernels.contacts.course import (
    CLOCK_NOW,
    JUMPED,
    KEPT_POINT,
    LOADED,
    PIECE_NOW,
    REACHED,
    RENEWED,
    WHY,
)
from vibeam.flight.kernels.contacts.integration import integrate, is_integrated
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.contacts.load.flow import leave_blocks
from vibeam.flight.kernels.contacts.load.walk import first_signal_loaded
from vibeam.flight.kernels.contacts.reactions import each
from vibeam.flight.kernels.contacts.sets import key_of, regime_of, slot_of
from vibeam.flight.kernels.contacts.strikes import put, stop
from vibeam.flight.kernels.regimes import layout as regime_row
from vibeam.flight.kernels.regimes.events import STEPS_A_PANEL
from vibeam_models.arrays import Array, Index

FREE_STEPS = 6  # of an integrated contact in one piece
PANELS_A_PIECE = 1e7  # of walks, on average, before a run is given up


@joined
def is_on_the_way(engine: ContactEngine) -> bool:
    """True where the segment just flown ended at a point that is kept."""
    return bool(engine.course.numbers[LOADED] > 0.0 and engine.course.numbers[WHY] == KEPT_POINT)


@joined
def is_jump(engine: ContactEngine) -> bool:
    """True where a jump of the load took a reaction away, so that no force is at a root."""
    return bool(engine.course.numbers[LOADED] > 0.0 and engine.course.numbers[WHY] == JUMPED)


@kernel
def to_event_loaded(
    engine: ContactEngine, pose: Array, status: Array, span: float, counts: Index
) -> tuple[int, int, float]:
    """As ``to_event``."""
    numbers = engine.course.numbers
    if is_integrated(engine, status[row.PUSHED]):
        return through_piece(engine, pose, status, span, counts)
    key = key_of(engine, status[row.HELD], status[row.PUSHED])
    slot = slot_of(engine, key)
    if slot == row.NONE:
        status[row.WANTED] = key + 1.0
        return layout.PAUSED, row.NONE, 0.0
    regime, panels = regime_of(engine, slot), counts[layout.PANELS]
    outcome, met, step = first_signal_loaded(engine, regime, slot, pose, status, span, counts)
    if outcome != layout.COMPLETE:
        return outcome, row.NONE, 0.0
    beyond = (counts[layout.PANELS] - panels) / PANELS_A_PIECE - step / engine.course.lengths[int(status[row.PIECE])]
    status[regime_row.BUSY] = max(status[regime_row.BUSY] + STEPS_A_PANEL * beyond, 0.0)
    if step > 0.0:
        leave_blocks(regime, engine.course, pose)
        put(engine, pose, int(status[row.HELD]))
        stop(engine, pose, int(status[row.HELD]))
    if not np.isfinite(pose[0, 0]):
        return layout.UNRESOLVED, row.NONE, 0.0
    status[row.PIECE], status[layout.CLOCK] = numbers[PIECE_NOW], numbers[CLOCK_NOW]
    if numbers[WHY] == RENEWED:
        status[row.PHASE] = row.BEGINNING
        for j in range(engine.rows.shape[0]):
            status[each(engine, row.ORDER, j)] = 0.0
    return layout.COMPLETE, met, step


@kernel
def through_piece(
    engine: ContactEngine, pose: Array, status: Array, span: float, counts: Index
) -> tuple[int, int, float]:
    """The same where a contact that pushes is integrated: to the end of the piece at most."""
    course, tried, longest = engine.course, status[regime_row.STEPPED], engine.levels[0, layout.STEP, 0]
    piece, clock = int(status[row.PIECE]), status[layout.CLOCK]
    rest = course.lengths[piece] - clock
    met, step, steps = integrate(engine, pose, status, min(span, rest))
    counts[layout.PANELS] += steps
    if not (np.isfinite(step) and np.isfinite(pose[0, 0])):
        return layout.NOT_FINITE, row.NONE, 0.0
    busy = max(status[regime_row.BUSY] - STEPS_A_PANEL * step / longest, 0.0)
    status[regime_row.BUSY] = busy + max(steps - FREE_STEPS, 0)
    status[layout.CLOCK], course.numbers[WHY] = clock + step, REACHED if met != row.NONE else KEPT_POINT
    if met == row.NONE and step >= min(span, rest):
        status[regime_row.STEPPED] = max(status[regime_row.STEPPED], tried)
    if step >= rest and piece + 1 < course.lengths.shape[0]:
        status[row.PIECE], status[layout.CLOCK] = piece + 1, 0.0
    elif step >= rest and step < span:
        step = span
    return layout.COMPLETE, met, step
