"""The roots of all lanes' gaps at once, and the impacts there: the mathematics is that of ``lanes.landing``."""

from __future__ import annotations

from typing import NamedTuple

from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.lanes.elementary import sine_cosine
from vibeam.flight.kernels.lanes.landing import NEAR, SETTLED, pair_after, shifted
from vibeam.flight.kernels.lanes.panels import bound
from vibeam.flight.kernels.lanes.simd import (
    Lanes,
    at_most,
    below,
    eight,
    equal,
    every,
    larger,
    load,
    pick,
    plain,
    quotient,
    size,
    smaller,
    store,
    whole,
)
from vibeam.flight.kernels.layout import NEAR as FAINT
from vibeam.flight.kernels.roots.newton import EPSILON
from vibeam.flight.points.kernels import layout as row
from vibeam.flight.points.kernels.layout import LaneRows
from vibeam.flight.points.kernels.rows import blend, get, mode, modes_of, put
from vibeam_models.arrays import Array

ROUNDS = 8  # of Newton's method, before a root is left to the one engine


class Quartic(NamedTuple):
    """Value and derivatives of the gaps."""

    f0: Lanes
    f1: Lanes
    f2: Lanes
    f3: Lanes
    f4: Lanes


@joined
def wrapped(common: Array, time: Lanes, like: Lanes) -> tuple[Lanes, Lanes]:
    """A time within the drive's period, and how many whole periods were taken off."""
    turns = plain(whole(time * get(common, row.INVERSE, like) - 0.5))
    turns = larger(turns, every(0.0, like))
    less = (time - turns * get(common, row.PERIOD_HIGH, like)) - turns * get(common, row.PERIOD_LOW, like)
    return less - turns * get(common, row.PERIOD_REST, like), turns


@joined
def foretold(common: Array, like: Lanes) -> Lanes:
    """About the root of the quintic Hermite interpolant on the unit panel: ``lanes.landing.foretold``."""
    h = get(common, row.ROOT_STEP, like)
    p0, p1 = get(common, row.P0, like), get(common, row.P1, like)
    s0, s1 = h * get(common, row.S0, like), h * get(common, row.S1, like)
    c0, c1 = h * h * get(common, row.C0, like), h * h * get(common, row.C1, like)
    half = 0.5 * c0
    p, s, c = p1 - p0 - s0 - half, s1 - s0 - c0, c1 - c0
    a3, a4, a5 = 10.0 * p - 4.0 * s + 0.5 * c, 7.0 * s - 15.0 * p - c, 6.0 * p - 3.0 * s + 0.5 * c
    nought, unit = every(0.0, like), every(1.0, like)
    between = below(p1, nought) & below(nought, p0)
    u = pick(between, quotient(p0, p0 - p1), 0.5 * unit)
    for _ in range(3):
        e = u * u
        value = (p0 + s0 * u) + e * ((half + a3 * u) + e * (a4 + a5 * u))
        slope = (s0 + c0 * u) + e * ((3.0 * a3 + 4.0 * a4 * u) + 5.0 * a5 * e)
        v = u - quotient(value, slope)
        u = pick(below(slope, nought) & below(nought, v) & below(v, unit), v, u)
    return u


@joined
def nearest(f: Quartic, least: Lanes, like: Lanes) -> tuple[Lanes, int]:
    """The roots near 0 of the quartics with these derivatives at 0, and which are settled (``lanes.landing``)."""
    f0, f1, f2, f3, f4 = f
    inverse, c2, c3, c4 = quotient(every(1.0, like), f1), f2 * (1 / 2), f3 * (1 / 6), f4 * (1 / 24)
    b2, b3, r = c2 * inverse, c3 * inverse, 0.0 - f0 * inverse
    d = r - r * r * (b2 - (2.0 * b2 * b2 - b3) * r)
    a, b = r * r, size(b2)
    settled = at_most(a * a * (b * (5.0 * b * b + 5.0 * size(b3)) + size(c4 * inverse)), least)
    if settled != 255:
        done = settled
        for _ in range(3):
            e = d * d
            over = (f1 + d * f2) + e * (3.0 * c3 + d * (4.0 * c4))
            change = quotient((f0 + d * f1) + e * ((c2 + d * c3) + e * c4), over)
            d = pick(done, d, d - change)
            done |= at_most(size(change), SETTLED * size(d) + least)
        settled = done
    return d, settled


@kernel
def find_roots(rows: LaneRows, wanted: int) -> int:
    """The lanes whose root is found; TIME, phase, VALUE, SLOPE and LAND_X, LAND_Y receive what is there."""
    common, modal, like = rows.common, rows.modal, eight()
    n, nought = modes_of(rows), every(0.0, like)
    clock, const, w = get(common, row.CLOCK, like), get(common, row.CONST, like), get(common, row.OMEGA, like)
    re, im = get(common, row.PHASOR_RE, like), get(common, row.PHASOR_IM, like)
    fifth, w2 = get(common, row.FIFTH, like), w * w
    low = get(common, row.ROOT_TIME, like)
    high = low + get(common, row.ROOT_STEP, like)
    t = low + get(common, row.ROOT_STEP, like) * foretold(common, like)
    found, rounds = 0, 0
    todo = wanted
    while todo and rounds < ROUNDS:
        rounds += 1
        within, _ = wrapped(common, clock + t, like)
        sine, cosine = sine_cosine(w * within)
        zr, zi = im * sine - re * cosine, 0.0 - (re * sine + im * cosine)
        f0, f1, f2, f3, f4 = const + zi, w * zr, 0.0 - w2 * zi, 0.0 - w2 * (w * zr), w2 * (w2 * zi)
        for k in range(n):
            x, y = load(modal, mode(k, row.START_X), like), load(modal, mode(k, row.START_Y), like)
            rate, damp = load(modal, mode(k, row.RATE), like), load(modal, mode(k, row.DAMP), like)
            spring = load(modal, mode(k, row.SPRING), like)
            turn, inverse = load(modal, mode(k, row.TURN), like), load(modal, mode(k, row.TURN_INVERSE), like)
            x, y = pair_after(x, y, rate, turn, inverse, spring, t)
            d2 = damp * y + spring * x
            d3 = damp * d2 - spring * y
            d4 = spring * d2 - damp * d3
            store(modal, mode(k, row.X2), x)
            store(modal, mode(k, row.Y2), y)
            store(modal, mode(k, row.D2), d2)
            store(modal, mode(k, row.D3), d3)
            store(modal, mode(k, row.D4), d4)
            f0, f1, f2, f3, f4 = f0 + x, f1 + y, f2 - d2, f3 + d3, f4 + d4
        above = below(nought, f0)
        low, high = pick(above, t, low), pick(above, high, t)
        least = EPSILON * t
        step, settled = nearest(Quartic(f0, f1, f2, f3, f4), least, like)
        ahead = t + step
        good = settled & below(f1, nought) & at_most(low, ahead) & at_most(ahead, high) & todo
        d = step * step
        near = at_most(fifth * (d * d), (-12.0 * EPSILON) * f1) & below(w * size(step), every(NEAR, like)) & good
        if near:
            value, slope = nought, nought
            for k in range(n):
                x, y = load(modal, mode(k, row.X2), like), load(modal, mode(k, row.Y2), like)
                d2, d3 = load(modal, mode(k, row.D2), like), load(modal, mode(k, row.D3), like)
                d4 = load(modal, mode(k, row.D4), like)
                x, y = shifted(x, y, d2, d3, d4, step)
                at = mode(k, row.LAND_X)
                store(modal, at, pick(near, x, load(modal, at, like)))
                at = mode(k, row.LAND_Y)
                store(modal, at, pick(near, y, load(modal, at, like)))
                value += x
                slope += y
            a = w * step
            e = a * a
            less = e * (0.5 - e * (1 / 24 - e * (1 / 720)))
            more = a * (1.0 - e * (1 / 6 - e * (1 / 120)))
            cosine2, sine2 = cosine - (cosine * less + sine * more), sine + (cosine * more - sine * less)
            zr, zi = im * sine2 - re * cosine2, 0.0 - (re * sine2 + im * cosine2)
            blend(common, row.TIME, near, ahead, like)
            blend(common, row.LAND_COS, near, cosine2, like)
            blend(common, row.LAND_SIN, near, sine2, like)
            blend(common, row.VALUE, near, value + (const + zi), like)
            blend(common, row.SLOPE, near, slope + w * zr, like)
            found |= near
            todo &= ~near
        stuck = at_most(high - low, least) & todo & ~good
        todo &= ~stuck
        t = pick(good, ahead, 0.5 * (low + high))
    return int(found)


@kernel
def strike(rows: LaneRows, landed: int) -> int:
    """The impacts of the lanes that landed within their time and whose rebound is no end of a chatter: those lanes."""
    common, modal, like = rows.common, rows.modal, eight()
    n, nought = modes_of(rows), every(0.0, like)
    w, clock, time = get(common, row.OMEGA, like), get(common, row.CLOCK, like), get(common, row.TIME, like)
    span = smaller(get(common, row.LEFT, like) * get(common, row.PERIOD, like) - clock, get(common, row.LONGEST, like))
    restitution, value = get(common, row.RESTITUTION, like), get(common, row.VALUE, like)
    before = larger(0.0 - get(common, row.SLOPE, like), nought)
    after, top = restitution * before, larger(get(common, row.SPEED, like), before)
    impulse = before + after
    sum_e, second = nought, nought
    for k in range(n):
        x = load(modal, mode(k, row.LAND_X), like) - load(modal, mode(k, row.PUT), like) * value
        y = load(modal, mode(k, row.LAND_Y), like) + load(modal, mode(k, row.KICK), like) * impulse
        store(modal, mode(k, row.X2), x)
        store(modal, mode(k, row.Y2), y)
        sum_e += bound(x, y * load(modal, mode(k, row.NORM), like))
        second -= load(modal, mode(k, row.DAMP), like) * y + load(modal, mode(k, row.SPRING), like) * x
    cosine, sine = get(common, row.LAND_COS, like), get(common, row.LAND_SIN, like)
    re, im = get(common, row.PHASOR_RE, like), get(common, row.PHASOR_IM, like)
    zi = 0.0 - (re * sine + im * cosine)
    toward = (w * w) * zi - second
    loss = get(common, row.LOSS, like)
    reach = FAINT * loss * (top * top + get(common, row.GAP, like) * toward)
    faint = below(nought, toward) & below(nought, loss) & at_most(2.0 * after * after, reach)
    good = landed & at_most(time, span) & below(nought, after) & ~faint
    for k in range(n):
        for j in range(2):
            at = mode(k, row.START_X + j)
            store(modal, at, pick(good, load(modal, mode(k, row.X2 + j), like), load(modal, at, like)))
    within, turns = wrapped(common, clock + time, like)
    blend(common, row.CLOCK, good, within, like)
    blend(common, row.LEFT, good, get(common, row.LEFT, like) - turns, like)
    blend(common, row.COS, good, cosine, like)
    blend(common, row.SIN, good, sine, like)
    blend(common, row.RISE, good, after, like)
    blend(common, row.SPEED, good, top, like)
    blend(common, row.SUM_E, good, sum_e, like)
    blend(common, row.SECOND, good, second, like)
    blend(common, row.IMPACTS, good, get(common, row.IMPACTS, like) + 1.0, like)
    return int(good)


@kernel
def recur(rows: LaneRows, struck: int) -> int:
    """Lanes whose motion has come back to the very bits of an earlier impact go on by whole rounds of it at once.

    The motion after an impact is a function of the numbers compared here: where they are the same, so is all that
    follows (cycle detection by Brent 1980: the state compared to is renewed after 1, 2, 4, 8 … impacts).
    """
    common, modal, like = rows.common, rows.modal, eight()
    n = modes_of(rows)
    same = struck & equal(get(common, row.CLOCK, like), get(common, row.SAME_CLOCK, like))
    if same:
        same &= equal(get(common, row.SPEED, like), get(common, row.SAME_SPEED, like))
        same &= equal(get(common, row.FIRST, like), get(common, row.SAME_FIRST, like))
        for k in range(n):
            for j in range(2):
                now = load(modal, mode(k, row.START_X + j), like)
                same &= equal(now, load(modal, mode(k, row.SAME_X + j), like))
        if same:
            left, impacts = get(common, row.LEFT, like), get(common, row.IMPACTS, like)
            turns = get(common, row.SAME_LEFT, like) - left
            rounds = plain(whole(quotient(left - 1.0, larger(turns, every(1.0, like))) - 0.5))
            rounds = pick(same & below(every(0.5, like), turns), larger(rounds, every(0.0, like)), every(0.0, like))
            put(common, row.LEFT, left - rounds * turns)
            put(common, row.IMPACTS, impacts + rounds * (impacts - get(common, row.SAME_IMPACTS, like)))
    due = struck & at_most(get(common, row.RENEWED, like), get(common, row.IMPACTS, like))
    if due:
        impacts = get(common, row.IMPACTS, like)
        blend(common, row.SAME_CLOCK, due, get(common, row.CLOCK, like), like)
        blend(common, row.SAME_LEFT, due, get(common, row.LEFT, like), like)
        blend(common, row.SAME_SPEED, due, get(common, row.SPEED, like), like)
        blend(common, row.SAME_FIRST, due, get(common, row.FIRST, like), like)
        blend(common, row.SAME_IMPACTS, due, impacts, like)
        blend(common, row.RENEWED, due, 2.0 * impacts, like)
        for k in range(n):
            for j in range(2):
                at = mode(k, row.SAME_X + j)
                now = load(modal, mode(k, row.START_X + j), like)
                store(modal, at, pick(due, now, load(modal, at, like)))
    return int(same)
