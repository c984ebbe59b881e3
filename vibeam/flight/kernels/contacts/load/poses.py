"""Poses between the points that were kept of a motion under a load."""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.contacts import layout as contact_row
from vibeam.flight.kernels.contacts.course import CLOCK_NOW, PIECE_NOW
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.contacts.load.flow import (
    accept,
    differentiate,
    enter_blocks,
    grow,
    leave_blocks,
    move_on,
    set_load,
)
from vibeam.flight.kernels.contacts.sets import key_of, regime_of, slot_of
from vibeam.flight.kernels.layout import Regime
from vibeam_models.arrays import Array


@kernel
def enter_loaded(engine: ContactEngine, pose: Array, segment: Array) -> int:
    """flow[Y] at the start of a traced segment, numbers[PIECE_NOW], [CLOCK_NOW] there; the slot of its set."""
    slot = slot_of(engine, key_of(engine, segment[contact_row.HELD_AT], segment[contact_row.PUSHED_AT]))
    enter_blocks(regime_of(engine, slot), engine.course, pose)
    numbers = engine.course.numbers
    numbers[PIECE_NOW], numbers[CLOCK_NOW] = segment[contact_row.PIECE_AT], segment[layout.AT_CLOCK]
    return slot


@kernel
def carry_loaded(engine: ContactEngine, regime: Regime, slot: int, time: float) -> None:
    """flow[Y], numbers[PIECE_NOW] and [CLOCK_NOW] a time on, piece by piece."""
    course, left = engine.course, time
    numbers, lengths = course.numbers, course.lengths
    while left > 0.0:
        piece, clock = int(numbers[PIECE_NOW]), numbers[CLOCK_NOW]
        rest = lengths[piece] - clock
        set_load(course, piece, clock)
        differentiate(regime, course, 1)
        last = piece + 1 >= lengths.shape[0]
        if left < rest or last:
            move_on(regime, course, left)
            numbers[CLOCK_NOW] = clock + left
            return
        if clock == 0.0:
            grow(regime, course, slot, lengths[piece], lengths[piece])
            accept(course)
        else:
            move_on(regime, course, rest)
        numbers[PIECE_NOW], numbers[CLOCK_NOW], left = piece + 1, 0.0, left - rest


@kernel
def leave_loaded(engine: ContactEngine, slot: int, pose: Array) -> None:
    """Set ``pose`` to where the flow is."""
    leave_blocks(regime_of(engine, slot), engine.course, pose)
