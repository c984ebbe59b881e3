"""Panels of a plain flight, all modes of a block side by side: what ``roots.panels`` does, on ``cells`` and ``rungs``.

The first test of a panel is the cheapest one that clears it; only where that fails the others of ``roots.bounds``
follow.
"""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined
from vibeam.flight.kernels.lanes import layout as row
from vibeam.flight.kernels.lanes.layout import BlockPanel, Forced
from vibeam.flight.kernels.lanes.simd import Lanes, every, larger, load, size, smaller, store, total, width
from vibeam.flight.kernels.layout import Engine, Phase
from vibeam.flight.kernels.roots.bounds import CLEAR, SPLIT, THIRD, VALUE, Bounds, PanelEnds, verdict
from vibeam_models.arrays import Array


@joined
def cell(block: int, of: int, like: Lanes) -> int:
    """Place at which a row of a block begins."""
    lanes: int = width(like)
    return (block * row.CELL_ROWS + of) * lanes


@joined
def rung(level: int, blocks: int, block: int, of: int, like: Lanes) -> int:
    """Place at which a row of a block at one panel length begins."""
    lanes: int = width(like)
    return ((level * blocks + block) * row.RUNG_ROWS + of) * lanes


@joined
def at_mode(k: int, of: int, like: Lanes) -> int:
    """Place of mode k's number in a row."""
    lanes: int = width(like)
    return ((k // lanes) * row.CELL_ROWS + of) * lanes + k % lanes


@joined
def gather(pairs: Array, cells: Array, like: Lanes) -> None:
    """START_X, START_Y receive the pairs x, x' at the start of a flight, from ``begin_flight``."""
    for k in range(pairs.shape[1]):
        cells[at_mode(k, row.START_X, like)] = pairs[layout.X0, k]
        cells[at_mode(k, row.START_Y, like)] = pairs[layout.Y0, k]


@joined
def scatter(engine: Engine, pose: Array, of: int, phase: Phase, like: Lanes) -> None:
    """Set ``pose`` to the pairs in ``of`` and the next, at that phase φ.

    η_k = −x_k/w_k + Im(H_k e^{iφ}) + s_k/ω_k², η_k' = −x_k'/w_k + Ω Re(H_k e^{iφ}).
    """
    cells, modes, w = engine.cells, engine.modes, engine.drive[layout.W]
    cosine, sine = phase
    for k in range(pose.shape[1]):
        c = modes[layout.CONTACT, k]
        offset, re, im = modes[layout.OFFSET, k], modes[layout.RE, k], modes[layout.IM, k]
        pose[0, k] = -cells[at_mode(k, of, like)] / c + offset + re * sine + im * cosine
        pose[1, k] = -cells[at_mode(k, of + 1, like)] / c + w * (re * cosine - im * sine)


OTHER = -1  # neither clear nor to be halved: a panel for ``roots.first_root``


@joined
def bound(x: Lanes, y: Lanes) -> Lanes:
    """max(|x|, |y|) + (√2 − 1) min(|x|, |y|) ≥ √(x² + y²): ``pair.norm``."""
    a, b = size(x), size(y)
    return larger(a, b) + smaller(a, b) * 0.41421356237309515


@joined
def to_node(cells: Array, at: int, x: Lanes, y: Lanes, like: Lanes) -> tuple[Lanes, Lanes]:
    """The node of a block goes to x, x': the e ≥ √(x² + (x'/ω)²) that bound |x| from there on, and −2σx' − ω²x."""
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
def first_panel(engine: Engine, blocks: int, level: int, rise: float, forced: Forced, fifth: float, like: Lanes) -> int:
    """Verdict on the first panel after an impact, by the quotient p = g/t; the trial ends go to the other side.

    p(0) = ``rise``, p'(0) = ½g''(0), p(h) = rise + hγ, p'(h) = δ − γ (``signal.quotient``, m = 1), |p⁗| ≤ M₅/5, M₅ ≤
    ``fifth`` + Σ κ⁵e, ``fifth`` the bound Ω⁵|z| of the drive's part.
    """
    cells, rungs, levels = engine.cells, engine.rungs, engine.levels
    zr, zi, w = forced.re, forced.im, forced.omega
    step, h = width(like), levels[layout.STEP, level]
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
    drawn = zr * levels[layout.SECOND_IM, level] + zi * levels[layout.SECOND_RE, level]
    start, bend = rise - total(hidden), total(gamma) + drawn
    slope = 0.5 * (total(second) - w * w * zi)
    end = start + h * bend
    end_slope = total(delta) + w * (zr * levels[layout.FIRST_RE, level] - zi * levels[layout.FIRST_IM, level]) - bend
    least = min(min(start, start + THIRD * h * slope), min(end - THIRD * h * end_slope, end))
    if least > total(missed) + 0.2 * VALUE * fifth * (h * h) * (h * h):
        return CLEAR
    return SPLIT if rise + h * (total(whole) + drawn) > 0.0 else OTHER


@joined
def advance_panel(engine: Engine, panel: BlockPanel, like: Lanes) -> tuple[float, float, float]:
    """Trial ends from the node, on the other side: value and slope of what the panel resolves, what its hull misses.

    x ← P00 x + P01 x', x' ← P10 x + P11 x'; missed is Σ κ⁴e h⁴/384 of the pairs resolved and Σ e of the others.
    """
    cells, rungs = engine.cells, engine.rungs
    blocks, whole, level, side = panel
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
def resolved(engine: Engine, panel: BlockPanel, like: Lanes) -> tuple[float, float]:
    """Value Σ x and slope Σ x' at the node, over the pairs that a panel of that length resolves."""
    cells, rungs = engine.cells, engine.rungs
    blocks, whole, level, side = panel
    step, here = width(like), 3 * side * width(like)
    value, slope = every(0.0, like), every(0.0, like)
    for b in range(blocks):
        at, low = cell(b, 0, like), load(rungs, rung(level, whole, b, row.LOW, like), like)
        value += low * load(cells, at + row.SIDE_X * step + here, like)
        slope += low * load(cells, at + row.SIDE_Y * step + here, like)
    return total(value), total(slope)


@joined
def closer(
    engine: Engine, panel: BlockPanel, part: PanelEnds, others: Bounds, tolerance: float, like: Lanes
) -> tuple[int, PanelEnds, float, float]:
    """``bounds.verdict`` on the panel just tried; the whole signal's value and slope at its ends, and at both the
    second derivative of the pairs that it resolves.

    ``part``: ends of what is resolved. ``others``: Ω⁴|z| of the drive; value, slope, curvature of the blocks left out.
    """
    cells, rungs, h = engine.cells, engine.rungs, engine.levels[layout.STEP, panel.level]
    blocks, whole, level, side = panel
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
    last, last_slope = part.p1 + total(end), part.s1 + total(end_slope)
    value, slope = total(slack0) + others.value, total(slack1) + others.slope
    bounds = Bounds(others.fourth + total(high), value, slope, total(slack2) + others.curvature)
    found = verdict(part, h, bounds, last, last_slope, tolerance)
    ends = PanelEnds(part.p0 + total(begin), part.s0 + total(begin_slope), last, last_slope)
    return found, ends, total(bend0), total(bend1)
