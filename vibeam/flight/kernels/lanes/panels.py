"""Panels of a plain flight, all modes of a block side by side: what ``roots.panels`` does, on ``mode_blocks``.

The first test of a panel is the cheapest one that clears it; only where that fails the others of ``roots.bounds``
follow.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import joined
from vibeam.flight.kernels.lanes import mode_blocks as row
from vibeam.flight.kernels.lanes.mode_blocks import cell, rung
from vibeam.flight.kernels.lanes.simd import Lanes, every, larger, load, size, smaller, store, total, width
from vibeam.flight.kernels.layout import FIRST_IM, FIRST_RE, SECOND_IM, SECOND_RE, STEP
from vibeam.flight.kernels.roots.bounds import CLEAR, SPLIT, THIRD, VALUE, verdict

Array = NDArray[np.float64]

OTHER = -1  # neither clear nor to be halved: a panel for ``roots.first_root``


@joined
def bound(x: Lanes, y: Lanes) -> Lanes:
    """``pair.norm``."""
    a, b = size(x), size(y)
    return larger(a, b) + smaller(a, b) * 0.41421356237309515


@joined
def to_node(cells: Array, at: int, x: Lanes, y: Lanes, like: Lanes) -> tuple[Lanes, Lanes]:
    """The node of a block goes to x, y: the E that bound the pairs from there on, and their accelerations."""
    step = width(like)
    e = bound(x, y * load(cells, at + row.NORM * step, like))
    store(cells, at + row.SIDE_X * step, x)
    store(cells, at + row.SIDE_Y * step, y)
    store(cells, at + row.SIDE_E * step, e)
    spring = load(cells, at + row.SPRING * step, like)
    return e, 0.0 - (load(cells, at + row.DAMP * step, like) * y + spring * x)


@joined
def to_start(cells: Array, blocks: int, like: Lanes) -> tuple[float, float]:
    """The node goes to the start; the sum of the E that bound the pairs, and of the pairs' accelerations."""
    whole, second = every(0.0, like), every(0.0, like)
    step = width(like)
    for b in range(blocks):
        at = cell(b, 0, like)
        x, y = load(cells, at + row.START_X * step, like), load(cells, at + row.START_Y * step, like)
        e, bend = to_node(cells, at, x, y, like)
        whole += e
        second += bend
    return total(whole), total(second)


@joined
def first_panel(
    cells: Array, rungs: Array, levels: Array, blocks: int, level: int, rise: float, zr: float, zi: float, w: float,
    fifth: float, like: Lanes,
) -> int:  # fmt: skip
    """Verdict on the first panel after an impact, by the quotient g/t; the trial ends go to the other side.

    ``fifth``: bound on the drive's fifth derivative.
    """
    step, h = width(like), levels[STEP, level]
    hidden, second, whole = every(0.0, like), every(0.0, like), every(0.0, like)
    gamma, delta, missed = every(0.0, like), every(0.0, like), every(0.0, like)
    for b in range(blocks):
        at, on = cell(b, 0, like), rung(level, blocks, b, 0, like)
        x, y = load(cells, at + row.START_X * step, like), load(cells, at + row.START_Y * step, like)
        low = load(rungs, on + row.LOW * step, like)
        g = load(rungs, on + row.D0 * step, like) * x + load(rungs, on + row.D1 * step, like) * y
        d = load(rungs, on + row.V0 * step, like) * x + load(rungs, on + row.V1 * step, like) * y
        fall = load(cells, at + row.DAMP * step, like) * y + load(cells, at + row.SPRING * step, like) * x
        x2, y2 = x + (y + g * h) * h, y + d * h
        store(cells, at + (row.SIDE_X + 3) * step, x2)
        store(cells, at + (row.SIDE_Y + 3) * step, y2)
        store(cells, at + (row.SIDE_E + 3) * step, bound(x2, y2 * load(cells, at + row.NORM * step, like)))
        missed += load(cells, at + row.SIDE_E * step, like) * load(rungs, on + row.MISSED_FIRST * step, like)
        hidden += y - low * y
        second -= low * fall
        gamma += low * g
        delta += low * d
        whole += g
    drawn = zr * levels[SECOND_IM, level] + zi * levels[SECOND_RE, level]
    start, bend = rise - total(hidden), total(gamma) + drawn
    slope = 0.5 * (total(second) - w * w * zi)
    end = start + h * bend
    end_slope = total(delta) + w * (zr * levels[FIRST_RE, level] - zi * levels[FIRST_IM, level]) - bend
    least = min(min(start, start + THIRD * h * slope), min(end - THIRD * h * end_slope, end))
    if least > total(missed) + 0.2 * VALUE * fifth * (h * h) * (h * h):
        return CLEAR
    return SPLIT if rise + h * (total(whole) + drawn) > 0.0 else OTHER


@joined
def advance_panel(
    cells: Array, rungs: Array, blocks: int, whole: int, level: int, side: int, like: Lanes
) -> tuple[float, float, float]:
    """Trial ends from the node on ``side``, on the other: value and slope of what the panel resolves, what it misses.

    ``blocks``: those that still ring, of ``whole``.
    """
    step, here, there = width(like), 3 * side * width(like), 3 * (1 - side) * width(like)
    value, slope, missed = every(0.0, like), every(0.0, like), every(0.0, like)
    for b in range(blocks):
        at, on = cell(b, 0, like), rung(level, whole, b, 0, like)
        x, y = load(cells, at + row.SIDE_X * step + here, like), load(cells, at + row.SIDE_Y * step + here, like)
        x2 = load(rungs, on + row.P00 * step, like) * x + load(rungs, on + row.P01 * step, like) * y
        y2 = load(rungs, on + row.P10 * step, like) * x + load(rungs, on + row.P11 * step, like) * y
        store(cells, at + row.SIDE_X * step + there, x2)
        store(cells, at + row.SIDE_Y * step + there, y2)
        store(cells, at + row.SIDE_E * step + there, bound(x2, y2 * load(cells, at + row.NORM * step, like)))
        missed += load(cells, at + row.SIDE_E * step + here, like) * load(rungs, on + row.MISSED * step, like)
        low = load(rungs, on + row.LOW * step, like)
        value += low * x2
        slope += low * y2
    return total(value), total(slope), total(missed)


@joined
def resolved(
    cells: Array, rungs: Array, blocks: int, whole: int, level: int, side: int, like: Lanes
) -> tuple[float, float]:
    """Value and slope at the node of what a panel of that length resolves."""
    step, here = width(like), 3 * side * width(like)
    value, slope = every(0.0, like), every(0.0, like)
    for b in range(blocks):
        at, low = cell(b, 0, like), load(rungs, rung(level, whole, b, row.LOW, like), like)
        value += low * load(cells, at + row.SIDE_X * step + here, like)
        slope += low * load(cells, at + row.SIDE_Y * step + here, like)
    return total(value), total(slope)


@joined
def closer(
    cells: Array, rungs: Array, blocks: int, whole: int, level: int, side: int, h: float, p0: float, s0: float,
    p1: float, s1: float, fourth: float, gone: tuple[float, float, float], tolerance: float, like: Lanes,
) -> tuple[int, float, float, float, float, float, float]:  # fmt: skip
    """``bounds.verdict`` on the panel just tried; the whole signal's value and slope at its ends, and at both the
    second derivative of the pairs that it resolves.

    ``gone``: bounds on value, slope and curvature of the blocks left out.
    """
    step, here, there = width(like), 3 * side * width(like), 3 * (1 - side) * width(like)
    begin, begin_slope, end, end_slope = every(0.0, like), every(0.0, like), every(0.0, like), every(0.0, like)
    slack0, slack1, slack2, high = every(0.0, like), every(0.0, like), every(0.0, like), every(0.0, like)
    bend0, bend1 = every(0.0, like), every(0.0, like)
    for b in range(blocks):
        at, low = cell(b, 0, like), load(rungs, rung(level, whole, b, row.LOW, like), like)
        rest = 1.0 - low
        damp, spring = low * load(cells, at + row.DAMP * step, like), low * load(cells, at + row.SPRING * step, like)
        e = load(cells, at + row.SIDE_E * step + here, like)
        x, y = load(cells, at + row.SIDE_X * step + here, like), load(cells, at + row.SIDE_Y * step + here, like)
        begin += rest * x
        begin_slope += rest * y
        bend0 -= damp * y + spring * x
        x, y = load(cells, at + row.SIDE_X * step + there, like), load(cells, at + row.SIDE_Y * step + there, like)
        end += rest * x
        end_slope += rest * y
        bend1 -= damp * y + spring * x
        high += low * e * load(cells, at + row.K4 * step, like)
        slack0 += rest * e
        slack1 += rest * e * load(cells, at + row.K1 * step, like)
        slack2 += rest * e * load(cells, at + row.K2 * step, like)
    last, last_slope = p1 + total(end), s1 + total(end_slope)
    found = verdict(
        p0, s0, p1, s1, h, fourth + total(high), total(slack0) + gone[0], total(slack1) + gone[1],
        total(slack2) + gone[2], last, last_slope, tolerance,
    )  # fmt: skip
    return found, p0 + total(begin), s0 + total(begin_slope), last, last_slope, total(bend0), total(bend1)
