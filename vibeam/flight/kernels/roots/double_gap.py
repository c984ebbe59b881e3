"""The gap in twice the precision: whether a grazing contact touches, where one double cannot tell.

A contact at velocity v reaches v²/2a deep: for v at 1e-9 of the scale that is 5e-19 of the displacement, below the
round-off of a double. Nothing is taken from the tables: the gap is evaluated anew from the system's own numbers and the
state at the start of the flight, all in pairs of doubles, about 31 digits.

A number is (high, low) with |low| ≤ ½ ulp(high). Error-free sums and products after Knuth and Dekker; the functions by
argument reduction and Taylor series, as in D. H. Bailey's double-double packages.
"""

from __future__ import annotations

from math import ldexp, sqrt
from typing import NamedTuple

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam_models.arrays import Array

Pair = tuple[float, float]
LOG2 = (0.6931471805599453, 2.3190468138462996e-17)
HALF_PI = (1.5707963267948966, 6.123233995736766e-17)
HALF_PI_REST = -1.4973849048591833e-33
SQUARINGS = 9  # of e^{r/512}


@kernel
def two_sum(a: float, b: float) -> Pair:
    """a + b exactly."""
    s = a + b
    v = s - a
    return s, (a - (s - v)) + (b - v)


@kernel
def two_product(a: float, b: float) -> Pair:
    """a · b exactly."""
    p = a * b
    t, u = 134217729.0 * a, 134217729.0 * b
    a1, b1 = t - (t - a), u - (u - b)
    a2, b2 = a - a1, b - b1
    return p, ((a1 * b1 - p) + a1 * b2 + a2 * b1) + a2 * b2


@kernel
def add(a: Pair, b: Pair) -> Pair:
    """a + b."""
    s, e = two_sum(a[0], b[0])
    t, f = two_sum(a[1], b[1])
    s, e = two_sum(s, e + t)
    return two_sum(s, e + f)


@kernel
def subtract(a: Pair, b: Pair) -> Pair:
    """a − b."""
    return add(a, (-b[0], -b[1]))


@kernel
def multiply(a: Pair, b: Pair) -> Pair:
    """a · b."""
    p, e = two_product(a[0], b[0])
    return two_sum(p, e + (a[0] * b[1] + a[1] * b[0]))


@kernel
def divide(a: Pair, b: Pair) -> Pair:
    """a / b."""
    first = a[0] / b[0]
    rest = subtract(a, multiply(b, (first, 0.0)))
    second = rest[0] / b[0]
    rest = subtract(rest, multiply(b, (second, 0.0)))
    s, e = two_sum(first, second)
    return two_sum(s, e + rest[0] / b[0])


@kernel
def root(a: Pair) -> Pair:
    """√a, a ≥ 0."""
    if a[0] <= 0.0:
        return 0.0, 0.0
    guess = sqrt(a[0])
    rest = subtract(a, two_product(guess, guess))
    return two_sum(guess, rest[0] / (2.0 * guess))


@kernel
def exponential(a: Pair) -> Pair:
    """e^a."""
    if a[0] < -700.0:
        return 0.0, 0.0
    times = np.floor(a[0] / LOG2[0] + 0.5)
    r = subtract(a, multiply(LOG2, (times, 0.0)))
    r = (r[0] / 512.0, r[1] / 512.0)
    term, total = r, r  # e^r − 1
    for j in range(2, 12):
        term = divide(multiply(term, r), (float(j), 0.0))
        total = add(total, term)
    for _ in range(SQUARINGS):  # (1 + x)² − 1 = 2x + x²
        total = add((2.0 * total[0], 2.0 * total[1]), multiply(total, total))
    total = add(total, (1.0, 0.0))
    return ldexp(total[0], int(times)), ldexp(total[1], int(times))


@kernel
def cosine_sine(a: Pair) -> tuple[Pair, Pair]:
    """cos a and sin a."""
    quarter = np.floor(a[0] / HALF_PI[0] + 0.5)
    r = subtract(subtract(a, multiply(HALF_PI, (quarter, 0.0))), (HALF_PI_REST * quarter, 0.0))
    square = multiply(r, r)
    cosine, sine, term = (1.0, 0.0), r, r
    even = (1.0, 0.0)
    for j in range(1, 15):
        even = divide(multiply(even, square), (-float((2 * j - 1) * (2 * j)), 0.0))
        term = divide(multiply(term, square), (-float((2 * j) * (2 * j + 1)), 0.0))
        cosine, sine = add(cosine, even), add(sine, term)
    turn = int(quarter) % 4
    if turn == 1:
        return (-sine[0], -sine[1]), cosine
    if turn == 2:
        return (-cosine[0], -cosine[1]), (-sine[0], -sine[1])
    if turn == 3:
        return sine, (-cosine[0], -cosine[1])
    return cosine, sine


class InitialState(NamedTuple):
    """State at the start of a flight, and the system that flies: see ``layout`` for the rows."""

    modes: Array
    drive: Array
    pose: Array  # (2, n) η, η'
    clock: float  # time in the drive period; negative: the signal is not the gap of a flight


@kernel
def sharp_gap(pairs: Array, initial: InitialState, t: float) -> float:
    """g = Δ − w·η at flight time t in double-double arithmetic; no mode may be attached.

    η_k = Im(H_k e^{iφ}) + s_k/ω_k² + P00 x_k + P01 x_k', x_k what the initial state has beyond the steady response.
    """
    modes, drive, pose, clock = initial
    start, w = two_product(drive[layout.W], clock), drive[layout.W]
    phase = add(start, two_product(w, t))
    total: Pair = (drive[layout.GAP], 0.0)
    for k in range(pairs.shape[1]):
        own, zeta = pairs[layout.OMEGA, k], modes[layout.ZETA, k]
        re, im = steady(own, zeta, modes[layout.LOAD, k], w, drive)
        offset = divide((modes[layout.STATIC, k], 0.0), two_product(own, own))
        x0, y0 = at_phase(re, im, start, w)
        x = subtract(subtract((pose[0, k], 0.0), offset), x0)
        y = subtract((pose[1, k], 0.0), y0)
        now, _ = at_phase(re, im, phase, w)
        now = add(add(now, offset), free(own, zeta, x, y, t))
        total = subtract(total, multiply((modes[layout.CONTACT, k], 0.0), now))
    return total[0]


@kernel
def steady(own: float, zeta: float, load: float, w: float, drive: Array) -> tuple[Pair, Pair]:
    """Real and imaginary part of load Ω²B / (ω² − Ω² + 2iζωΩ)."""
    if drive[layout.AMPLITUDE] == 0.0 or load == 0.0:
        return (0.0, 0.0), (0.0, 0.0)
    force = multiply(multiply(two_product(w, w), (drive[layout.AMPLITUDE], 0.0)), (load, 0.0))
    real = subtract(two_product(own, own), two_product(w, w))
    imaginary = multiply(multiply(two_product(zeta, own), (w, 0.0)), (2.0, 0.0))
    size = add(multiply(real, real), multiply(imaginary, imaginary))
    minus = divide(multiply(force, imaginary), size)
    return divide(multiply(force, real), size), (-minus[0], -minus[1])


@kernel
def at_phase(re: Pair, im: Pair, phase: Pair, w: float) -> tuple[Pair, Pair]:
    """Im((re + i im) e^{iφ}) and its rate."""
    cosine, sine = cosine_sine(phase)
    value = add(multiply(re, sine), multiply(im, cosine))
    rate = subtract(multiply(re, cosine), multiply(im, sine))
    return value, multiply((w, 0.0), rate)


@kernel
def free(own: float, zeta: float, x: Pair, y: Pair, t: float) -> Pair:
    """Displacement that x, x' have become after t of free motion."""
    sigma = two_product(zeta, own)
    disc = multiply(two_product(own, own), multiply(add((zeta, 0.0), (-1.0, 0.0)), add((zeta, 0.0), (1.0, 0.0))))
    slope = add(y, multiply(sigma, x))
    time: Pair = (t, 0.0)
    if disc[0] < 0.0:
        w = root((-disc[0], -disc[1]))
        decay = exponential(multiply((-sigma[0], -sigma[1]), time))
        cosine, sine = cosine_sine(multiply(w, time))
        return multiply(decay, add(multiply(cosine, x), multiply(divide(sine, w), slope)))
    if disc[0] == 0.0:
        decay = exponential(multiply((-sigma[0], -sigma[1]), time))
        return multiply(decay, add(x, multiply(time, slope)))
    mu = root(disc)
    fast = exponential(multiply(subtract((-sigma[0], -sigma[1]), mu), time))
    slow = exponential(multiply(divide(two_product(own, -own), add(sigma, mu)), time))
    half: Pair = (0.5, 0.0)
    even = multiply(half, multiply(add(slow, fast), x))
    return add(even, multiply(half, multiply(divide(subtract(slow, fast), mu), slope)))
