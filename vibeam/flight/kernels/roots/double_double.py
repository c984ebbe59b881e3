"""Arithmetic in pairs of doubles, about 31 digits, for the few verdicts that one double cannot give.

A number is (high, low) with |low| ≤ ½ ulp(high). Error-free sums and products after Knuth and Dekker; the functions by
argument reduction and Taylor series, as in D. H. Bailey's double-double packages.
"""

from __future__ import annotations

from math import ldexp, sqrt

import numpy as np

from vibeam.flight.kernels.compiler import kernel

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
