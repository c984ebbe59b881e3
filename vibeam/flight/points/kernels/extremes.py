"""Extremes of a signal over flights of one point, a flight a lane: those of ``kernels.readout``, panel by panel.

All lanes take panels of the same length: one that must be halved halves those of all.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.lanes.elementary import exponential, sine_cosine
from vibeam.flight.kernels.lanes.panels import bound
from vibeam.flight.kernels.lanes.simd import (
    Lanes,
    at_most,
    below,
    eight,
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
from vibeam.flight.kernels.readout import EPSILON, FINE, ROUNDS, cubic_range
from vibeam.flight.kernels.roots.bounds import PanelEnds
from vibeam.flight.points.kernels import layout as row
from vibeam.flight.points.kernels.rows import flight
from vibeam_models.arrays import Array

MOST = 4096  # panels, before the flights are read off one by one


class Wave(NamedTuple):
    """A signal const + Im(z e^{iΩt}) + Σ weight_k u_k(t): all but its weights."""

    const: float
    w: float
    re: Lanes
    im: Lanes


class LaneExtremes(NamedTuple):
    """Least and greatest values."""

    least: Lanes
    most: Lanes


@joined
def at(pairs: Array, rows: Array, weights: Array, wave: Wave, t: Lanes) -> tuple[Lanes, Lanes, Lanes]:
    """Value, slope and curvature at flight times t."""
    const, w, re, im = wave
    s, c = sine_cosine(w * t)
    turned = im * c + re * s
    value, slope, curvature = const + turned, w * (re * c - im * s), (0.0 - w * w) * turned
    for k in range(pairs.shape[1]):
        sigma, own = pairs[layout.SIGMA, k], pairs[layout.OMEGA, k]
        turn = sqrt(-pairs[layout.DISC, k])
        s, c = sine_cosine(turn * t)
        decay = exponential((0.0 - sigma) * t)
        c, s = decay * c, decay * s * (1.0 / turn)
        fall = sigma * s
        x, y = load(rows, flight(k, row.FLIGHT_U), t), load(rows, flight(k, row.FLIGHT_V), t)
        x, y = weights[k] * ((c + fall) * x + s * y), weights[k] * ((c - fall) * y - own * own * s * x)
        value += x
        slope += y
        curvature -= 2.0 * sigma * y + own * own * x
    return value, slope, curvature


@joined
def widen(found: LaneExtremes, which: int, value: Lanes) -> LaneExtremes:
    """With those values in some lanes."""
    least, most = found
    return LaneExtremes(pick(which & below(value, least), value, least), pick(which & below(most, value), value, most))


@joined
def turn_points(
    pairs: Array, rows: Array, weights: Array, wave: Wave, found: LaneExtremes, time: Lanes, slope: Lanes, last: Lanes,
    which: int, convex: int, accuracy: Lanes,
) -> LaneExtremes:  # fmt: skip
    """With the values on (time, time + last] of lanes convex or concave there: the root of g' by Newton's method."""
    value, down, _ = at(pairs, rows, weights, wave, time + last)
    found = widen(found, which, value)
    nought = 0.0 * last
    bend = pick(convex, nought + 1.0, nought - 1.0)
    todo = which & below(bend * slope, nought) & below(nought, bend * down)
    left, right, t = nought, last, last * quotient(slope, pick(todo, slope - down, nought + 1.0))
    rounds = 0
    while todo and rounds < ROUNDS:
        rounds += 1
        value, rate, curvature = at(pairs, rows, weights, wave, time + t)
        found = widen(found, todo, value)
        todo &= ~at_most(rate * rate, size(curvature) * (FINE * accuracy))
        todo &= ~at_most(right - left, EPSILON * (time + t))
        falls = below(bend * rate, nought)
        left, right = pick(falls, t, left), pick(falls, right, t)
        fair = below(nought, bend * curvature)
        middle = 0.5 * (left + right)
        t = pick(fair, t - quotient(rate, pick(fair, curvature, nought + 1.0)), middle)
        t = pick(below(left, t) & below(t, right), t, middle)
    return found


@kernel
def extremes_of_flights(
    pairs: Array, table: Array, levels: Array, rows: Array, weights: Array, wave: Wave, coarsest: int,
    known: LaneExtremes, share: float,
) -> tuple[LaneExtremes, bool]:  # fmt: skip
    """``known`` widened to the signal's values over the flights in ``rows``, and whether that took bounded work.

    ``share`` of the size of its parts by which they may be missed.
    """
    const, w, re, im = wave
    n, like = pairs.shape[1], eight()
    nought, found = every(0.0, like), known
    span = load(rows, row.FLIGHT_SPAN * row.WIDTH, like)
    harmonic = bound(re, im)
    value, total = const + im, harmonic + abs(const)
    for k in range(n):
        x, y = load(rows, flight(k, row.FLIGHT_U), like), load(rows, flight(k, row.FLIGHT_V), like)
        store(rows, flight(k, row.FLIGHT_X), x)
        store(rows, flight(k, row.FLIGHT_Y), y)
        value += weights[k] * x
        total += abs(weights[k]) * bound(x, y * pairs[layout.INVERSE, k])
    accuracy = share * total
    active = below(nought, span)
    found = widen(found, active, value)
    time, level, side, panels = nought, coarsest, 0, 0
    w2 = w * w
    while active and panels < MOST:
        panels += 1
        here, there = 2 * side, 2 - 2 * side
        h, tr, ti = levels[layout.STEP, level], levels[layout.TURN_RE, level], levels[layout.TURN_IM, level]
        count = int(levels[layout.COUNT, level])
        re2, im2 = re * tr - im * ti, im * tr + re * ti
        p0, s0, p1, s1 = const + im, w * re, const + im2, w * re2
        high = harmonic * (w2 * w2)
        slack0, slack1, slack2 = nought, nought, nought
        begin, begin_slope, end, end_slope = nought, nought, nought, nought
        for k in range(n):
            weight, kappa = weights[k], pairs[layout.KAPPA, k]
            x, y = load(rows, flight(k, row.FLIGHT_X + here), like), load(rows, flight(k, row.FLIGHT_Y + here), like)
            x2 = table[layout.WALK, level, k] * x + table[layout.WALK + 1, level, k] * y
            y2 = table[layout.WALK + 2, level, k] * x + table[layout.WALK + 3, level, k] * y
            store(rows, flight(k, row.FLIGHT_X + there), x2)
            store(rows, flight(k, row.FLIGHT_Y + there), y2)
            e = abs(weight) * bound(x, y * pairs[layout.INVERSE, k])
            if k < count:
                high += e * (kappa * kappa * kappa * kappa)
                p0 += weight * x
                s0 += weight * y
                p1 += weight * x2
                s1 += weight * y2
            else:
                slack0 += e
                slack1 += kappa * e
                slack2 += (kappa * kappa) * e
                begin += weight * x
                begin_slope += weight * y
                end += weight * x2
                end_slope += weight * y2
        error = high * (h * h * h * h / 384.0) + slack0
        b1, b2 = p0 + (h / 3.0) * s0, p1 - (h / 3.0) * s1
        low, top = smaller(smaller(p0, b1), smaller(b2, p1)), larger(larger(p0, b1), larger(b2, p1))
        beyond = (below(low - error, found.least) | below(found.most, top + error)) & active
        if beyond:
            last = smaller(span - time, every(h, like))
            rough = beyond & below(accuracy, error)
            if level == layout.LEVELS - 1:
                rough = 0
            if rough:
                middle = (3.0 / h) * (p1 - p0) - s0 - s1
                c0, c1 = (2.0 / h) * (middle - s0), (2.0 / h) * (s1 - middle)
                bend = high * (h * h / 12.0) + slack2
                convex = below(bend, smaller(c0, c1))
                concave = below(larger(c0, c1), nought - bend)
                if rough & ~(convex | concave):
                    level += 1
                    continue
                found = turn_points(
                    pairs, rows, weights, wave, found, time, s0 + begin_slope, last, rough, convex, accuracy
                )
            plain = beyond & ~rough
            while plain:
                slot = lowest(plain)
                plain &= plain - 1
                ends = PanelEnds(
                    lane_of(rows, slot, p0 + begin), lane_of(rows, slot, s0 + begin_slope),
                    lane_of(rows, slot, p1 + end), lane_of(rows, slot, s1 + end_slope),
                )  # fmt: skip
                least, most = cubic_range(ends, h, lane_of(rows, slot, last))
                found = widen(found, 1 << slot, every(least, like))
                found = widen(found, 1 << slot, every(most, like))
        time, re, im, side = time + h, re2, im2, 1 - side
        active &= below(time, span)
        level = max(level - 1, coarsest)
    return found, active == 0


@joined
def lane_of(rows: Array, slot: int, value: Lanes) -> float:
    """One lane's number."""
    store(rows, row.FLIGHT_ROOM * row.WIDTH, value)
    return float(rows[row.FLIGHT_ROOM * row.WIDTH + slot])


@joined
def least_of(rows: Array, value: Lanes) -> float:
    """The least of all lanes' numbers."""
    store(rows, row.FLIGHT_ROOM * row.WIDTH, value)
    found = rows[row.FLIGHT_ROOM * row.WIDTH]
    for slot in range(1, row.WIDTH):
        found = min(found, rows[row.FLIGHT_ROOM * row.WIDTH + slot])
    return float(found)
