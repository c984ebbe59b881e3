"""Signals watched in a set of contacts, and the first root of them all.

With k contacts signal j is the gap of contact j, k + j its force: the reaction of a stop that holds, the force by the
law of one that yields; 2k + j and 3k + j are their negatives, watched while a stop with damping is penetrated and does
not push.
"""

from __future__ import annotations

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.block_flow import set_signal
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.contacts import layout as row
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.contacts.reactions import each
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.kernels.modal_flow import ROUND_OFF, SMALLEST
from vibeam.flight.kernels.regimes import layout as regime_row
from vibeam.flight.kernels.regimes.contact_motion import leading_order
from vibeam.flight.kernels.regimes.events import STALLS
from vibeam.flight.kernels.roots.double_gap import InitialState
from vibeam.flight.kernels.roots.first_root import first_root
from vibeam.flight.kernels.roots.signal import Start, signal_of, to_node
from vibeam_models.arrays import Array, Index

GAP, FORCE, OUT, BACK = range(4)  # kinds of signals, which of k each


@kernel
def is_watched(condition: float, kind: int) -> bool:
    """True where a contact's condition asks for a signal of that kind."""
    if condition == row.INSIDE:
        return kind >= OUT
    if condition == row.AWAY:
        return kind == GAP
    return kind == FORCE and (condition == row.KEPT or condition == row.PUSHING)


@kernel
def list_signals(engine: ContactEngine, status: Array) -> int:
    """List the signals to watch; their number.

    Those that start at zero, forces first, each followed by one that does not, as long as there are both.
    """
    k, special, plain = engine.rows.shape[0], 0, 0
    for j in range(k):
        condition, starts = status[each(engine, row.CONDITION, j)], status[each(engine, row.ORDER, j)] != 0.0
        number = 0 if condition == row.IMPLIED else 2 if condition == row.INSIDE else 1
        special += number if starts else 0
        plain += 0 if starts else number
    first, second = 0, 0
    for turn in range(4):
        kind = FORCE if turn == 0 else GAP if turn == 1 else turn
        for j in range(k):
            if not is_watched(status[each(engine, row.CONDITION, j)], kind):
                continue
            if status[each(engine, row.ORDER, j)] != 0.0:
                engine.watched[2 * first if first < plain else plain + first] = kind * k + j
                first += 1
            else:
                engine.watched[2 * second + 1 if second < special else special + second] = kind * k + j
                second += 1
    return special + plain


@kernel
def show(engine: ContactEngine, regime: Regime, which: int, clock: float) -> tuple[float, float, float]:
    """Make a signal that of the regime: value, rate, size of its parts."""
    k = engine.rows.shape[0]
    if which >= 2 * k:
        return set_signal(regime, engine.drive, which - 2 * k, -1.0, clock)
    return set_signal(regime, engine.drive, which, 1.0, clock)


@kernel
def first_signal(
    engine: ContactEngine, regime: Regime, coarsest: int, pose: Array, status: Array, span: float, counts: Index
) -> tuple[int, int, float]:
    """The first root of the signals watched in a regime just entered: outcome, whose it is (NONE: nobody's), time.

    Of equal ones the last counts.
    """
    k, met, step = engine.rows.shape[0], row.NONE, span
    for place in range(list_signals(engine, status)):
        which = engine.watched[place]
        j, kind = which % k, which // k
        value, rate, size = show(engine, regime, which, status[layout.CLOCK])
        if not np.isfinite(size):
            return layout.NOT_FINITE, row.NONE, 0.0
        start, touching = Start(0, 0.0), status[each(engine, row.ORDER, j)] == regime_row.TOUCHING
        if kind == GAP or status[each(engine, row.CONDITION, j)] == row.KEPT:
            if not touching:
                start = Start(int(status[each(engine, row.ORDER, j)]), status[each(engine, row.RISE, j)])
        else:
            fresh = status[each(engine, row.ORDER, j)] > 0.0 and kind != OUT
            order, rise = leading_order(regime, max(value, 0.0) if fresh else value, rate, size)
            touching = touching or (status[regime_row.STALL] >= STALLS and order != 0)
            if order < 0 and not touching:
                return layout.COMPLETE, which, 0.0
            if not touching:
                start = Start(order, rise)
        if touching:
            size += to_node(regime.pairs)
            regime.signal[layout.CONST] += 2.0 * (ROUND_OFF * size + max(-value, 0.0)) + SMALLEST
        found, time, panels = first_root(
            signal_of(regime), start, step, coarsest, InitialState(regime.blocks, engine.drive, pose, layout.NO_CLOCK)
        )
        counts[layout.PANELS] += panels
        if time < 0.0:
            return layout.UNRESOLVED, row.NONE, 0.0
        if found:
            met, step = which, time
    return layout.COMPLETE, met, step
