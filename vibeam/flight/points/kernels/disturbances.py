"""Entry point: disturbances carried along the motions of points, by closed-form flow and saltation matrices.

One point after the other; the mathematics is that of ``disturbance.tangent``.
"""

from __future__ import annotations

from math import sin, sqrt

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import entry, joined, kernel
from vibeam.flight.kernels.events import advance
from vibeam.flight.kernels.layout import Engine, Watch
from vibeam.flight.kernels.roots.pair import propagator
from vibeam.flight.points.kernels import layout as row
from vibeam.flight.points.kernels.layout import Disturbances, Task
from vibeam.flight.points.kernels.point import engine_of, fill_engine, set_point
from vibeam_models.arrays import Array, Index

BUDGET = 100_000  # impacts between two pauses, fewer where many numbers are carried


@joined
def is_lost(trace: Array, i: int, restitution: float) -> bool:
    """True where directions are lost in a segment or at its end: at rest, at the end of a chatter, by R = 0."""
    end = trace[i, layout.END]
    stuck = end in (layout.CHATTER, layout.STUCK) or (end == layout.IMPACT and restitution == 0.0)
    return bool(trace[i, layout.WHAT] == layout.RESTING or stuck)


@kernel
def carry_over_flight(pairs: Array, time: float, columns: Array) -> None:
    """Disturbances (c, 2, n) over free flight: each mode's propagator."""
    for k in range(pairs.shape[1]):
        p00, p01, p10, p11 = propagator(pairs[layout.SIGMA, k], pairs[layout.OMEGA, k], pairs[layout.DISC, k], time)
        for j in range(columns.shape[0]):
            x, y = columns[j, 0, k], columns[j, 1, k]
            columns[j, 0, k], columns[j, 1, k] = p00 * x + p01 * y, p10 * x + p11 * y


@kernel
def acceleration_before(pairs: Array, modes: Array, drive: Array, after: Array, before: float, clock: float) -> float:
    """The contact's acceleration towards the stop just before an impact, from the pose after it.

    ``before``: contact velocity; η'⁻ = η'⁺ + c (v⁻ − c·η'⁺)/S.
    """
    slope = 0.0
    for k in range(modes.shape[1]):
        slope += modes[layout.CONTACT, k] * after[1, k]
    impulse, push = (before - slope) / drive[layout.MOBILITY], drive[layout.STRENGTH] * sin(drive[layout.W] * clock)
    found = 0.0
    for k in range(modes.shape[1]):
        c, own = modes[layout.CONTACT, k], pairs[layout.OMEGA, k]
        velocity = after[1, k] + c * impulse
        force = modes[layout.LOAD, k] * push + modes[layout.STATIC, k]
        found += c * (force - 2.0 * pairs[layout.SIGMA, k] * velocity - own * own * after[0, k])
    return found


@kernel
def carry_over_impact(pairs: Array, modes: Array, drive: Array, lean: float, columns: Array) -> None:
    """Disturbances (c, 2, n) over an impact; ``lean``: the contact's acceleration over its velocity before it."""
    share = (1.0 + drive[layout.RESTITUTION]) / drive[layout.MOBILITY]
    for j in range(columns.shape[0]):
        moved, swung = 0.0, 0.0
        for k in range(modes.shape[1]):
            moved += modes[layout.CONTACT, k] * columns[j, 0, k]
            swung += modes[layout.CONTACT, k] * columns[j, 1, k]
        for k in range(modes.shape[1]):
            c = share * modes[layout.CONTACT, k]
            columns[j, 0, k] -= c * moved
            columns[j, 1, k] += c * ((2.0 * pairs[layout.SIGMA, k] + lean) * moved - swung)


@kernel
def carry_along(engine: Engine, watch: Watch, last: Array, count: int, columns: Array) -> bool:
    """Disturbances over the segments traced, ``last`` the pose after them; whether a direction is lost on the way."""
    pairs, modes, drive, trace = engine.pairs, engine.modes, engine.drive, watch.trace
    for i in range(count):
        if is_lost(trace, i, drive[layout.RESTITUTION]):
            return True
        carry_over_flight(pairs, trace[i, layout.DURATION], columns)
        speed = trace[i, layout.BEFORE]
        if trace[i, layout.END] == layout.IMPACT and speed > 0.0:
            after = last if i == count - 1 else watch.poses[i + 1]
            clock = trace[i, layout.AT_CLOCK] + trace[i, layout.DURATION]
            toward = acceleration_before(pairs, modes, drive, after, speed, clock)
            carry_over_impact(pairs, modes, drive, toward / speed, columns)
    return False


@kernel
def normalized(pairs: Array, w: float, column: Array) -> float:
    """Make a disturbance (2, n) one of size 1 in units of velocity; what it was."""
    square = 0.0
    for k in range(pairs.shape[1]):
        unit = pairs[layout.OMEGA, k] if pairs[layout.OMEGA, k] > 0.0 else w
        square += (unit * column[0, k]) * (unit * column[0, k]) + column[1, k] * column[1, k]
    size = sqrt(square)
    if size == 0.0:
        return size
    for k in range(pairs.shape[1]):
        column[0, k] /= size
        column[1, k] /= size
    return size


@entry
def carry(
    task: Task, engines: Engine, watch: Watch, disturbances: Disturbances, status: Array, counts: Index, first: int,
    limit: int,
) -> tuple[int, int]:  # fmt: skip
    """Carry the disturbances of the points from ``first`` on: outcome, the next point.

    PAUSED: called again with that point it goes on as if it had not been. ``engines``: room for one engine. Each point
    is carried on from its pose in ``task`` at the drive's phase 0, and its end is put there.
    """
    work = 0
    engine = engine_of(engines, 0)
    most = BUDGET // (1 + disturbances.columns.shape[1] * disturbances.columns.shape[3] // 128)
    for point in range(first, task.pack.shape[0]):
        if work > most:
            return layout.PAUSED, point
        if counts[layout.WATCHED] == 0:
            fill_engine(engine, engine_of(task.packs, task.pack[point]))
            set_point(task, engine, point)
            status[:], counts[:] = 0.0, 0
            status[layout.KIND], counts[layout.WATCHED] = task.kinds[point], 1
        outcome, lost = go_along(
            engine, task.poses[point], watch, disturbances.columns[point], disturbances.growth[point], status, counts,
            disturbances.periods[point], limit, most,
        )  # fmt: skip
        if outcome == layout.PAUSED:
            return layout.PAUSED, point
        counts[layout.WATCHED] = 0
        task.kinds[point] = status[layout.KIND]
        disturbances.ended[point, 0], disturbances.ended[point, 1] = outcome, lost
        task.counts[point, layout.IMPACTS] = counts[layout.IMPACTS]
        work += counts[layout.IMPACTS] + 100
    return layout.COMPLETE, task.pack.shape[0]


@kernel
def go_along(
    engine: Engine, pose: Array, watch: Watch, columns: Array, growth: Array, status: Array, counts: Index,
    periods: int, limit: int, most: int,
) -> tuple[int, int]:  # fmt: skip
    """Carry one point's pose and disturbances over some drive periods: outcome, LOST where a direction is lost.

    PAUSED after ``most`` impacts, at the end of a period, or where the motion does.
    """
    begun = counts[layout.IMPACTS]
    while counts[layout.SETTLED] < periods:
        if counts[layout.MOST] == 0:
            status[layout.CLOCK], status[layout.UNSEEN] = 0.0, engine.drive[layout.PERIOD]
            counts[layout.EVENTS], counts[layout.SEGMENTS] = 0, 0
            counts[layout.MOST] = counts[layout.IMPACTS] + limit
        outcome, done = advance(
            engine, pose, status, status[layout.UNSEEN], counts[layout.MOST], watch.trace, watch.poses, counts
        )
        if outcome == layout.PAUSED:
            return layout.PAUSED, 0
        status[layout.UNSEEN] -= done
        if carry_along(engine, watch, pose, counts[layout.SEGMENTS], columns):
            return layout.COMPLETE, row.DIRECTION_LOST
        counts[layout.SEGMENTS] = 0
        if outcome == layout.FULL:
            continue
        if outcome != layout.COMPLETE:
            return int(outcome), 0
        if growth.shape[0] > 0:
            growth[counts[layout.SETTLED]] = normalized(engine.pairs, engine.drive[layout.W], columns[0])
        counts[layout.MOST] = 0
        counts[layout.SETTLED] += 1
        if counts[layout.IMPACTS] - begun > most and counts[layout.SETTLED] < periods:
            return layout.PAUSED, 0
    status[layout.CLOCK] = 0.0
    return layout.COMPLETE, 0
