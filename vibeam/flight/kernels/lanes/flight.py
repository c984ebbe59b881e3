"""Plain flight by blocks of modes: from one impact to the next clean one, as nearly every impact is reached.

It is the walk over panels of ``first_root`` and the closed form of ``newton`` without what is seldom asked: a flight
that grazes, ends within its first panel, or may belong to a chatter is left to ``events``, untouched.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined
from vibeam.flight.kernels.lanes import layout as row
from vibeam.flight.kernels.lanes.landing import (
    ALOFT,
    STRUCK,
    UNUSUAL,
    Bracket,
    Forced,
    Landing,
    at_root,
    foretold,
    no_landing,
)
from vibeam.flight.kernels.lanes.layout import Panel
from vibeam.flight.kernels.lanes.mode_blocks import cell
from vibeam.flight.kernels.lanes.panels import OTHER, advance_panel, closer, first_panel, resolved
from vibeam.flight.kernels.lanes.simd import Lanes, load, total, width
from vibeam.flight.kernels.layout import Engine
from vibeam.flight.kernels.roots.bounds import CLEAR, ROOT, SPLIT, THIRD, VALUE, Bounds, Ends
from vibeam.flight.kernels.roots.levels import level_of
from vibeam.flight.kernels.roots.newton import EPSILON

Array = NDArray[np.float64]

MOST = 10_000  # panels

QUIET = 1e-3  # share of the tolerance below which a block is left out of the panels


class Launch(NamedTuple):
    """Start of a flight: the drive's time; g'(0) just after an impact, or 0 off the stop; g''(0); Σ e."""

    clock: float
    rise: float
    acceleration: float
    size: float


@joined
def turn(levels: Array, level: int, re: float, im: float) -> tuple[float, float]:
    """A phasor of the drive one panel on: z e^{iΩh}."""
    c, s = levels[layout.TURN_RE, level], levels[layout.TURN_IM, level]
    return re * c - im * s, im * c + re * s


@joined
def left(cells: Array, b: int, side: int, like: Lanes) -> tuple[float, float, float]:
    """Bounds Σ e, Σ κe, Σ κ²e on value, slope and curvature of a block from the node on."""
    step, at = width(like), cell(b, 0, like)
    e = load(cells, at + (row.SIDE_E + 3 * side) * step, like)
    k1, k2 = load(cells, at + row.K1 * step, like), load(cells, at + row.K2 * step, like)
    return total(e), total(e * k1), total(e * k2)


@joined
def flight(
    engine: Engine, blocks: int, forced: Forced, launch: Launch, span: float, coarsest: int, first: int, like: Lanes
) -> tuple[Landing, int, int]:
    """One flight from START_X, START_Y: its end, the panels tried, the level that served first after an impact.

    STRUCK, ALOFT (not within ``span``) or UNUSUAL: not to be told here. A panel is clear where the hull of its cubic
    Hermite interpolant is above M₄h⁴/384 + slack, M₄ = Ω⁴|z| + Σ κ⁴e; ``closer`` gives the other verdicts of
    ``roots.bounds``. ``first``: the level to try first after an impact.
    """
    cells, levels, w = engine.cells, engine.levels, forced.omega
    tolerance = 8.0 * EPSILON * (abs(forced.const) + forced.size + launch.size)
    others = Bounds(forced.size * (w * w) * (w * w), 0.0, 0.0, 0.0)  # of the drive, and of the blocks left out
    quiet = QUIET * tolerance / blocks
    panel, panels, time, re, im = Panel(blocks, blocks, coarsest, 0), 0, 0.0, forced.re, forced.im
    since, patience, lengthened, stale = 0, 1, False, True
    p0, s0 = 0.0, 0.0
    if launch.rise > 0.0:
        level = first
        if levels[layout.STEP, coarsest] * -launch.acceleration > 4.0 * launch.rise:
            level = max(coarsest, level_of(levels, -4.0 * launch.rise / launch.acceleration))
        found = SPLIT
        while found == SPLIT:
            panels += 1
            found = first_panel(engine, blocks, level, launch.rise, forced, others.fourth * w, like)
            if found == OTHER or level == layout.LEVELS - 1:
                return no_landing(UNUSUAL, 0.0), panels, first
            level += 1 if found == SPLIT else 0
        time, since, first = levels[layout.STEP, level], 1, level
        panel = Panel(blocks, blocks, level, 1)
        re, im = turn(levels, level, re, im)
    while time < span:
        panels += 1
        if panels > MOST:
            return no_landing(UNUSUAL, 0.0), panels, first
        h = levels[layout.STEP, panel.level]
        if stale:
            p0, s0 = resolved(engine, panel, like)
            p0, s0, stale = p0 + (forced.const + im), s0 + w * re, False
        re2, im2 = turn(levels, panel.level, re, im)
        p1, s1, missed = advance_panel(engine, panel, like)
        p1, s1 = p1 + (forced.const + im2), s1 + w * re2
        missed += VALUE * others.fourth * (h * h) * (h * h) + tolerance + others.value
        if not min(min(p0, p0 + THIRD * h * s0), min(p1 - THIRD * h * s1, p1)) > missed:
            found, ends, bend0, bend1 = closer(engine, panel, Ends(p0, s0, p1, s1), others, tolerance, like)
            if found == ROOT:
                bend0, bend1 = bend0 - w * w * im, bend1 - w * w * im2
                u = foretold(ends.p0, h * ends.s0, h * h * bend0, ends.p1, h * ends.s1, h * h * bend1)
                landing = at_root(engine, panel, forced, launch.clock, Bracket(time, time + h * u, time + h), like)
                if landing.outcome == STRUCK and landing.time > span:
                    landing = no_landing(ALOFT, span)
                return landing, panels, first
            if found == SPLIT and panel.level < layout.LEVELS - 1:
                panel = Panel(panel.blocks, blocks, panel.level + 1, panel.side)
                patience = min(max(1, 2 * patience), 64) if lengthened else patience
                since, lengthened, stale = 0, False, True
                continue
            if found != CLEAR:
                return no_landing(UNUSUAL, 0.0), panels, first
        p0, s0, re, im, time = p1, s1, re2, im2, time + h
        ringing, level, side = panel.blocks, panel.level, 1 - panel.side
        since += 1
        patience = patience // 2 if lengthened else patience
        lengthened = False
        if level > coarsest and since > patience:
            level, since, lengthened, stale = level - 1, 0, True, True
        while ringing > 1:
            e, slope, curvature = left(cells, ringing - 1, side, like)
            if e > quiet:
                break
            ringing, stale = ringing - 1, True
            others = Bounds(others.fourth, others.value + e, others.slope + slope, others.curvature + curvature)
        panel = Panel(ringing, blocks, level, side)
    return no_landing(ALOFT, span), panels, first
