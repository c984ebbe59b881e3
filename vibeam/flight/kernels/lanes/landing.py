"""The end of a plain flight: from a panel with one root to the root, and every pair there, by blocks of modes."""

from __future__ import annotations

from typing import NamedTuple

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.drive import wrap
from vibeam.flight.kernels.lanes import layout as row
from vibeam.flight.kernels.lanes.elementary import exponential, sine_cosine
from vibeam.flight.kernels.lanes.layout import BlockPanel, Forced
from vibeam.flight.kernels.lanes.panels import cell
from vibeam.flight.kernels.lanes.simd import Lanes, every, load, one, smaller, store, total, width
from vibeam.flight.kernels.layout import FORGOTTEN, REDUCED, Engine, Phase
from vibeam.flight.kernels.roots.newton import EPSILON
from vibeam.flight.kernels.roots.pair import propagator
from vibeam_models.arrays import Array

ROUNDS = 60
NEAR = 0.02  # rad of the drive within which a step is taken by series
SETTLED = 1e-9  # share of a step below which Newton's next correction is round-off


STRUCK, ALOFT, UNUSUAL = 0, 1, 2  # outcomes of a flight


class GapDerivatives(NamedTuple):
    """Value and four derivatives of the gap, or of the pairs' sum, at one time; a bound of the fifth since the node."""

    value: float
    slope: float
    second: float
    third: float
    fourth: float
    fifth: float


class Bracket(NamedTuple):
    """Times between which the one root lies, and a guess."""

    low: float
    guess: float
    high: float


class Landing(NamedTuple):
    """End of a flight: how it ends, its time; the drive's phase, value and slope of the gap where it is STRUCK."""

    outcome: int
    time: float
    phase: Phase
    value: float
    slope: float


@joined
def no_landing(outcome: int, time: float) -> Landing:
    """End of a flight that does not reach the stop, or not in a way to be told here."""
    return Landing(outcome, time, Phase(1.0, 0.0), 0.0, 0.0)


@joined
def phase_at(drive: Array, time: float) -> Phase:
    """cos Ωt and sin Ωt."""
    like = one()
    sine, cosine = sine_cosine(every(drive[layout.W] * wrap(drive, time), like))
    return Phase(total(cosine), total(sine))


@joined
def drive_phasor(drive: Array, phase: Phase) -> tuple[float, float]:
    """Re z, Im z of the drive's part in the gap at that phase: z = −Σ w_k H_k e^{iφ}."""
    re, im = drive[layout.CONTACT_RE], drive[layout.CONTACT_IM]
    return -(re * phase.cosine - im * phase.sine), -(re * phase.sine + im * phase.cosine)


@kernel
def one_by_one(cells: Array, pairs: Array, b: int, t: float, like: Lanes) -> None:
    """The pairs of a block that are not all underdamped, a time t after the start."""
    lanes, at = width(like), cell(b, 0, like)
    for j in range(min(lanes, pairs.shape[1] - b * lanes)):
        k = b * lanes + j
        x, y = cells[at + row.START_X * lanes + j], cells[at + row.START_Y * lanes + j]
        p00, p01, p10, p11 = propagator(pairs[layout.SIGMA, k], pairs[layout.OMEGA, k], pairs[layout.DISC, k], t)
        cells[at + row.ROOT_X * lanes + j] = p00 * x + p01 * y
        cells[at + row.ROOT_Y * lanes + j] = p10 * x + p11 * y


@joined
def pair_after(
    x: Lanes, y: Lanes, rate: Lanes, turn: Lanes, inverse: Lanes, spring: Lanes, t: float | Lanes
) -> tuple[Lanes, Lanes]:
    """Underdamped pairs a time t after x, x': P00 x + P01 x', P10 x + P11 x' (``roots.pair``)."""
    sine, cosine = sine_cosine(smaller(turn * t, every(REDUCED, x)))
    decay = exponential(rate * (0.0 - t))
    cosine, sine = decay * cosine, decay * sine * inverse
    fall = rate * sine
    return (cosine + fall) * x + sine * y, (cosine - fall) * y - spring * sine * x


@joined
def shifted(x: Lanes, y: Lanes, d2: Lanes, d3: Lanes, d4: Lanes, d: float | Lanes) -> tuple[Lanes, Lanes]:
    """Pairs x, x' a short time d on, Σ x^{(j)} d^j/j!, j ≤ 4; ``d2``: minus the second derivative."""
    half, sixth = 0.5 * d, d * (1 / 6)
    x += (y + ((d3 + d4 * (0.5 * half)) * sixth - d2 * 0.5) * d) * d
    y += ((d3 + d4 * (2.0 * sixth)) * half - d2) * d
    return x, y


@joined
def pairs_at(cells: Array, pairs: Array, b: int, t: float, like: Lanes) -> tuple[Lanes, Lanes]:
    """The pairs of a block a time t after the start."""
    step, at = width(like), cell(b, 0, like)
    if cells[at + row.SLOWEST * step] * t > FORGOTTEN:
        return every(0.0, like), every(0.0, like)
    if cells[at + row.MIXED * step] != 0.0:
        one_by_one(cells, pairs, b, t, like)
        return load(cells, at + row.ROOT_X * step, like), load(cells, at + row.ROOT_Y * step, like)
    x, y = load(cells, at + row.START_X * step, like), load(cells, at + row.START_Y * step, like)
    rate, turn = load(cells, at + row.RATE * step, like), load(cells, at + row.TURN * step, like)
    inverse, spring = load(cells, at + row.TURN_INVERSE * step, like), load(cells, at + row.SPRING * step, like)
    return pair_after(x, y, rate, turn, inverse, spring, t)


@joined
def land_on(cells: Array, pairs: Array, blocks: int, t: float, like: Lanes) -> None:
    """ROOT_X, ROOT_Y receive the pairs a time t after the start."""
    for b in range(blocks):
        x, y = pairs_at(cells, pairs, b, t, like)
        store(cells, cell(b, row.ROOT_X, like), x)
        store(cells, cell(b, row.ROOT_Y, like), y)


@joined
def expanded(cells: Array, pairs: Array, panel: BlockPanel, t: float, like: Lanes) -> GapDerivatives:
    """The pairs' sum and four derivatives a time t after the start, and a bound Σ κ⁵ e on the fifth since the node.

    By x'' = −2σx' − ω²x. ROOT_X … ROOT_4 receive every pair's.
    """
    blocks, side = panel.whole, panel.side
    step = width(like)
    f0, f1, f2 = every(0.0, like), every(0.0, like), every(0.0, like)
    f3, f4, f5 = every(0.0, like), every(0.0, like), every(0.0, like)
    for b in range(blocks):
        at = cell(b, 0, like)
        damp, spring = load(cells, at + row.DAMP * step, like), load(cells, at + row.SPRING * step, like)
        x, y = pairs_at(cells, pairs, b, t, like)
        d2 = damp * y + spring * x  # minus the second derivative
        d3 = damp * d2 - spring * y
        d4 = spring * d2 - damp * d3
        store(cells, at + row.ROOT_X * step, x)
        store(cells, at + row.ROOT_Y * step, y)
        store(cells, at + row.ROOT_2 * step, d2)
        store(cells, at + row.ROOT_3 * step, d3)
        store(cells, at + row.ROOT_4 * step, d4)
        f0, f1, f2, f3, f4 = f0 + x, f1 + y, f2 - d2, f3 + d3, f4 + d4
        f5 += load(cells, at + (row.SIDE_E + 3 * side) * step, like) * load(cells, at + row.K5 * step, like)
    return GapDerivatives(total(f0), total(f1), total(f2), total(f3), total(f4), total(f5))


@joined
def shift(cells: Array, blocks: int, d: float, like: Lanes) -> tuple[float, float]:
    """Carry ROOT_X, ROOT_Y on by a short time d, x ← Σ x^{(j)} d^j/j!, j ≤ 4; their sums."""
    step, value, slope = width(like), every(0.0, like), every(0.0, like)
    for b in range(blocks):
        at = cell(b, 0, like)
        x, y = load(cells, at + row.ROOT_X * step, like), load(cells, at + row.ROOT_Y * step, like)
        d2, d3 = load(cells, at + row.ROOT_2 * step, like), load(cells, at + row.ROOT_3 * step, like)
        d4 = load(cells, at + row.ROOT_4 * step, like)
        x, y = shifted(x, y, d2, d3, d4, d)
        store(cells, at + row.ROOT_X * step, x)
        store(cells, at + row.ROOT_Y * step, y)
        value += x
        slope += y
    return total(value), total(slope)


@joined
def foretold(p0: float, s0: float, c0: float, p1: float, s1: float, c1: float) -> float:
    """About the root in (0, 1) of the quintic with values, slopes, second derivatives p₀, s₀, c₀ at 0, p₁, s₁, c₁ at 1.

    Quintic Hermite interpolation p₀ + s₀u + ½c₀u² + a₃u³ + a₄u⁴ + a₅u⁵; three steps of Newton's method from the secant.
    """
    half = 0.5 * c0
    p, s, c = p1 - p0 - s0 - half, s1 - s0 - c0, c1 - c0
    a3, a4, a5 = 10.0 * p - 4.0 * s + 0.5 * c, 7.0 * s - 15.0 * p - c, 6.0 * p - 3.0 * s + 0.5 * c
    u = p0 / (p0 - p1) if p1 < 0.0 < p0 else 0.5
    for _ in range(3):
        e = u * u
        value = (p0 + s0 * u) + e * ((half + a3 * u) + e * (a4 + a5 * u))
        slope = (s0 + c0 * u) + e * ((3.0 * a3 + 4.0 * a4 * u) + 5.0 * a5 * e)
        step = value / slope if slope < 0.0 else 0.0
        if 0.0 < u - step < 1.0:
            u -= step
    return u


@joined
def nearest(f: GapDerivatives, least: float) -> tuple[float, bool]:
    """The root near 0 of the quartic with these derivatives at 0, f' < 0, and whether Newton settles on it.

    First by reversion of the series, d = r − b₂r² + (2b₂² − b₃)r³ with r = −f/f', b_j = f^{(j)}/(j! f'). ``least``:
    what is no more than round-off.
    """
    f0, f1, f2, f3, f4, _ = f
    inverse, c2, c3, c4 = 1.0 / f1, f2 * (1 / 2), f3 * (1 / 6), f4 * (1 / 24)
    b2, b3, r = c2 * inverse, c3 * inverse, -f0 * inverse
    d = r - r * r * (b2 - (2.0 * b2 * b2 - b3) * r)
    a, b = abs(r), abs(b2)
    if (a * a) * (a * a) * (b * (5.0 * b * b + 5.0 * abs(b3)) + abs(c4 * inverse)) <= least:
        return d, True
    for _ in range(3):
        e = d * d
        change = ((f0 + d * f1) + e * ((c2 + d * c3) + e * c4)) / ((f1 + d * f2) + e * (3.0 * c3 + d * (4.0 * c4)))
        d -= change
        if abs(change) <= SETTLED * abs(d) + least:
            return d, True
    return d, False


@joined
def at_root(engine: Engine, panel: BlockPanel, forced: Forced, clock: float, bracket: Bracket, like: Lanes) -> Landing:
    """The one root in a bracket: STRUCK there; or UNUSUAL, where Newton's method does not settle on it.

    ROOT_X, ROOT_Y receive the pairs there. ``clock``: the drive's time at the flight's start. The rest of the quartic
    about the last iterate, M₅d⁴/24 in the slope, moves the velocity by less than half a last digit, or the closed form
    is taken once more.
    """
    cells, pairs, drive, const, w = engine.cells, engine.pairs, engine.drive, forced.const, forced.omega
    low, t, high = bracket
    w2 = w * w
    for _ in range(ROUNDS):
        phase = phase_at(drive, clock + t)
        zr, zi = drive_phasor(drive, phase)
        f0, f1, f2, f3, f4, f5 = expanded(cells, pairs, panel, t, like)
        f0, f1, f2, f3, f4 = f0 + (const + zi), f1 + w * zr, f2 - w2 * zi, f3 - w2 * (w * zr), f4 + w2 * (w2 * zi)
        f5 += forced.size * w2 * w2 * w
        if f0 > 0.0:
            low = t
        else:
            high = t
        if f1 < 0.0:
            step, settled = nearest(GapDerivatives(f0, f1, f2, f3, f4, f5), EPSILON * t)
            d = abs(step)
            if low <= t + step <= high and settled:
                if f5 * (d * d) * (d * d) <= -12.0 * EPSILON * f1 and w * d < NEAR:
                    value, slope = shift(cells, panel.whole, step, like)
                    phase = advanced(phase, w * step)
                    zr, zi = drive_phasor(drive, phase)
                    return Landing(STRUCK, t + step, phase, value + (const + zi), slope + w * zr)
                t += step
                continue
        if high - low <= EPSILON * t:
            break
        t = 0.5 * (low + high)
    return no_landing(UNUSUAL, t)


@joined
def advanced(phase: Phase, a: float) -> Phase:
    """cos and sin of a phase ``a`` ≤ ``NEAR`` further on, by the Taylor series of 1 − cos a and sin a."""
    cosine, sine = phase
    e = a * a
    less = e * (0.5 - e * (1 / 24 - e * (1 / 720)))  # 1 − cos a
    ahead = a * (1.0 - e * (1 / 6 - e * (1 / 120)))
    return Phase(cosine - (cosine * less + sine * ahead), sine + (cosine * ahead - sine * less))
