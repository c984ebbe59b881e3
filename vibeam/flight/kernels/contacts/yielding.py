"""Stops that yield: entered, left, or just touched."""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.contacts import layout as row
from vibeam.flight.kernels.contacts.algebra import along, factor, size_along
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.contacts.reactions import clearance, each, hold, is_rigid, pull, push_of, seen
from vibeam.flight.kernels.contacts.strikes import put, some_of, stop
from vibeam.flight.kernels.modal_flow import ROUND_OFF, opening_order
from vibeam.flight.kernels.regimes import layout as regime_row
from vibeam_models.arrays import Array


@kernel
def set_condition(engine: ContactEngine, status: Array, j: int, condition: float, order: float, rise: float) -> None:
    """Set the condition of a contact, and how its signal starts."""
    status[each(engine, row.CONDITION, j)] = condition
    status[each(engine, row.ORDER, j)], status[each(engine, row.RISE, j)] = order, rise


@kernel
def drift(engine: ContactEngine, pose: Array, j: int) -> float:
    """The contact velocity that is no more than round-off of what it is the sum of."""
    size = 0.0
    for k in range(pose.shape[1]):
        size += abs(engine.rows[j, k]) * (abs(pose[1, k]) + engine.omega[k] * abs(pose[0, k]))
    return ROUND_OFF * size


@kernel
def enter(engine: ContactEngine, pose: Array, status: Array, j: int) -> tuple[int, float]:
    """At a stop that yields, from outside: how the segment before it ends, and the velocity."""
    speed, top = along(engine.rows, j, pose[1]), each(engine, row.TOP, j)
    if speed < 0.0:
        set_condition(engine, status, j, row.AWAY, 1.0, -speed)
        return regime_row.PASS, 0.0
    status[top] = max(status[top], speed)
    if speed <= drift(engine, pose, j):
        touch(engine, pose, status, j)
        pushes = status[each(engine, row.CONDITION, j)] == row.PUSHING
        return layout.IMPACT if pushes else regime_row.PASS, speed
    set_condition(engine, status, j, row.PUSHING, 1.0, 0.0)
    return layout.IMPACT, speed


@kernel
def touch(engine: ContactEngine, pose: Array, status: Array, j: int) -> None:
    """At a stop that yields, without velocity: into it, away from it, or neither: then it stands there, touching it."""
    set_condition(engine, status, j, row.AWAY, 0.0, 0.0)
    picks, vectors = engine.picks[row.LIST], engine.vectors
    pull(engine, pose, status)
    count = some_of(engine, int(status[row.HELD]), picks)
    factor(engine.gram, picks, count, engine.lower)
    hold(engine, pose, status, picks, count)
    toward = seen(along(engine.rows, j, vectors[row.ACCELERATION]), size_along(engine.rows, j, vectors[row.PULL_SIZE]))
    jerk = seen(along(engine.rows, j, vectors[row.JERK]), size_along(engine.rows, j, vectors[row.RATE_SIZE]))
    order, rise = opening_order(toward, jerk)
    if order > 0:
        set_condition(engine, status, j, row.AWAY, float(order), rise)
    elif toward > 0.0:
        set_condition(engine, status, j, row.PUSHING, 1.0, 0.0)
    elif order < 0:
        set_condition(engine, status, j, row.PUSHING, regime_row.TOUCHING, jerk)
    else:
        put(engine, pose, int(status[row.HELD]) | 1 << j)
        stop(engine, pose, int(status[row.HELD]) | 1 << j)
        set_condition(engine, status, j, row.AWAY, regime_row.TOUCHING, 0.0)


@kernel
def leave(engine: ContactEngine, pose: Array, status: Array, j: int) -> None:
    """Out of the range of a stop that yields."""
    speed = along(engine.rows, j, pose[1])
    set_condition(engine, status, j, row.AWAY, 1.0, -speed)
    if -speed <= drift(engine, pose, j):
        touch(engine, pose, status, j)


@kernel
def let_go(engine: ContactEngine, pose: Array, status: Array, j: int) -> None:
    """The force of a stop is gone."""
    if is_damped(engine, j):
        set_condition(engine, status, j, row.INSIDE, 1.0, 0.0)
    else:
        leave(engine, pose, status, j)


@kernel
def push_anew(engine: ContactEngine, pose: Array, status: Array) -> None:
    """After impulses elsewhere: those touched are entered, or left, by the velocity that they have now, and which of
    the linear stops with damping that are penetrated push.
    """
    for j in range(engine.rows.shape[0]):
        condition = status[each(engine, row.CONDITION, j)]
        gap, least = clearance(engine, pose, j)
        if not is_rigid(engine, j) and condition == row.AWAY and gap <= least:
            enter(engine, pose, status, j)
        if is_damped(engine, j) and (condition == row.PUSHING or condition == row.INSIDE):
            pushes = push_of(engine, pose, j) > 0.0
            set_condition(engine, status, j, row.PUSHING if pushes else row.INSIDE, 0.0, 0.0)


@kernel
def is_damped(engine: ContactEngine, j: int) -> bool:
    """True for a linear stop with damping, whose force is gone before the penetration is."""
    law = engine.laws[j]
    return bool(law[regime_row.FAMILY] == regime_row.LINEAR and law[regime_row.DAMPING] > 0.0)
