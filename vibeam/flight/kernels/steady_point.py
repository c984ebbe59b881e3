"""A steady point: periods settled, periods watched, and after how many of them the motion repeats.

The same for every engine: ``advance`` carries its motion on, ``read`` reads off a segment traced.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.layout import REPEATS, SAME, PointSchedule, Watch
from vibeam.flight.kernels.readout import MOST_WORK
from vibeam.flight.kernels.segments import copy_pose, turns_of, work_of
from vibeam_models.arrays import Array, Index

Kernel = Callable[..., Any]
SETTLED_AT_ONCE = 32  # periods: then the phase is set anew, so that a long settling does not round it off


def steady_kernel(advance: Kernel, read: Kernel) -> Callable[..., tuple[int, float]]:
    """The kernel of steady points for an engine with these two."""
    settle, watching = settling_kernel(advance), watching_kernel(advance, read)

    @kernel
    def steady_point(
        engine: Any, own: Array, pose: Array, status: Array, schedule: PointSchedule, watch: Watch, counts: Index
    ) -> tuple[int, float]:
        """Settle and watch as scheduled: outcome, period (0 where the motion does not repeat); ``own``: the modes' ω.

        PAUSED: called again with the same arguments it goes on as if it had not been.
        """
        begun, hold = work_of(counts), schedule.hold
        outcome = settle(engine, pose, status, schedule, watch, counts)
        while outcome == layout.COMPLETE and counts[layout.WATCHED] <= hold:
            outcome = watching(engine, own, pose, status, schedule.limit, watch, counts)
            begun -= schedule.watching * counts[layout.SEGMENTS]
            unfinished = outcome == layout.COMPLETE and counts[layout.WATCHED] <= hold
            if unfinished and work_of(counts) - begun >= schedule.piece:
                outcome = layout.PAUSED
        if outcome == layout.PAUSED:
            return layout.PAUSED, 0.0
        status[layout.CLOCK] = 0.0
        if outcome != layout.COMPLETE:
            return outcome, 0.0
        return outcome, float(repetition(own, engine.drive[layout.W], watch.strobes, hold, schedule.longest))

    return steady_point


def settling_kernel(advance: Kernel) -> Kernel:
    """The kernel that settles."""

    @kernel
    def settle(engine: Any, pose: Array, status: Array, schedule: PointSchedule, watch: Watch, counts: Index) -> int:
        """Carry ``pose`` on to the end of the settling, where it is not there yet, and begin to watch."""
        begun, period = work_of(counts), engine.drive[layout.PERIOD]
        while counts[layout.SETTLED] < schedule.settle:
            turns = min(SETTLED_AT_ONCE, schedule.settle - counts[layout.SETTLED])
            if counts[layout.MOST] == 0:
                counts[layout.MOST] = counts[layout.IMPACTS] + schedule.limit * turns
            outcome, _ = advance(
                engine, pose, status, turns * period, counts[layout.MOST], watch.nothing, watch.poses, counts
            )
            if outcome != layout.COMPLETE:
                return int(outcome)
            status[layout.CLOCK], counts[layout.MOST] = 0.0, 0
            counts[layout.SETTLED] += turns
            begun -= 1
            if work_of(counts) - begun >= schedule.piece:
                return layout.PAUSED
        if counts[layout.WATCHED] == 0:
            start_watching(watch, pose)
            begin_period(watch)
            counts[layout.WATCHED], counts[layout.MOST] = 1, counts[layout.IMPACTS] + schedule.limit
            status[layout.UNSEEN] = period
        return layout.COMPLETE

    return settle


def reading_kernel(read: Kernel) -> Kernel:
    """The kernel that reads off the segments of a trace, each by ``read``."""

    @kernel
    def read_off(engine: Any, own: Array, watch: Watch, counts: Index) -> int:
        """Read off the segments traced: COMPLETE, UNRESOLVED, or PAUSED, and it goes on when called again.

        A segment is as much work as its fastest mode has turns, up to ``MOST_WORK`` of ``readout``.
        """
        trace, result, work = watch.trace, watch.result, 0
        for i in range(counts[layout.READ], counts[layout.SEGMENTS]):
            if work > MOST_WORK:
                counts[layout.READ] = i
                return layout.PAUSED
            work += min(turns_of(own, trace[i, layout.DURATION]) * (own.shape[0] + 8), MOST_WORK)
            if trace[i, layout.WHAT] != layout.FREE:
                result[layout.REST_TIME] += trace[i, layout.DURATION]
            if trace[i, layout.DURATION] > 0.0:
                copy_pose(watch.poses[i], watch.frame)
                read(engine, watch, i)
            note_impact(trace, i, result)
            if is_unread(result):
                return layout.UNRESOLVED
        counts[layout.READ] = 0
        return layout.COMPLETE

    return read_off


def watching_kernel(advance: Kernel, read: Kernel) -> Kernel:
    """The kernel that watches."""
    read_off = reading_kernel(read)

    @kernel
    def watching(engine: Any, own: Array, pose: Array, status: Array, limit: int, watch: Watch, counts: Index) -> int:
        """Carry ``pose`` on to the end of the period, or of the trace, and read off what is traced."""
        period = engine.drive[layout.PERIOD]
        if counts[layout.READ] == 0:
            if status[layout.DONE] == 0.0:
                counts[layout.SEGMENTS] = 0
                status[layout.CLOCK] = period - status[layout.UNSEEN]
            outcome, done = advance(
                engine, pose, status, status[layout.UNSEEN], counts[layout.MOST], watch.trace, watch.poses, counts
            )
            if outcome == layout.PAUSED:
                return layout.PAUSED
            status[layout.UNSEEN] -= done
            counts[layout.ENDED] = outcome
        if counts[layout.KNOWN] > 0:
            note_impacts(watch, counts[layout.SEGMENTS])
        else:
            read = read_off(engine, own, watch, counts)
            if read != layout.COMPLETE:
                return int(read)
        outcome = counts[layout.ENDED]
        if outcome == layout.FULL:
            return layout.COMPLETE
        turn = counts[layout.WATCHED]
        status[layout.UNSEEN], counts[layout.MOST] = period, counts[layout.IMPACTS] + limit
        counts[layout.WATCHED] = turn + 1
        copy_pose(pose, watch.strobes[turn])
        if counts[layout.KNOWN] > 0:
            repeat_period(watch)
        elif is_same(own, engine.drive[layout.W], watch.strobes, turn):
            note_period(watch)
            counts[layout.KNOWN] = 1
        else:
            begin_period(watch)
        return int(outcome)

    return watching


@kernel
def start_watching(watch: Watch, pose: Array) -> None:
    """Nothing is seen yet."""
    watch.result[:], watch.energy[:] = 0.0, 0.0
    watch.result[layout.HIGH], watch.result[layout.LEAST], watch.result[layout.CONTACT_LEAST] = -np.inf, np.inf, np.inf
    copy_pose(pose, watch.strobes[0])


@kernel
def begin_period(watch: Watch) -> None:
    """Note energies and time at rest before a period, taken off."""
    n = watch.energy.shape[0]
    for k in range(n):
        watch.share[k] = -watch.energy[k]
    watch.share[n] = -watch.result[layout.REST_TIME]


@kernel
def note_period(watch: Watch) -> None:
    """Note energies and time at rest that the period watched since ``begin_period`` has added."""
    n = watch.energy.shape[0]
    for k in range(n):
        watch.share[k] += watch.energy[k]
    watch.share[n] += watch.result[layout.REST_TIME]


@kernel
def repeat_period(watch: Watch) -> None:
    """A period like the one watched last: the same energies and time at rest, no new extremes."""
    n = watch.energy.shape[0]
    for k in range(n):
        watch.energy[k] += watch.share[k]
    watch.result[layout.REST_TIME] += watch.share[n]


@kernel
def is_same(own: Array, w: float, strobes: Array, turn: int) -> bool:
    """True where a period began as the one before it to round-off, so that it will be the same."""
    if turn < 1:
        return False
    apart = distance(own, w, strobes, turn, turn - 1)
    return bool(apart <= SAME * SAME * distance(own, w, strobes, turn, -1))


@kernel
def is_unread(result: Array) -> bool:
    """True where the extremes of what was traced were not found in bounded work."""
    return bool(result[layout.HIGH] == np.inf or result[layout.CONTACT_LEAST] == -np.inf)


@kernel
def note_impacts(watch: Watch, count: int) -> None:
    """Count the impacts of the segments just traced, and nothing else."""
    for i in range(count):
        note_impact(watch.trace, i, watch.result)


@kernel
def note_impact(trace: Array, i: int, result: Array) -> None:
    """Count the impact that ends a segment and keep its velocity in a ring."""
    end = trace[i, layout.END]
    if end == layout.IMPACT or end == layout.CHATTER or end == layout.STUCK:
        result[layout.VELOCITY + int(result[layout.STRUCK]) % layout.KEPT] = trace[i, layout.BEFORE]
        result[layout.STRUCK] += 1.0
        result[layout.SPEED_SUM] += trace[i, layout.BEFORE]


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
