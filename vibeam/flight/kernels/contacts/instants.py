"""An instant of several contacts: which are touched, impulses in turn, what follows; an accumulation completed."""

from __future__ import annotations

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.block_flow import to_block_coordinates
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.contacts import layout as row
from vibeam.flight.kernels.contacts.algebra import NOISE
from vibeam.flight.kernels.contacts.course import LOADED
from vibeam.flight.kernels.contacts.integration import is_integrated
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.contacts.load.walk import is_met, reaches_knot
from vibeam.flight.kernels.contacts.reactions import clearance, decide, each, is_rigid
from vibeam.flight.kernels.contacts.sets import key_of, regime_of, slot_of
from vibeam.flight.kernels.contacts.signals import FORCE, GAP, OUT, first_signal
from vibeam.flight.kernels.contacts.strikes import next_of, put, stop, strike, time_left
from vibeam.flight.kernels.contacts.yielding import enter, leave, let_go, push_anew, set_condition
from vibeam.flight.kernels.regimes import layout as regime_row
from vibeam.flight.kernels.segments import copy_pose
from vibeam_models.arrays import Array, Index

DEEP = 2500.0  # times the largest gap that is none: how far beyond a stop no round-off explains
TOO_EARLY = -1  # no outcome
SOON = 1e-12  # share of the slowest time scale that no event is told from


@kernel
def classify(engine: ContactEngine, pose: Array, status: Array) -> int:
    """Set what the motion begins in, from its state alone: COMPLETE, or why it cannot be."""
    touched, status[row.HELD], status[row.PUSHED] = 0, 0.0, 0.0
    status[layout.ORDER], status[layout.KIND], status[row.PHASE] = 0.0, layout.FREE, row.FLYING
    for j in range(engine.rows.shape[0]):
        gap, least = clearance(engine, pose, j)
        if not np.isfinite(gap):
            return layout.NOT_FINITE
        deep = gap < -DEEP * least
        if deep and is_rigid(engine, j):
            return layout.PENETRATED
        set_condition(engine, status, j, row.PUSHING if deep else row.AWAY, 0.0, 0.0)
        if deep:
            status[row.PUSHED] += float(1 << j)
            status[layout.KIND] = regime_row.CONTACT
        elif gap <= least:
            touched |= 1 << j
    if touched > 0:
        status[row.PHASE], status[row.AT] = row.BEGINNING, row.NONE
    return layout.COMPLETE


@kernel
def arrive(engine: ContactEngine, pose: Array, status: Array, met: int) -> tuple[int, float, int]:
    """At the root of a signal: how the segment ends, the velocity there, the contact that its stop lets go (or NONE).

    The rigid contacts touched are put exactly to their stops.
    """
    k = engine.rows.shape[0]
    j, kind = met % k, met // k
    status[row.AT] = j
    end, before = touch_all(engine, pose, status, j if kind == GAP else row.NONE)
    if kind == GAP:
        return end, before, row.NONE
    if is_rigid(engine, j):
        return layout.RELEASE, 0.0, j
    if kind == FORCE:
        let_go(engine, pose, status, j)
        return layout.RELEASE, 0.0, row.NONE
    if kind == OUT:
        leave(engine, pose, status, j)
    else:
        set_condition(engine, status, j, row.PUSHING, 1.0, 0.0)
    return regime_row.PASS, 0.0, row.NONE


@kernel
def touch_all(engine: ContactEngine, pose: Array, status: Array, met: int) -> tuple[int, float]:
    """Contacts at their stops, ``met`` or as near as round-off can tell: the rigid ones noted, the others entered.

    How the segment before ends, and the velocity there, by the contact met.
    """
    touched, end, before = int(status[row.HELD]), regime_row.PASS, 0.0
    for j in range(engine.rows.shape[0]):
        condition = status[each(engine, row.CONDITION, j)]
        gap, least = clearance(engine, pose, j)
        near = j == met or (gap <= least and (is_rigid(engine, j) or condition == row.AWAY))
        if is_rigid(engine, j) and (near or condition == row.IMPLIED):
            touched |= 1 << j
        elif near and status[each(engine, row.ORDER, j)] == 0.0:
            entry, speed = enter(engine, pose, status, j)
            if j == met or (met == row.NONE and entry == layout.IMPACT):
                end, before, status[row.AT] = entry, speed, j
    put(engine, pose, touched)
    status[row.TOUCHED] = touched
    return end, before


@kernel
def impulse(
    engine: ContactEngine, pose: Array, status: Array, step: float, counts: Index
) -> tuple[int, float, int, float]:
    """The next impulse of an instant, and what the touched contacts do after the last."""
    struck, touched = int(status[row.NEXT]), int(status[row.TOUCHED])
    before = strike(engine, pose, status, struck)
    status[row.AT], status[row.NEXT] = struck, next_of(engine, pose, status)
    if status[row.NEXT] != row.NONE:
        status[row.PHASE] = row.STRIKING
        return layout.COMPLETE, step, layout.IMPACT, before
    status[row.PHASE] = row.FLYING
    push_anew(engine, pose, status)
    decide(engine, pose, status, touched, row.NONE, NOISE * status[row.HARDEST])
    if status[each(engine, row.CONDITION, struck)] == row.KEPT:
        return layout.COMPLETE, step, layout.STUCK, before
    if status[each(engine, row.ORDER, struck)] != 1.0:
        return layout.COMPLETE, step, layout.IMPACT, before
    after = status[each(engine, row.RISE, struck)]
    left, remainder = time_left(engine, pose, status, struck, after)
    if left < 0.0 or reaches_knot(engine, status, left):
        return layout.COMPLETE, step, layout.IMPACT, before
    outcome = complete(engine, pose, status, struck, left, counts)
    status[regime_row.LEFT_OVER], status[regime_row.LEFT_ERROR] = left, remainder
    if outcome == TOO_EARLY:
        return layout.COMPLETE, step, layout.IMPACT, before
    return outcome, step, layout.CHATTER, before


@kernel
def complete(engine: ContactEngine, pose: Array, status: Array, struck: int, left: float, counts: Index) -> int:
    """The accumulation at a contact completed by its limit: COMPLETE; TOO_EARLY, and all as before, where it is not.

    It is where the contact stays held, and no other event comes before the accumulation's end.
    """
    touched, after = int(status[row.TOUCHED]), status[each(engine, row.RISE, struck)]
    copy_pose(pose, engine.tried)
    for i in range(status.shape[0]):
        engine.trial[i] = status[i]
    stop(engine, pose, int(status[row.HELD]) | 1 << struck)
    decide(engine, pose, status, touched, row.NONE, NOISE * after)
    if status[each(engine, row.CONDITION, struck)] == row.KEPT:
        if left * engine.numbers[row.SLOWEST] < SOON:
            return layout.COMPLETE
        if is_integrated(engine, status[row.PUSHED]):
            return give_up(engine, pose, status)
        slot = slot_of(engine, key_of(engine, status[row.HELD], status[row.PUSHED]))
        if slot == row.NONE:
            status[row.WANTED] = key_of(engine, status[row.HELD], status[row.PUSHED]) + 1.0
            return layout.PAUSED
        regime = regime_of(engine, slot)
        if engine.course.numbers[LOADED] > 0.0:
            outcome, met = is_met(engine, regime, slot, pose, status, left, counts)
            return outcome if outcome != layout.COMPLETE or met == row.NONE else give_up(engine, pose, status)
        to_block_coordinates(regime, engine.drive, pose, status[layout.CLOCK])
        outcome, met, _ = first_signal(engine, regime, int(engine.coarsest[slot]), pose, status, left, counts)
        if outcome != layout.COMPLETE or met == row.NONE:
            return outcome
    return give_up(engine, pose, status)


@kernel
def give_up(engine: ContactEngine, pose: Array, status: Array) -> int:
    """All as before an accumulation was tried to be completed."""
    copy_pose(engine.tried, pose)
    for i in range(status.shape[0]):
        status[i] = engine.trial[i]
    return TOO_EARLY
