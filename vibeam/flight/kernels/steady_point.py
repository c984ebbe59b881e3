"""A steady point: periods settled, periods watched, and after how many of them the motion repeats.

The same for every engine: ``advance`` carries its motion on, ``read`` reads off a segment traced.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.layout import (
    BEFORE,
    CHATTER,
    CLOCK,
    COMPLETE,
    CONTACT_LEAST,
    DONE,
    DURATION,
    END,
    FREE,
    FULL,
    HIGH,
    IMPACT,
    IMPACTS,
    KEPT,
    KNOWN,
    LEAST,
    MOST,
    PAUSED,
    PERIOD,
    REST_TIME,
    SEGMENTS,
    SETTLED,
    SPEED_SUM,
    STRUCK,
    STUCK,
    UNRESOLVED,
    UNSEEN,
    VELOCITY,
    WATCHED,
    WHAT,
    Schedule,
    W,
    Watch,
)
from vibeam.flight.kernels.segments import copy_pose, work_of

Array = NDArray[np.float64]

Counts = NDArray[np.int64]

Kernel = Callable[..., Any]

SETTLED_AT_ONCE = 32  # periods: then the phase is set anew, so that a long settling does not round it off

SAME = 1e-14  # the same where a period is taken for a copy of the one before

REPEATS = 1e-5  # share of the motion's size by which states one period apart may differ


def steady_kernel(advance: Kernel, read: Kernel) -> Callable[..., tuple[int, float]]:
    """The kernel of steady points for an engine with these two."""
    settle, watch = settling_kernel(advance), watching_kernel(advance, read)

    @kernel
    def steady_point(
        engine: Any, own: Array, pose: Array, status: Array, schedule: Schedule, room: Watch, counts: Counts
    ) -> tuple[int, float]:
        """Settle and watch as scheduled: outcome, period (0 where the motion does not repeat); ``own``: the modes' ω.

        PAUSED: called again with the same arguments it goes on as if it had not been.
        """
        begun, hold = work_of(counts), schedule.hold
        outcome = settle(engine, pose, status, schedule, room, counts)
        while outcome == COMPLETE and counts[WATCHED] <= hold:
            outcome = watch(engine, own, pose, status, schedule.limit, room, counts)
            begun -= schedule.watching * counts[SEGMENTS]
            if outcome == COMPLETE and counts[WATCHED] <= hold and work_of(counts) - begun >= schedule.piece:
                outcome = PAUSED
        if outcome == PAUSED:
            return PAUSED, 0.0
        status[CLOCK] = 0.0
        if outcome != COMPLETE:
            return outcome, 0.0
        return outcome, float(repetition(own, engine.drive[W], room.strobes, hold, schedule.longest))

    return steady_point


def settling_kernel(advance: Kernel) -> Kernel:
    """The kernel that settles."""

    @kernel
    def settle(engine: Any, pose: Array, status: Array, schedule: Schedule, room: Watch, counts: Counts) -> int:
        """Carry ``pose`` on to the end of the settling, where it is not there yet, and begin to watch."""
        begun, period = work_of(counts), engine.drive[PERIOD]
        while counts[SETTLED] < schedule.settle:
            turns = min(SETTLED_AT_ONCE, schedule.settle - counts[SETTLED])
            if counts[MOST] == 0:
                counts[MOST] = counts[IMPACTS] + schedule.limit * turns
            outcome, _ = advance(engine, pose, status, turns * period, counts[MOST], room.nothing, room.poses, counts)
            if outcome != COMPLETE:
                return int(outcome)
            status[CLOCK], counts[MOST] = 0.0, 0
            counts[SETTLED] += turns
            begun -= 1
            if work_of(counts) - begun >= schedule.piece:
                return PAUSED
        if counts[WATCHED] == 0:
            start_watching(room, pose)
            begin_period(room)
            counts[WATCHED], counts[MOST], status[UNSEEN] = 1, counts[IMPACTS] + schedule.limit, period
        return COMPLETE

    return settle


def reading_kernel(read: Kernel) -> Kernel:
    """The kernel that reads off the segments of a trace, each by ``read``."""

    @kernel
    def read_off(engine: Any, room: Watch, count: int) -> None:
        """Read off the segments just traced."""
        trace, result = room.trace, room.result
        for i in range(count):
            if trace[i, WHAT] != FREE:
                result[REST_TIME] += trace[i, DURATION]
            if trace[i, DURATION] > 0.0:
                copy_pose(room.poses[i], room.frame)
                read(engine, room, i)
            note_impact(trace, i, result)
            if is_unread(result):
                return

    return read_off


def watching_kernel(advance: Kernel, read: Kernel) -> Kernel:
    """The kernel that watches."""
    read_off = reading_kernel(read)

    @kernel
    def watch(engine: Any, own: Array, pose: Array, status: Array, limit: int, room: Watch, counts: Counts) -> int:
        """Carry ``pose`` on to the end of the period, or of the trace, and read off what is traced."""
        period = engine.drive[PERIOD]
        if status[DONE] == 0.0:
            counts[SEGMENTS] = 0
            status[CLOCK] = period - status[UNSEEN]
        outcome, done = advance(engine, pose, status, status[UNSEEN], counts[MOST], room.trace, room.poses, counts)
        if outcome == PAUSED:
            return PAUSED
        if counts[KNOWN] > 0:
            note_impacts(room, counts[SEGMENTS])
        else:
            read_off(engine, room, counts[SEGMENTS])
            if is_unread(room.result):
                return UNRESOLVED
        status[UNSEEN] -= done
        if outcome == FULL:
            return COMPLETE
        turn = counts[WATCHED]
        status[UNSEEN], counts[MOST], counts[WATCHED] = period, counts[IMPACTS] + limit, turn + 1
        note_strobe(room.strobes, turn, pose)
        if counts[KNOWN] > 0:
            repeat_period(room)
        elif is_same(own, engine.drive[W], room.strobes, turn):
            note_period(room)
            counts[KNOWN] = 1
        else:
            begin_period(room)
        return int(outcome)

    return watch


@kernel
def start_watching(room: Watch, pose: Array) -> None:
    """Nothing is seen yet."""
    room.result[:], room.energy[:] = 0.0, 0.0
    room.result[HIGH], room.result[LEAST], room.result[CONTACT_LEAST] = -np.inf, np.inf, np.inf
    note_strobe(room.strobes, 0, pose)


@kernel
def note_strobe(strobes: Array, turn: int, pose: Array) -> None:
    """Keep the state at the end of a period."""
    copy_pose(pose, strobes[turn])


@kernel
def begin_period(room: Watch) -> None:
    """Note energies and time at rest before a period, taken off."""
    n = room.energy.shape[0]
    for k in range(n):
        room.share[k] = -room.energy[k]
    room.share[n] = -room.result[REST_TIME]


@kernel
def note_period(room: Watch) -> None:
    """What the period watched since ``begin_period`` has added."""
    n = room.energy.shape[0]
    for k in range(n):
        room.share[k] += room.energy[k]
    room.share[n] += room.result[REST_TIME]


@kernel
def repeat_period(room: Watch) -> None:
    """A period like the one watched last: the same energies and time at rest, no new extremes."""
    n = room.energy.shape[0]
    for k in range(n):
        room.energy[k] += room.share[k]
    room.result[REST_TIME] += room.share[n]


@kernel
def is_same(own: Array, w: float, strobes: Array, turn: int) -> bool:
    """Whether a period began as the one before it to round-off, so that it will be the same."""
    if turn < 1:
        return False
    apart = distance(own, w, strobes, turn, turn - 1)
    return bool(apart <= SAME * SAME * distance(own, w, strobes, turn, -1))


@kernel
def is_unread(result: Array) -> bool:
    """Whether the extremes of what was traced were not found in bounded work."""
    return bool(result[HIGH] == np.inf or result[CONTACT_LEAST] == -np.inf)


@kernel
def note_impacts(room: Watch, count: int) -> None:
    """Count the impacts of the segments just traced, and nothing else."""
    for i in range(count):
        note_impact(room.trace, i, room.result)


@kernel
def note_impact(trace: Array, i: int, result: Array) -> None:
    """Count the impact that ends a segment and keep its velocity in a ring."""
    if trace[i, END] == IMPACT or trace[i, END] == CHATTER or trace[i, END] == STUCK:
        result[VELOCITY + int(result[STRUCK]) % KEPT] = trace[i, BEFORE]
        result[STRUCK] += 1.0
        result[SPEED_SUM] += trace[i, BEFORE]


@kernel
def repetition(own: Array, w: float, strobes: Array, hold: int, longest: int) -> int:
    """The least k ≤ longest such that each of the last k strobes repeats the one k periods before, else 0."""
    size = 0.0
    for turn in range(hold + 1):
        size = max(size, distance(own, w, strobes, turn, -1))
    for k in range(1, min(longest, hold // 2) + 1):
        worst = 0.0
        for turn in range(hold - k + 1, hold + 1):
            worst = max(worst, distance(own, w, strobes, turn, turn - k))
        if worst <= REPEATS * REPEATS * size:
            return k
    return 0


@kernel
def distance(own: Array, w: float, strobes: Array, first: int, second: int) -> float:
    """Squared distance of two strobes in velocity units, the modes' ω ``own``; from the origin where ``second`` < 0."""
    total = 0.0
    for k in range(own.shape[0]):
        x, y = strobes[first, 0, k], strobes[first, 1, k]
        if second >= 0:
            x -= strobes[second, 0, k]
            y -= strobes[second, 1, k]
        total += y * y + (own[k] * own[k] + w * w) * x * x
    return total
