"""Segments of a motion as it goes on: a row for each, and the time done."""

from __future__ import annotations

from typing import NamedTuple

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined
from vibeam_models.arrays import Array, Index


class MotionRecord(NamedTuple):
    """Record of a motion: a row and the first pose of every segment (none where there are no rows), counts."""

    trace: Array  # (m, TRACE_COLUMNS)
    poses: Array  # (m, 2, n)
    counts: Index  # (COUNT_ROWS,)


class Progress(NamedTuple):
    """Time to go in all, time done and what rounding it has cost so far (see ``add``)."""

    span: float
    done: float
    lost: float


@joined
def open_segment(trace: Array, poses: Array, pose: Array, status: Array, time: float, row: int) -> None:
    """Note where a segment starts."""
    trace[row, layout.START], trace[row, layout.AT_CLOCK] = time, status[layout.CLOCK]
    trace[row, layout.WHAT] = status[layout.KIND]
    trace[row, layout.LEFT], trace[row, layout.REMAINDER] = 0.0, 0.0
    copy_pose(pose, poses[row])


@joined
def close_segment(trace: Array, duration: float, end: int, before: float, counts: Index) -> None:
    """Note how long it was and what ended it."""
    if trace.shape[0] > 0:
        row = counts[layout.SEGMENTS]
        trace[row, layout.DURATION], trace[row, layout.END], trace[row, layout.BEFORE] = duration, end, before
        counts[layout.SEGMENTS] = row + 1


@joined
def note_chatter(record: MotionRecord, left: float, remainder: float) -> None:
    """Note what a chatter still takes after the impact that ends this segment, and the bound of its error."""
    if record.trace.shape[0] > 0:
        row = record.counts[layout.SEGMENTS]
        record.trace[row, layout.LEFT], record.trace[row, layout.REMAINDER] = left, remainder


@joined
def copy_pose(source: Array, target: Array) -> None:
    """Set the pose ``target`` (2, n) to ``source``."""
    for k in range(target.shape[1]):
        target[0, k], target[1, k] = source[0, k], source[1, k]


@joined
def add(done: float, lost: float, step: float) -> tuple[float, float]:
    """done + step with what rounding has cost so far, and will have then (Kahan): times do not drift."""
    step -= lost
    total = done + step
    return total, (total - done) - step


@joined
def turns_of(own: Array, time: float) -> int:
    """About the panels that a look at all turns of the fastest mode may take, which no count tells; bounded."""
    fastest = 0.0
    for k in range(own.shape[0]):
        fastest = max(fastest, own[k])
    return int(min(fastest * time, 1e9))


@joined
def work_of(counts: Index) -> int:
    """Work done so far, in panels."""
    return int(counts[layout.IMPACTS] + counts[layout.PANELS])
