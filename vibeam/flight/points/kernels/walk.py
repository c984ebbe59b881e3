"""Flights of all lanes at once, panel by panel, up to the panel in which each lane's gap has its one root.

The mathematics is that of ``lanes.plain_flights``, with points in the lanes in place of modes; no number of one lane
depends on another lane.
"""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.lanes.panels import bound
from vibeam.flight.kernels.lanes.simd import (
    below,
    eight,
    equal,
    every,
    larger,
    load,
    lowest,
    pick,
    quotient,
    size,
    smaller,
    store,
)
from vibeam.flight.kernels.roots.bounds import SLOPE, THIRD, VALUE
from vibeam.flight.kernels.roots.newton import EPSILON
from vibeam.flight.points.kernels import layout as row
from vibeam.flight.points.kernels.layout import LaneRows
from vibeam.flight.points.kernels.rows import blend, get, mode, modes_of, put, take_first_panel, take_panel

MOST = 96  # panels of one flight, before it is left to the one engine
DEEP = 6  # levels below the coarsest at which a minimum near 0 is left to the one engine
WIDE = 20.0  # how much more than its error a first panel's hull must be above 0 for the next one to be tried longer


@kernel
def try_first_panels(rows: LaneRows) -> tuple[int, int, int]:
    """Lanes whose first panel after an impact is clear, those for which it is to be halved, and those far from both.

    By the quotient p = g/t: see ``lanes.panels.first_panel``. X2, Y2, E2 receive the pairs at its end.
    """
    common, modal, like = rows.common, rows.modal, eight()
    w, zr, zi = get(common, row.OMEGA, like), get(common, row.P0, like), get(common, row.S0, like)
    h, rise = get(common, row.STEP_1, like), get(common, row.RISE, like)
    nought = every(0.0, like)
    hidden, second, whole, gamma, delta, missed = nought, nought, nought, nought, nought, nought
    for k in range(modes_of(rows)):
        x, y = load(modal, mode(k, row.START_X), like), load(modal, mode(k, row.START_Y), like)
        low = load(modal, mode(k, row.LOW_1), like)
        g = load(modal, mode(k, row.D0), like) * x + load(modal, mode(k, row.D1), like) * y
        d = load(modal, mode(k, row.V0), like) * x + load(modal, mode(k, row.V1), like) * y
        fall = load(modal, mode(k, row.DAMP), like) * y + load(modal, mode(k, row.SPRING), like) * x
        x2, y2 = x + (y + g * h) * h, y + d * h
        norm = load(modal, mode(k, row.NORM), like)
        store(modal, mode(k, row.X2), x2)
        store(modal, mode(k, row.Y2), y2)
        store(modal, mode(k, row.E2), bound(x2, y2 * norm))
        missed += bound(x, y * norm) * load(modal, mode(k, row.MISSED_1), like)
        hidden += y - low * y
        second -= low * fall
        gamma += low * g
        delta += low * d
        whole += g
    drawn = zr * get(common, row.SECOND_IM, like) + zi * get(common, row.SECOND_RE, like)
    start, bend = rise - hidden, gamma + drawn
    slope = 0.5 * (second - w * w * zi)
    end = start + h * bend
    end_slope = delta + w * (zr * get(common, row.FIRST_RE, like) - zi * get(common, row.FIRST_IM, like)) - bend
    third = THIRD * h
    least = smaller(smaller(start, start + third * slope), smaller(end - third * end_slope, end))
    square = w * h
    square = square * square
    error = missed + (0.2 * VALUE) * (get(common, row.SIZE, like) * w * (square * square))
    clear = below(error, least)
    return clear, below(nought, rise + h * (whole + drawn)) & ~clear, below(WIDE * error, least)


@kernel
def first_level(rows: LaneRows, slot: int) -> int:
    """Level of the first panel to try: that of the flight before, or a shorter one for a shorter flight."""
    common, levels = rows.common, rows.levels
    level, pull = int(common[row.FIRST * row.WIDTH + slot]), common[row.C0 * row.WIDTH + slot]
    rise = common[row.RISE * row.WIDTH + slot]
    while level < layout.LEVELS - 1 and levels[slot, layout.STEP, level] * pull > 4.0 * rise:
        level += 1
    return level


@kernel
def launch(rows: LaneRows, flying: int) -> int:
    """Carry the lanes over the first panel of their flights; those that could not be."""
    common, modal, like = rows.common, rows.modal, eight()
    cosine, sine = get(common, row.COS, like), get(common, row.SIN, like)
    re, im = get(common, row.PHASOR_RE, like), get(common, row.PHASOR_IM, like)
    zr, zi = im * sine - re * cosine, 0.0 - (re * sine + im * cosine)
    nought = every(0.0, like)
    put(common, row.P0, zr)
    put(common, row.S0, zi)
    rise = get(common, row.RISE, like)
    struck = below(nought, rise) & flying
    w = get(common, row.OMEGA, like)
    pull = (w * w) * zi - get(common, row.SECOND, like)  # acceleration toward the stop
    put(common, row.C0, pull)
    short = below(4.0 * rise, get(common, row.STEP_1, like) * pull) & struck
    first = get(common, row.FIRST, like)
    rest = (struck & ~equal(first, get(common, row.LEVEL_1, like))) | short
    while rest:
        slot = lowest(rest)
        rest &= rest - 1
        take_first_panel(rows, slot, first_level(rows, slot))
    lost, todo, wide = 0, struck, 0
    while todo:
        clear, split, wide = try_first_panels(rows)
        lost |= todo & ~(clear | split)
        todo &= split
        rest = todo
        while rest:
            slot = lowest(rest)
            rest &= rest - 1
            level = int(common[row.LEVEL_1 * row.WIDTH + slot]) + 1
            if level >= layout.LEVELS:
                lost |= 1 << slot
                todo &= ~(1 << slot)
            else:
                take_first_panel(rows, slot, level)
    begun = struck & ~lost
    coarsest = get(common, row.COARSEST, like)
    level = pick(begun, get(common, row.LEVEL_1, like), coarsest)
    coarser = begun & wide & below(coarsest, level)
    put(common, row.FIRST, pick(coarser, level - 1.0, level))
    rest = flying & ~lost & ~equal(level, get(common, row.LEVEL, like))
    while rest:
        slot = lowest(rest)
        rest &= rest - 1
        take_panel(rows, slot, int(common[(row.LEVEL_1 if (begun >> slot) & 1 else row.COARSEST) * row.WIDTH + slot]))
    tr, ti = get(common, row.TURN_RE_1, like), get(common, row.TURN_IM_1, like)
    put(common, row.P1, pick(begun, zr * tr - zi * ti, zr))
    put(common, row.S1, pick(begun, zi * tr + zr * ti, zi))
    put(common, row.TIME, pick(begun, get(common, row.STEP_1, like), nought))
    put(common, row.SINCE, pick(begun, every(1.0, like), nought))
    put(common, row.PATIENCE, every(1.0, like))
    put(common, row.LENGTHENED, nought)
    for k in range(modes_of(rows)):
        x, y = load(modal, mode(k, row.START_X), like), load(modal, mode(k, row.START_Y), like)
        store(modal, mode(k, row.X), pick(begun, load(modal, mode(k, row.X2), like), x))
        store(modal, mode(k, row.Y), pick(begun, load(modal, mode(k, row.Y2), like), y))
        e = bound(x, y * load(modal, mode(k, row.NORM), like))
        store(modal, mode(k, row.E), pick(begun, load(modal, mode(k, row.E2), like), e))
    return lost


@kernel
def halve(rows: LaneRows, split: int, bowl: int) -> int:
    """Halve the panels of some lanes; those that no shorter panel will help. ``bowl``: where the gap has a minimum."""
    hopeless = 0
    while split:
        slot = lowest(split)
        split &= split - 1
        level = int(rows.common[row.LEVEL * row.WIDTH + slot]) + 1
        if level >= layout.LEVELS or (
            (bowl >> slot) & 1 and level > int(rows.common[row.COARSEST * row.WIDTH + slot]) + DEEP
        ):
            hopeless |= 1 << slot
        else:
            take_panel(rows, slot, level)
    return hopeless


@kernel
def walk(rows: LaneRows, flying: int) -> int:
    """Carry the lanes on to the panel that has their one root; those that came to one."""
    common, modal, like = rows.common, rows.modal, eight()
    n, nought = modes_of(rows), every(0.0, like)
    const, w, coarsest = get(common, row.CONST, like), get(common, row.OMEGA, like), get(common, row.COARSEST, like)
    drive = get(common, row.SIZE, like)
    span = smaller(
        get(common, row.LEFT, like) * get(common, row.PERIOD, like) - get(common, row.CLOCK, like),
        get(common, row.LONGEST, like),
    )
    tolerance = (8.0 * EPSILON) * (size(const) + drive + get(common, row.SUM_E, like))
    w2 = w * w
    fourth = drive * (w2 * w2)
    re, im, time = get(common, row.P1, like), get(common, row.S1, like), get(common, row.TIME, like)
    since, patience = get(common, row.SINCE, like), get(common, row.PATIENCE, like)
    lengthened, landed, panels, side = 0, 0, 0, 0
    flying &= below(time, span)
    while flying and panels < MOST:
        panels += 1
        here, there = 3 * side, 3 - 3 * side
        h = get(common, row.STEP, like)
        tr, ti = get(common, row.TURN_RE, like), get(common, row.TURN_IM, like)
        re2, im2 = re * tr - im * ti, im * tr + re * ti
        p0, s0, p1, s1 = const + im, w * re, const + im2, w * re2
        missed = nought
        for k in range(n):
            x, y = load(modal, mode(k, row.X + here), like), load(modal, mode(k, row.Y + here), like)
            low = load(modal, mode(k, row.LOW), like)
            x2 = load(modal, mode(k, row.P00), like) * x + load(modal, mode(k, row.P01), like) * y
            y2 = load(modal, mode(k, row.P10), like) * x + load(modal, mode(k, row.P11), like) * y
            store(modal, mode(k, row.X + there), x2)
            store(modal, mode(k, row.Y + there), y2)
            store(modal, mode(k, row.E + there), bound(x2, y2 * load(modal, mode(k, row.NORM), like)))
            missed += load(modal, mode(k, row.E + here), like) * load(modal, mode(k, row.MISSED), like)
            p0 += low * x
            s0 += low * y
            p1 += low * x2
            s1 += low * y2
        square = h * h
        third = THIRD * h
        missed += fourth * (square * square) * VALUE + tolerance
        b1, b2 = p0 + third * s0, p1 - third * s1
        clear = below(missed, smaller(smaller(p0, b1), smaller(p1, b2))) & flying
        split = 0
        if clear != flying:
            high, slack0, slack1, slack2 = fourth, nought, nought, nought
            begin, begin_slope, end, end_slope = p0, s0, p1, s1
            bend0, bend1 = 0.0 - w2 * im, 0.0 - w2 * im2
            fifth = drive * (w2 * w2) * w
            for k in range(n):
                low, e = load(modal, mode(k, row.LOW), like), load(modal, mode(k, row.E + here), like)
                rest = 1.0 - low
                damp, spring = load(modal, mode(k, row.DAMP), like), load(modal, mode(k, row.SPRING), like)
                x, y = load(modal, mode(k, row.X + here), like), load(modal, mode(k, row.Y + here), like)
                begin += rest * x
                begin_slope += rest * y
                bend0 -= low * (damp * y + spring * x)
                x, y = load(modal, mode(k, row.X + there), like), load(modal, mode(k, row.Y + there), like)
                end += rest * x
                end_slope += rest * y
                bend1 -= low * (damp * y + spring * x)
                high += low * e * load(modal, mode(k, row.K4), like)
                fifth += e * load(modal, mode(k, row.K5), like)
                slack = rest * e
                slack0 += slack
                slack1 += slack * load(modal, mode(k, row.K1), like)
                slack2 += slack * load(modal, mode(k, row.K2), like)
            inverse = quotient(every(1.0, like), h)
            d1 = 3.0 * (b2 - b1) * inverse
            slope_error = SLOPE * high * square * h + slack1
            minus = nought - slope_error
            falls = below(larger(larger(s0, d1), s1), minus)
            rises = below(slope_error, smaller(smaller(s0, d1), s1))
            c0, c1 = 2.0 * (d1 - s0) * inverse, 2.0 * (s1 - d1) * inverse
            bend_error = high * square * (1.0 / 12.0) + slack2
            concave = below(larger(c0, c1), nought - bend_error)
            convex = below(bend_error, smaller(c0, c1))
            above, climbs = below(nought, end), below(nought, end_slope)
            hull = below(
                high * (square * square) * VALUE + slack0 + tolerance, smaller(smaller(p0, b1), smaller(b2, p1))
            )
            told = (falls | concave | convex) & ~(rises & ~falls) & ~hull
            struck = told & ~above & flying & ~clear
            bowl = convex & ~falls & ~concave & ~rises & ~hull & above & climbs
            clear |= (hull | rises | (told & above & ~bowl)) & flying
            split = flying & ~clear & ~struck
            if struck:
                blend(common, row.ROOT_TIME, struck, time, like)
                blend(common, row.ROOT_STEP, struck, h, like)
                blend(common, row.P0, struck, begin, like)
                blend(common, row.S0, struck, begin_slope, like)
                blend(common, row.C0, struck, bend0, like)
                blend(common, row.P1, struck, end, like)
                blend(common, row.S1, struck, end_slope, like)
                blend(common, row.C1, struck, bend1, like)
                blend(common, row.FIFTH, struck, fifth, like)
                landed |= struck
                flying &= ~struck
            if split:
                flying &= ~halve(rows, split, bowl & split)
                doubled = smaller(larger(every(1.0, like), 2.0 * patience), every(64.0, like))
                patience = pick(split & lengthened, doubled, patience)
                since = pick(split, every(-1.0, like), since)
                lengthened &= ~split
                re2, im2 = pick(split, re, re2), pick(split, im, im2)
                h = pick(split, nought, h)
                for k in range(n):
                    for j in range(3):
                        x = load(modal, mode(k, row.X + j + here), like)
                        at = mode(k, row.X + j + there)
                        store(modal, at, pick(split, x, load(modal, at, like)))
        time, re, im, side = time + h, re2, im2, 1 - side
        flying &= below(time, span)
        since += 1.0
        if lengthened:
            patience = pick(lengthened & ~split, 0.5 * patience, patience)
            lengthened = 0
        longer = below(coarsest, get(common, row.LEVEL, like)) & below(patience, since) & ~split & flying
        if longer:
            since = pick(longer, nought, since)
            lengthened = longer
            while longer:
                slot = lowest(longer)
                longer &= longer - 1
                take_panel(rows, slot, int(common[row.LEVEL * row.WIDTH + slot]) - 1)
    return landed
