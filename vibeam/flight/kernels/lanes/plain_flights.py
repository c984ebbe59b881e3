"""Plain flights by blocks of modes: from one impact to the next clean one, as nearly every impact is reached.

The walk is that over panels of ``first_root`` with the closed form of ``newton``, without what is seldom asked: a
flight that grazes, ends within its first panel, or may belong to a chatter is left to ``events``, untouched. From
impact to impact the pairs never leave their blocks.
"""

from __future__ import annotations

from typing import NamedTuple

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.drive import wrap
from vibeam.flight.kernels.impact import is_faint, narrowing, put_on_stop
from vibeam.flight.kernels.lanes import layout as row
from vibeam.flight.kernels.lanes.landing import (
    ALOFT,
    STRUCK,
    UNUSUAL,
    Bracket,
    Landing,
    at_root,
    drive_phasor,
    foretold,
    land_on,
    no_landing,
    phase_at,
)
from vibeam.flight.kernels.lanes.layout import BlockPanel, Forced
from vibeam.flight.kernels.lanes.panels import (
    OTHER,
    advance_panel,
    cell,
    closer,
    first_panel,
    gather,
    resolved,
    scatter,
    to_node,
    to_start,
)
from vibeam.flight.kernels.lanes.simd import Lanes, every, load, store, total, width
from vibeam.flight.kernels.layout import Engine, Phase
from vibeam.flight.kernels.modal_flow import begin_flight, is_plain_start
from vibeam.flight.kernels.roots.bounds import CLEAR, ROOT, SPLIT, THIRD, VALUE, Bounds, PanelEnds
from vibeam.flight.kernels.roots.newton import EPSILON
from vibeam.flight.kernels.roots.pair import level_of, norm
from vibeam.flight.kernels.segments import MotionRecord, Progress, add, close_segment, open_segment
from vibeam_models.arrays import Array

MOST = 10_000  # panels
QUIET = 1e-3  # share of the tolerance below which a block is left out of the panels
CARRIED, NOT_PLAIN, AT_STOP = 0, 1, 2


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
    panel, panels, time, re, im = BlockPanel(blocks, blocks, coarsest, 0), 0, 0.0, forced.re, forced.im
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
        panel = BlockPanel(blocks, blocks, level, 1)
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
            found, ends, bend0, bend1 = closer(engine, panel, PanelEnds(p0, s0, p1, s1), others, tolerance, like)
            if found == ROOT:
                bend0, bend1 = bend0 - w * w * im, bend1 - w * w * im2
                u = foretold(ends.p0, h * ends.s0, h * h * bend0, ends.p1, h * ends.s1, h * h * bend1)
                landing = at_root(engine, panel, forced, launch.clock, Bracket(time, time + h * u, time + h), like)
                if landing.outcome == STRUCK and landing.time > span:
                    landing = no_landing(ALOFT, span)
                return landing, panels, first
            if found == SPLIT and panel.level < layout.LEVELS - 1:
                panel = BlockPanel(panel.blocks, blocks, panel.level + 1, panel.side)
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
        panel = BlockPanel(ringing, blocks, level, side)
    return no_landing(ALOFT, span), panels, first


@joined
def strike(cells: Array, blocks: int, beyond: float, impulse: float, like: Lanes) -> tuple[float, float]:
    """The pairs after the impact, at the start and the node; the sums of their e and accelerations.

    η' ← η' − w (1 + R) v/S, S = w·w, hence x' ← x' + w²/S ``impulse``, ``impulse`` = (1 + R) times the velocity before;
    and the contact is put exactly on the stop in the direction of least energy, δη ∝ w/ω².
    """
    step = width(like)
    whole, second = every(0.0, like), every(0.0, like)
    for b in range(blocks):
        at = cell(b, 0, like)
        x = load(cells, at + row.ROOT_X * step, like) - load(cells, at + row.PUT * step, like) * beyond
        y = load(cells, at + row.ROOT_Y * step, like) + load(cells, at + row.KICK * step, like) * impulse
        store(cells, at + row.START_X * step, x)
        store(cells, at + row.START_Y * step, y)
        e, bend = to_node(cells, at, x, y, like)
        whole += e
        second += bend
    return total(whole), total(second)


@joined
def note(status: Array, clock: float, phase: Phase, order: float, rise: float, speed: float) -> None:
    """Set ``status`` to where the motion stands."""
    status[layout.CLOCK], status[layout.PHASE_COS], status[layout.PHASE_SIN] = clock, phase.cosine, phase.sine
    status[layout.ORDER], status[layout.RISE], status[layout.SPEED] = order, rise, speed


@kernel
def plain_flights_in_lanes(
    engine: Engine, pose: Array, status: Array, progress: Progress, most: int, record: MotionRecord, like: Lanes
) -> tuple[int, float, float, float]:
    """Flights and impacts, carried on from the time done toward the span: why it ends, done, lost, last flight.

    ``pose`` and ``status`` end where time, rows or impacts (``most``) are used up, at the start of a flight that is
    NOT_PLAIN, or AT_STOP, at the end of a flight whose impact may belong to a chatter and is still to be struck.
    """
    span, done, lost = progress
    trace, poses, counts = record
    modes, drive, cells = engine.modes, engine.drive, engine.cells
    value, _, size = begin_flight(engine, pose, status[layout.PHASE_COS], status[layout.PHASE_SIN])
    if not is_plain_start(status[layout.ORDER], value, size):
        return NOT_PLAIN, done, lost, 0.0
    gather(engine.pairs, cells, like)
    n, rows = pose.shape[1], trace.shape[0]
    blocks = (n + width(like) - 1) // width(like)
    const, w, restitution = drive[layout.CLEARANCE], drive[layout.W], drive[layout.RESTITUTION]
    coarsest = int(drive[layout.COARSEST])
    loss, gap = narrowing(1.0 - restitution), abs(drive[layout.GAP])
    order, rise, speed = status[layout.ORDER], status[layout.RISE] * status[layout.ORDER], status[layout.SPEED]
    clock = status[layout.CLOCK]
    phase, zr = Phase(status[layout.PHASE_COS], status[layout.PHASE_SIN]), engine.signal[layout.ZR]
    zi = engine.signal[layout.ZI]
    forced = Forced(const, zr, zi, w, norm(zr, zi))
    sum_e, second = to_start(cells, blocks, like)
    what, t, begun, first = STRUCK, 0.0, done, coarsest
    while done < span and counts[layout.IMPACTS] < most and (rows == 0 or counts[layout.SEGMENTS] < rows):
        if rows > 0:
            if done > begun:
                scatter(engine, pose, row.START_X, phase, like)
                put_on_stop(modes, drive, pose)
                note(status, clock, phase, order, rise, speed)
            open_segment(trace, poses, pose, status, done, counts[layout.SEGMENTS])
        watch = min(span - done, drive[layout.LONGEST])
        launch = Launch(clock, rise, second - w * w * forced.im, sum_e)
        landing, panels, first = flight(engine, blocks, forced, launch, watch, coarsest, max(coarsest, first - 1), like)
        what, t = landing.outcome, landing.time
        counts[layout.PANELS] += panels
        if what == UNUSUAL or (what == ALOFT and watch < span - done):
            what = UNUSUAL
            break
        clock2 = wrap(drive, clock + t)
        if what == ALOFT:
            land_on(cells, engine.pairs, blocks, t, like)
            phase = phase_at(drive, clock2)
            scatter(engine, pose, row.ROOT_X, phase, like)
            note(status, clock2, phase, 0.0, 0.0, speed)
            close_segment(trace, t, layout.SPAN_END, 0.0, counts)
            return CARRIED, span, lost, t
        zr, zi = drive_phasor(drive, landing.phase)
        before = max(-landing.slope, 0.0)
        after, top = restitution * before, max(speed, before)
        sum_e, second = strike(cells, blocks, landing.value, (1.0 + restitution) * before, like)
        toward = w * w * zi - second
        done, lost = add(done, lost, t)
        phase, clock, speed, forced = landing.phase, clock2, top, Forced(const, zr, zi, w, norm(zr, zi))
        if after <= 0.0 or is_faint(after, top, toward, loss, gap):
            scatter(engine, pose, row.ROOT_X, phase, like)
            note(status, clock, phase, 0.0, 0.0, speed)
            return AT_STOP, done, lost, t
        counts[layout.IMPACTS] += 1
        order, rise = 1.0, after
        close_segment(trace, t, layout.IMPACT, before, counts)
    if done > begun:  # or else nothing has changed, and not a digit shall
        scatter(engine, pose, row.START_X, phase, like)
        put_on_stop(modes, drive, pose)
        note(status, clock, phase, order, rise, speed)
    return NOT_PLAIN if what == UNUSUAL else CARRIED, done, lost, t
