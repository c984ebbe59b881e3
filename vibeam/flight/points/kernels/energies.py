"""Time integrals of the modes' energies over flights of one point, a flight a lane: those of ``kernels.energy``.

The same sums of products of exponentials; e^{zt} − 1 is made here for every z by itself, good to all digits for small
and large. Flights that are short against mode and drive are integrated by Gauss's eight nodes, as there.
"""

from __future__ import annotations

from math import sqrt

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.energy import CANCELLED, NODES, PANEL, WEIGHTS, SteadyResponse, flight_energy, growth
from vibeam.flight.kernels.energy import MOST as MOST_PANELS
from vibeam.flight.kernels.lanes.elementary import (
    E2,
    E3,
    E4,
    E5,
    E6,
    E7,
    E8,
    E9,
    E10,
    E11,
    E12,
    E13,
    LOG_HIGH,
    LOG_LOW,
    PER_LOG,
    exponential,
    sine_cosine,
)
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
    plain,
    scaled,
    size,
    store,
    whole,
)
from vibeam.flight.kernels.layout import Engine
from vibeam.flight.points.kernels import layout as row
from vibeam.flight.points.kernels.rows import flight
from vibeam_models.arrays import Array


@joined
def decrement(x: Lanes) -> Lanes:
    """e^x − 1 for x ≤ 0, to all digits of small ones: 2ⁿ(e^r − 1) + (2ⁿ − 1)."""
    x = larger(x, every(-708.0, x))
    n = whole(x * PER_LOG)
    m = plain(n)
    r = (x - m * LOG_HIGH) - m * LOG_LOW
    s = r * r
    f = s * s
    low = (E2 + r * E3) + s * (E4 + r * E5)
    high = (E6 + r * E7) + s * (E8 + r * E9) + f * ((E10 + r * E11) + s * (E12 + r * E13))
    return scaled(r + s * (low + f * high), n) + (scaled(every(1.0, x), n) - 1.0)


@joined
def real_part(ar: Lanes, ai: Lanes, br: float, bi: float, cr: Lanes, ci: Lanes) -> Lanes:
    """Re(a b c)."""
    return (ar * br - ai * bi) * cr - (ar * bi + ai * br) * ci


@joined
def over(gr: Lanes, gi: Lanes, zr: float, zi: float, t: Lanes) -> tuple[Lanes, Lanes]:
    """(e^{zt} − 1)/z of a numerator given; t where z = 0."""
    square = zr * zr + zi * zi
    if square == 0.0:
        return t, 0.0 * t
    inverse = 1.0 / square
    return (gr * zr + gi * zi) * inverse, (gi * zr - gr * zi) * inverse


@kernel
def add_energies(engine: Engine, rows: Array, cosine: Lanes, sine: Lanes, used: int, energy: Array) -> None:
    """Add ∫ E_k dt over the flights in ``rows`` to ``energy`` (n,): FLIGHT_U, FLIGHT_V are their free motions."""
    modes, pairs, like = engine.modes, engine.pairs, eight()
    w, t = engine.drive[layout.W], load(rows, row.FLIGHT_SPAN * row.WIDTH, like)
    s, c = sine_cosine((0.5 * w) * t)
    drive_sine, drive_lost = 2.0 * (s * c), 2.0 * (s * s)
    for k in range(pairs.shape[1]):
        re, im = modes[layout.RE, k], modes[layout.IM, k]
        x, y = load(rows, flight(k, row.FLIGHT_U), like), load(rows, flight(k, row.FLIGHT_V), like)
        steady_re, steady_im = re * sine + im * cosine, im * sine - re * cosine
        rate = max(pairs[layout.KAPPA, k], w)
        short = at_most(rate * t, every(PANEL, like))
        total, parts = 0.0 * t, 0.0 * t
        if short != 255:
            total, parts = closed_form(
                engine, k, x, y, steady_re, steady_im, t, drive_sine, drive_lost, s, c
            )  # fmt: skip
        if short:
            total = pick(short, by_nodes(engine, k, x, y, steady_re, steady_im, t), total)
        store(rows, row.FLIGHT_SUM * row.WIDTH, total)
        lost = below(total, CANCELLED * parts) & at_most(rate * t, every(PANEL * MOST_PANELS, like)) & ~short & used
        while lost:
            slot = lowest(lost)
            lost &= lost - 1
            rows[row.FLIGHT_SUM * row.WIDTH + slot] = alone(engine, rows, k, slot, steady_re, steady_im)
        for slot in range(row.WIDTH):
            if (used >> slot) & 1:
                energy[k] += rows[row.FLIGHT_SUM * row.WIDTH + slot]


@joined
def closed_form(
    engine: Engine, k: int, x: Lanes, y: Lanes, cr: Lanes, ci: Lanes, t: Lanes, drive_sine: Lanes, drive_lost: Lanes,
    s: Lanes, c: Lanes,
) -> tuple[Lanes, Lanes]:  # fmt: skip
    """∫ ½(η'² + ω²η²) of η = Re(a e^{λt} + c e^{iΩt}) + offset, and the sum of its parts' sizes.

    ``drive_sine``, ``drive_lost``: sin Ωt and 1 − cos Ωt; ``s``, ``c``: of half of it.
    """
    pairs, w, offset = engine.pairs, engine.drive[layout.W], engine.modes[layout.OFFSET, k]
    sigma, square = pairs[layout.SIGMA, k], pairs[layout.OMEGA, k] * pairs[layout.OMEGA, k]
    turn = sqrt(-pairs[layout.DISC, k])
    ar, ai = x, (y + sigma * x) * (-1.0 / turn)
    less, less2 = decrement((0.0 - sigma) * t), decrement((-2.0 * sigma) * t)
    left, left2 = 1.0 + less, 1.0 + less2
    hs, hc = sine_cosine((0.5 * turn) * t)
    own_sine, own_lost = 2.0 * (hs * hc), 2.0 * (hs * hs)
    # free with itself, and with its conjugate
    twice = 2.0 * (own_sine * own_sine)
    gr, gi = over(less2 - left2 * twice, left2 * (2.0 * (own_sine * (1.0 - own_lost))), -2.0 * sigma, 2.0 * turn, t)
    hr, _ = over(less2, 0.0 * t, -2.0 * sigma, 0.0, t)
    bare = real_part(
        ar * ar - ai * ai, 2.0 * (ar * ai), sigma * sigma - turn * turn + square, -2.0 * (sigma * turn), gr, gi
    )
    part = 0.25 * (bare + (ar * ar + ai * ai) * (2.0 * square) * hr)
    total, parts = part, size(part)
    # driven with itself
    gr, gi = over(-2.0 * (drive_sine * drive_sine), 2.0 * (drive_sine * (1.0 - drive_lost)), 0.0, 2.0 * w, t)
    bare = real_part(cr * cr - ci * ci, 2.0 * (cr * ci), square - w * w, 0.0, gr, gi)
    part = 0.25 * (bare + (cr * cr + ci * ci) * (square + w * w) * t)
    total, parts = total + part, parts + size(part)
    # free with driven
    ps, pc = hs * c + hc * s, hc * c - hs * s
    gr, gi = over(less - left * (2.0 * (ps * ps)), left * (2.0 * (ps * pc)), 0.0 - sigma, turn + w, t)
    bare = real_part(ar * cr - ai * ci, ar * ci + ai * cr, square - turn * w, 0.0 - sigma * w, gr, gi)
    ps, pc = sine_cosine((0.5 * (turn - w)) * t)
    gr, gi = over(less - left * (2.0 * (ps * ps)), left * (2.0 * (ps * pc)), 0.0 - sigma, turn - w, t)
    part = 0.5 * (bare + real_part(ar * cr + ai * ci, ai * cr - ar * ci, square + turn * w, sigma * w, gr, gi))
    total, parts = total + part, parts + size(part)
    if offset != 0.0:
        gr, gi = over(0.0 - drive_lost, drive_sine, 0.0, w, t)
        part = (offset * square) * (cr * gr - ci * gi)
        total, parts = total + part, parts + size(part)
        gr, gi = over(less - left * own_lost, left * own_sine, 0.0 - sigma, turn, t)
        part = (offset * square) * (ar * gr - ai * gi)
        total, parts = total + part, parts + size(part)
        part = (0.5 * square * offset * offset) * t
        total, parts = total + part, parts + size(part)
    return total, parts


@joined
def by_nodes(engine: Engine, k: int, x: Lanes, y: Lanes, cr: Lanes, ci: Lanes, t: Lanes) -> Lanes:
    """The same by Gauss's quadrature with eight nodes."""
    pairs, w, offset = engine.pairs, engine.drive[layout.W], engine.modes[layout.OFFSET, k]
    sigma, square = pairs[layout.SIGMA, k], pairs[layout.OMEGA, k] * pairs[layout.OMEGA, k]
    turn = sqrt(-pairs[layout.DISC, k])
    total = 0.0 * t
    for i in range(8):
        time = NODES[i] * t
        s, c = sine_cosine(turn * time)
        decay = exponential((0.0 - sigma) * time)
        c, s = decay * c, decay * s * (1.0 / turn)
        fall = sigma * s
        value, slope = (c + fall) * x + s * y, (c - fall) * y - square * s * x
        s, c = sine_cosine(w * time)
        value += (cr * c - ci * s) + offset
        slope -= w * (cr * s + ci * c)
        total += WEIGHTS[i] * (slope * slope + square * (value * value))
    return 0.5 * (total * t)


@kernel
def alone(engine: Engine, rows: Array, k: int, slot: int, cr: Lanes, ci: Lanes) -> float:
    """The energy of mode k in one flight, by the one engine."""
    at = row.FLIGHT_ROOM * row.WIDTH
    store(rows, at, cr)
    store(rows, at + row.WIDTH, ci)
    steady = complex(rows[at + slot], rows[at + row.WIDTH + slot])
    t, w = rows[row.FLIGHT_SPAN * row.WIDTH + slot], engine.drive[layout.W]
    driven = SteadyResponse(steady, w, engine.modes[layout.OFFSET, k])
    x, y = rows[flight(k, row.FLIGHT_U) + slot], rows[flight(k, row.FLIGHT_V) + slot]
    return float(flight_energy(engine.pairs, k, x, y, driven, t, growth(1j * w, t)))
