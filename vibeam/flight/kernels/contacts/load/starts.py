"""Starts of the signals watched under a load: whether at a root, and of which order."""

from __future__ import annotations

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.contacts import course as row
from vibeam.flight.kernels.contacts import layout as contact_row
from vibeam.flight.kernels.contacts.course import Course
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.contacts.load.panel import derivative_at, parts, row_of, show_value
from vibeam.flight.kernels.contacts.load.quiet import bound_of_free
from vibeam.flight.kernels.contacts.reactions import each
from vibeam.flight.kernels.contacts.signals import GAP, OUT
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.kernels.modal_flow import ROUND_OFF, SMALLEST
from vibeam.flight.kernels.regimes import layout as regime_row
from vibeam.flight.kernels.regimes.events import STALLS
from vibeam_models.arrays import Array


@kernel
def start_watch(engine: ContactEngine, regime: Regime, status: Array, number: int) -> tuple[int, int]:
    """Begin to watch the signals: outcome, and the one that is an event at once, or NONE."""
    course, watch, k = engine.course, engine.course.watch, engine.rows.shape[0]
    for place in range(number):
        which = engine.watched[place]
        j, kind = which % k, which // k
        watch[row.ADDED, place], watch[row.START_ORDER, place], watch[row.START_RISE, place] = 0.0, 0.0, 0.0
        show_value(engine, regime, course, place, which)
        value, size = watch[row.AT, place], watch[row.PARTS, place]
        if not np.isfinite(size):
            return layout.NOT_FINITE, contact_row.NONE
        touching = status[each(engine, contact_row.ORDER, j)] == regime_row.TOUCHING
        order, rise = int(status[each(engine, contact_row.ORDER, j)]), status[each(engine, contact_row.RISE, j)]
        if kind != GAP and status[each(engine, contact_row.CONDITION, j)] != contact_row.KEPT:
            fresh = order > 0 and kind != OUT
            order, rise = leading(engine, regime, which, place, max(value, 0.0) if fresh else value)
            touching = touching or (status[regime_row.STALL] >= STALLS and order != 0)
            if order < 0 and not touching:
                return layout.COMPLETE, which
        if touching:
            size += swing(regime, course, regime.signals[row_of(engine, which)])
            watch[row.ADDED, place] = 2.0 * (ROUND_OFF * size + max(-value, 0.0)) + SMALLEST
            watch[row.AT, place] = value + watch[row.ADDED, place]
        else:
            watch[row.START_ORDER, place], watch[row.START_RISE, place] = max(order, 0), rise
    return layout.COMPLETE, contact_row.NONE


@kernel
def swing(regime: Regime, course: Course, weights: Array) -> float:
    """About as much as a signal moves by its blocks' free motion over the piece; its round-off is a share of that."""
    total, span = 0.0, course.lengths[int(course.numbers[row.PIECE_NOW])]
    for k in range(course.flow.shape[1]):
        total += bound_of_free(regime, weights, k, course.flow[row.Y, k], course.flow[row.Y + 1, k], span)
    return total


@kernel
def leading(engine: ContactEngine, regime: Regime, which: int, place: int, value: float) -> tuple[int, float]:
    """Order and size of the first derivative by which a signal rises from 0, as ``leading_order``."""
    size = engine.course.watch[row.PARTS, place]
    if abs(value) > ROUND_OFF * size:
        return (0, 0.0) if value > 0.0 else (-1, 0.0)
    order, rise = first_derivative(engine, regime, which)
    return (order, rise) if rise > 0.0 else (-1, 0.0)


@kernel
def first_derivative(engine: ContactEngine, regime: Regime, which: int) -> tuple[int, float]:
    """Order, up to 3, and size of the first derivative of a signal that is not round-off; (0, 0) where all are."""
    course, weights = engine.course, regime.signals[row_of(engine, which)]
    for order in range(1, 4):
        rise = derivative_at(engine, regime, course, which, order)
        if abs(rise) > ROUND_OFF * parts(weights, course.flow, row.Y + 2 * order):
            return order, rise
    return 0, 0.0


@kernel
def first_panel(engine: ContactEngine, regime: Regime, number: int, rest: float) -> float:
    """The length to start with: twice the shortest flight 2g'(0)/|g''(0)| that two derivatives foretell."""
    want, watch = rest, engine.course.watch
    for place in range(number):
        if watch[row.START_ORDER, place] == 1.0:
            ahead = derivative_at(engine, regime, engine.course, engine.watched[place], 2)
            if ahead < 0.0:
                want = min(want, -4.0 * watch[row.START_RISE, place] / ahead)
    return want
