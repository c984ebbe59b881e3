"""Plain flight by blocks of modes: from one impact to the next clean one, as nearly every impact is reached.

It is the walk over panels of ``first_root`` and the closed form of ``newton`` without what is seldom asked: a flight
that grazes, ends within its first panel, or may belong to a chatter is left to ``events``, untouched.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import joined
from vibeam.flight.kernels.lanes import mode_blocks as row
from vibeam.flight.kernels.lanes.landing import at_root, foretold
from vibeam.flight.kernels.lanes.mode_blocks import cell
from vibeam.flight.kernels.lanes.panels import OTHER, advance_panel, closer, first_panel, resolved
from vibeam.flight.kernels.lanes.simd import Lanes, load, total, width
from vibeam.flight.kernels.layout import LEVELS, STEP, TURN_IM, TURN_RE
from vibeam.flight.kernels.roots.bounds import CLEAR, ROOT, SPLIT, THIRD, VALUE
from vibeam.flight.kernels.roots.levels import level_of
from vibeam.flight.kernels.roots.newton import EPSILON
from vibeam.flight.kernels.roots.pair import norm

Array = NDArray[np.float64]

STRUCK, ALOFT, UNUSUAL = 0, 1, 2

MOST = 10_000  # panels

QUIET = 1e-3  # share of the tolerance below which a block is left out of the panels


@joined
def turn(levels: Array, level: int, re: float, im: float) -> tuple[float, float]:
    """A phasor of the drive one panel on."""
    c, s = levels[TURN_RE, level], levels[TURN_IM, level]
    return re * c - im * s, im * c + re * s


@joined
def left(cells: Array, b: int, side: int, like: Lanes) -> tuple[float, float, float]:
    """Bounds on value, slope and curvature of a block from the node on."""
    step, at = width(like), cell(b, 0, like)
    e = load(cells, at + (row.SIDE_E + 3 * side) * step, like)
    k1, k2 = load(cells, at + row.K1 * step, like), load(cells, at + row.K2 * step, like)
    return total(e), total(e * k1), total(e * k2)


@joined
def flight(
    cells: Array, rungs: Array, levels: Array, pairs: Array, drive: Array, whole: int, const: float, zr: float,
    zi: float, w: float, sum_e: float, ahead: float, rise: float, clock: float, span: float, coarsest: int,
    first: int, like: Lanes,
) -> tuple[int, int, int, float, float, float, float, float]:  # fmt: skip
    """One flight from START_X, START_Y: what ended it, panels, its time; as ``landing.at_root`` tells the rest.

    STRUCK, ALOFT (not within ``span``) or UNUSUAL: not to be told here. ``sum_e``: the sum of the E at the start;
    ``ahead``: the gap's second derivative there; ``rise``: its velocity just after an impact, or 0 off the stop;
    ``first``: the level to try first after an impact, given back as the one that served.
    """
    harmonic = norm(zr, zi)
    tolerance = 8.0 * EPSILON * (abs(const) + harmonic + sum_e)
    fourth = harmonic * (w * w) * (w * w)
    quiet = QUIET * tolerance / whole
    level, side, blocks, panels, time, re, im = coarsest, 0, whole, 0, 0.0, zr, zi
    since, patience, lengthened, stale = 0, 1, False, True
    p0, s0, gone0, gone1, gone2 = 0.0, 0.0, 0.0, 0.0, 0.0
    if rise > 0.0:
        level = first
        if levels[STEP, coarsest] * -ahead > 4.0 * rise:
            level = max(coarsest, level_of(levels, -4.0 * rise / ahead))
        found = SPLIT
        while found == SPLIT:
            panels += 1
            found = first_panel(cells, rungs, levels, whole, level, rise, zr, zi, w, fourth * w, like)
            if found == OTHER or level == LEVELS - 1:
                return UNUSUAL, panels, first, 0.0, 1.0, 0.0, 0.0, 0.0
            level += 1 if found == SPLIT else 0
        time, side, since, first = levels[STEP, level], 1, 1, level
        re, im = turn(levels, level, zr, zi)
    while time < span:
        panels += 1
        if panels > MOST:
            return UNUSUAL, panels, first, 0.0, 1.0, 0.0, 0.0, 0.0
        h = levels[STEP, level]
        if stale:
            p0, s0 = resolved(cells, rungs, blocks, whole, level, side, like)
            p0, s0, stale = p0 + (const + im), s0 + w * re, False
        re2, im2 = turn(levels, level, re, im)
        p1, s1, missed = advance_panel(cells, rungs, blocks, whole, level, side, like)
        p1, s1 = p1 + (const + im2), s1 + w * re2
        missed += VALUE * fourth * (h * h) * (h * h) + tolerance + gone0
        if not min(min(p0, p0 + THIRD * h * s0), min(p1 - THIRD * h * s1, p1)) > missed:
            found, q0, r0, q1, r1, bend0, bend1 = closer(
                cells, rungs, blocks, whole, level, side, h, p0, s0, p1, s1, fourth, (gone0, gone1, gone2), tolerance,
                like,
            )  # fmt: skip
            if found == ROOT:
                bend0, bend1 = bend0 - w * w * im, bend1 - w * w * im2
                guess = time + h * foretold(q0, h * r0, h * h * bend0, q1, h * r1, h * h * bend1)
                done, t, cosine, sine, value, slope = at_root(
                    cells, pairs, drive, const, whole, side, clock, guess, time, time + h, harmonic, like
                )
                if done and t > span:
                    return ALOFT, panels, first, span, 1.0, 0.0, 0.0, 0.0
                return STRUCK if done else UNUSUAL, panels, first, t, cosine, sine, value, slope
            if found == SPLIT and level < LEVELS - 1:
                level += 1
                patience = min(max(1, 2 * patience), 64) if lengthened else patience
                since, lengthened, stale = 0, False, True
                continue
            if found != CLEAR:
                return UNUSUAL, panels, first, 0.0, 1.0, 0.0, 0.0, 0.0
        p0, s0, re, im, side, time = p1, s1, re2, im2, 1 - side, time + h
        since += 1
        patience = patience // 2 if lengthened else patience
        lengthened = False
        if level > coarsest and since > patience:
            level, since, lengthened, stale = level - 1, 0, True, True
        while blocks > 1:
            e, slope, curvature = left(cells, blocks - 1, side, like)
            if e > quiet:
                break
            blocks, stale = blocks - 1, True
            gone0, gone1, gone2 = gone0 + e, gone1 + slope, gone2 + curvature
    return ALOFT, panels, first, span, 1.0, 0.0, 0.0, 0.0
